#include "run/uart_lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <thread>

#include "host/console.h"
#include "serial/open_backend.h"

namespace capsoc::run {
namespace {

const sc_core::sc_time look_interval(1, sc_core::SC_MS);
constexpr std::chrono::microseconds shortest_look{200};  // asking the host costs a system call
constexpr std::chrono::milliseconds idle_nap{1};

std::string setting(std::size_t number, const char* what) {
  return fmt::format("uart{}.{}", number, what);
}

}  // namespace

void add_uart_settings(Settings& settings) {
  const auto add = [&](const std::string& path, SettingKind kind, const char* value,
                       std::string help) {
    settings.add({path, kind, value, std::move(help), {}, 0, 0});
  };
  for (std::size_t n = 0; n < 5; ++n) {
    add(setting(n, "backend"), SettingKind::backend, n == 0 ? "stdout" : "null",
        serial::backend_names);
    add(setting(n, "input"), SettingKind::input, "",
        "bytes for the receiver from this file instead of the backend; empty: the backend's");
    add(setting(n, "log"), SettingKind::output, "", "copy of what it sends; empty: none");
  }
  add("run.uart_wait", SettingKind::flag, "false",
      "a UART's first byte waits until somebody listens on its pty or tcp");
  add("run.until_uart", SettingKind::text, "",
      "a line of any UART that matches this regular expression ends the run with 0; empty: none");
  add("run.fail_uart", SettingKind::text, "", "the same with 1");
}

bool is_uart_place(const std::string& setting) {
  if (setting == "run.uart_wait") return true;
  const std::size_t dot = setting.find('.');
  const std::string what = dot == std::string::npos ? "" : setting.substr(dot + 1);
  return setting.rfind("uart", 0) == 0 && (what == "backend" || what == "log");
}

UartLines::UartLines(const sc_core::sc_module_name& name, soc::Soc& soc, serial::GiveUp give_up)
    : sc_module(name), soc_(soc), give_up_(std::move(give_up)) {
  SC_HAS_PROCESS(UartLines);
  SC_METHOD(look);
}

std::optional<Error> UartLines::open(const Settings& settings) {
  auto patterns =
      serial::Patterns::make(settings.text("run.until_uart"), settings.text("run.fail_uart"));
  if (!patterns) return Error{patterns.error()};
  for (std::size_t n = 0; n < lines_.size(); ++n)
    for (std::size_t m = 0; m < n; ++m)
      if (const std::string& spec = settings.text(setting(n, "backend"));
          serial::are_the_same_place(spec, settings.text(setting(m, "backend"))))
        return Error{fmt::format("--uart{} {}: is taken by uart{}; name another one", n, spec, m)};
  for (std::size_t n = 0; n < lines_.size(); ++n) {
    auto line = serial::SerialLine::open(
        {fmt::format("uart{}", n), settings.text(setting(n, "backend")),
         settings.text(setting(n, "input")), settings.text(setting(n, "log")),
         settings.text("run.uart_wait") == "true", patterns.value()},
        give_up_);
    if (!line) return Error{line.error()};
    lines_[n] = std::move(line.value());
    connect(n);
  }
  for (const auto& line : lines_)
    if (const std::string place = line->backend().place(); !place.empty())
      host::say("{}: {}\n", line->name(), place);
  return std::nullopt;
}

void UartLines::connect(std::size_t number) {
  peripherals::Uart& uart = *soc_.uarts()[number];
  serial::SerialLine& line = *lines_[number];
  uart.on_transmit([&](uint8_t byte) { line.transmitted(byte, uart.transmitter_idle()); });
  uart.set_source([&] { return line.next_input(); });
  line.on_match([] {
    if (sc_core::sc_is_running()) sc_core::sc_stop();  // not for what is flushed at the end
  });
}

/// Runs while the host may have something to say; then it is what keeps a sleeping board alive.
void UartLines::look() {
  flush();
  const auto now = std::chrono::steady_clock::now();
  if (now - looked_ >= shortest_look) {
    looked_ = now;
    // The receivers of a board that waits for its state are not themselves yet.
    if (!soc_.cpu.waits_for_resume())
      for (peripherals::Uart* uart : soc_.uarts()) uart->look_for_input();
    // With nothing else to do, simulated time need not race.
    if (!sc_core::sc_pending_activity()) std::this_thread::sleep_for(idle_nap);
    if (give_up_()) return sc_core::sc_stop();
  }
  if (std::any_of(lines_.begin(), lines_.end(), [](const auto& line) { return line->live(); }))
    next_trigger(look_interval);
}

void UartLines::flush() {
  for (const auto& line : lines_) line->flush();
}

void UartLines::finish() {
  for (std::size_t n = 0; n < lines_.size(); ++n) {
    soc_.uarts()[n]->flush();
    lines_[n]->finish();
  }
}

const serial::SerialLine* UartLines::matched() const {
  const serial::SerialLine* found = nullptr;
  for (const auto& line : lines_)
    if (line->match() && (found == nullptr || line->match()->failed)) found = line.get();
  return found;
}

std::vector<std::string> UartLines::failures() const {
  std::vector<std::string> sentences;
  for (const auto& line : lines_)
    for (std::string& text : line->failures()) sentences.push_back(std::move(text));
  return sentences;
}

void UartLines::visit(kit::Archive& archive) {
  for (const auto& line : lines_) archive(line->name().c_str(), *line);
}

}  // namespace capsoc::run
