// What the chip is connected to: UARTs, pins, the ITM's text; and events.
#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "service/board_verbs.h"

namespace capsoc::service {
namespace {

constexpr std::size_t most_waiting = std::size_t{16} << 20;

/// The number of a UART or a GPIO; the Error says how many there are.
Result<std::size_t> number(const Call& call, const char* name, std::size_t count) {
  const uint64_t given = call.integer(name);
  if (given < count) return static_cast<std::size_t>(given);
  return Error{fmt::format("there is no {} {}; they are 0 to {}", name, given, count - 1)};
}

/// The text of a stream since this was asked last: a UART's, or one of the session's own.
template <typename Stream>
Answer taken(Stream& stream, const Call& call) {
  Answer answer;
  uint64_t lost = 0;
  std::string text = stream.take(lost);
  if (call.has("raw") && call.boolean("raw"))
    answer.add_bytes("text", std::move(text));
  else
    answer.result["text"] = std::move(text);
  answer.result["lost"] = lost;
  return answer;
}

Answer send_uart(Board& board, const Call& call) {
  const auto uart = number(call, "uart", soc::Soc::uart_count);
  if (!uart) return refuse(uart.error());
  UartTap& tap = board.uart(uart.value());
  const std::string bytes = call.bytes("bytes");
  if (bytes.size() > most_waiting - tap.waiting().size())
    return refuse(
        fmt::format("uart{}: more than 16 MiB wait for the program; advance until it has taken "
                    "them",
                    uart.value()));
  tap.send(bytes);
  return {};
}

Answer read_uart(Board& board, const Call& call) {
  const auto uart = number(call, "uart", soc::Soc::uart_count);
  if (!uart) return refuse(uart.error());
  return taken(board.uart(uart.value()), call);
}

Answer read_itm(Board& board, const Call& call) {
  const TextField& place = board.settings().itm.backend;
  if (place() == "stdout") return taken(board.itm(), call);
  return refuse(fmt::format("itm.read: the text goes to {}; construct with {}=stdout", place(),
                            place.about().path));
}

/// The console of semihosting, if it is this session's.
std::optional<Answer> no_console(Board& board, const char* method) {
  const TextField& place = board.settings().semihosting.console;
  if (const std::string at = place(); at == "stdout" || at == "stderr" || at == "stdio")
    return std::nullopt;
  return refuse(
      fmt::format("{}: the console is {}; leave {} out", method, place(), place.about().path));
}

Answer read_console(Board& board, const Call& call) {
  if (auto refusal = no_console(board, "semihosting.read")) return std::move(*refusal);
  return taken(board.console(), call);
}

Answer give_console(Board& board, const Call& call) {
  if (auto refusal = no_console(board, "semihosting.send")) return std::move(*refusal);
  const std::string bytes = call.bytes("bytes");
  if (bytes.size() > most_waiting - std::min(most_waiting, board.console().given().size()))
    return refuse(
        "semihosting.send: more than 16 MiB wait for the program; advance until it has "
        "read them");
  board.console().give(bytes);
  if (call.has("end") && call.boolean("end")) board.console().end_input();
  return {};
}

Answer drive_pin(Board& board, const Call& call) {
  const auto gpio = number(call, "gpio", board.soc().gpios().size());
  if (!gpio) return refuse(gpio.error());
  const auto pin = number(call, "pin", cmsdk::Gpio::pin_count);
  if (!pin) return refuse(pin.error());
  const Json& level = call.json("level");
  if (!level.is_boolean() && !level.is_null())
    return refuse("pin.drive: the parameter 'level' has to be true, false or null",
                  Code::wrong_parameter);
  const auto mask = static_cast<uint16_t>(1U << pin.value());
  board.soc().gpios()[gpio.value()]->drive(mask, level == Json(true) ? mask : uint16_t{0});
  return {};
}

Answer read_pins(Board& board, const Call& call) {
  const auto gpio = number(call, "gpio", board.soc().gpios().size());
  if (!gpio) return refuse(gpio.error());
  const cmsdk::Gpio& port = *board.soc().gpios()[gpio.value()];
  Answer answer;
  for (const auto& [name, bits] :
       {std::pair("pins", port.pins()), std::pair("driven", port.driven())}) {
    Json& list = answer.result[name] = Json::array();
    for (unsigned pin = 0; pin < cmsdk::Gpio::pin_count; ++pin)
      list.push_back((bits >> pin & 1U) != 0);
  }
  return answer;
}

Answer press_button(Board& board, const Call& call) {
  const auto button = number(call, "button", 2);
  if (!button) return refuse(button.error());
  an385::FpgaIo& io = board.soc().fpgaio;
  const uint32_t mask = 1U << button.value();
  io.set_buttons(call.boolean("pressed") ? io.BUTTON.get() | mask : io.BUTTON.get() & ~mask);
  return {};
}

Answer subscribe(Board& board, const Call& call) {
  if (auto error = board.subscribe(call.texts("kinds"))) return refuse(error->text);
  return {};
}

}  // namespace

std::vector<BoardVerb> port_verbs() {
  const Parameter raw = may("raw", Type::boolean, "the text as an array of bytes, none replaced");
  const std::vector<Member> text_taken = {
      {"text", "text", "bytes that are no UTF-8 are replaced"},
      {"lost", "integer", "bytes before it that were too many to be kept (2 MiB)"}};
  return {
      {{"uart.send",
        "Sends bytes to a UART of the board, which takes them as fast as the program receives "
        "them.",
        {need("uart", Type::integer, "0 to 4"), need("bytes", Type::bytes, "what is sent")},
        {}},
       send_uart,
       Effect::input},
      {{"uart.read",
        "What a UART has sent since this was asked last, or since a pattern was found "
        "(simulation.advance).",
        {need("uart", Type::integer, "0 to 4"), raw},
        text_taken},
       read_uart,
       Effect::looks_after_the_end},
      {{"itm.read",
        "What the program has written to the ITM's stimulus port since this was asked last. It "
        "needs the setting itm.backend=stdout, which is a session's own stream; then the port is "
        "enabled as by a debugger.",
        {raw},
        text_taken},
       read_itm,
       Effect::looks_after_the_end},
      {{"semihosting.read",
        "What the program has written to the console of semihosting (:tt) since this was asked "
        "last.",
        {raw},
        text_taken},
       read_console,
       Effect::looks_after_the_end},
      {{"semihosting.send",
        "Bytes for the program's next reads of the console, a line each. A read with none left is "
        "at the end of the input. With the setting semihosting.console=stdio it waits for more, "
        "unless the end was said, and simulation.advance stops there.",
        {need("bytes", Type::bytes, "what it reads"),
         may("end", Type::boolean, "nothing comes after these")},
        {}},
       give_console,
       Effect::input},
      {{"pin.drive",
        "Drives a pin of a GPIO from outside, from this instant on.",
        {need("gpio", Type::integer, "0 to 3"), need("pin", Type::integer, "0 to 15"),
         need("level", Type::any, "true: high, false: low, null: it is not driven, and it is low")},
        {}},
       drive_pin,
       Effect::input},
      {{"pin.read",
        "The levels at the pins of a GPIO.",
        {need("gpio", Type::integer, "0 to 3")},
        {{"pins", "list", "16 levels, true is high"},
         {"driven", "list", "whether the chip drives each"}}},
       read_pins,
       Effect::looks},
      {{"button.press",
        "Presses or releases one of the two buttons.",
        {need("button", Type::integer, "0 or 1"), need("pressed", Type::boolean, "or released")},
        {}},
       press_button,
       Effect::input},
      {{"events.subscribe",
        "Which events the next answers of simulation.advance carry; an empty list ends it.",
        {need("kinds", Type::list,
              "exception, fault, guest_error, sample (a result is there), uart (a line was sent), "
              "verdict (the program's own, seen at the next result or at the end of the run), "
              "pins (an output changed)")},
        {}},
       subscribe,
       Effect::looks},
  };
}

}  // namespace capsoc::service
