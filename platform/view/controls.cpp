#include "view/controls.h"

#include <fmt/format.h>

#include <cstdint>
#include <map>
#include <optional>

#include "base/number.h"
#include "base/printable.h"
#include "service/verb.h"

namespace capsoc::view {
namespace {

using service::Answer;
using service::RunSession;

/// A request of the session with the members of the command that belong to it.
std::string hand_on(RunSession& session, const std::string& method, const Json& command) {
  Json parameters = command;
  parameters.erase("do");
  return session.ask(method, parameters).sentence;
}

/// The motion is no key of the description that may change on the way; its speed is.
std::string change_sensor(RunSession& session, const Json& command) {
  Json parameters = command.value("parameters", Json());
  if (!parameters.is_object()) return "sensor: give \"parameters\", an object of names and values";
  if (const auto speed = parameters.find("speed"); speed != parameters.end()) {
    const Answer answer = session.ask("sensor.speed", {{"factor", *speed}});
    if (!answer.ok()) return answer.sentence;
    parameters.erase(speed);
  }
  if (parameters.empty()) return "";
  return session.ask("sensor.set", {{"parameters", parameters}}).sentence;
}

std::string send_text(RunSession& session, const Json& command) {
  const auto text = command.find("text");
  if (text == command.end() || !text->is_string()) return "uart: \"text\" is missing";
  return session.ask("uart.send", {{"uart", command.value("uart", Json(0))}, {"bytes", *text}})
      .sentence;
}

std::string flip_register(RunSession& session, const std::string& name, unsigned bit) {
  const Answer read = session.ask("register.read", {{"name", name}});
  if (!read.ok()) return read.sentence;
  const auto value = read.result.at("value").get<uint32_t>();
  return session.ask("register.write", {{"name", name}, {"value", value ^ 1U << bit}}).sentence;
}

std::string flip_processor(RunSession& session, const std::string& name, unsigned bit) {
  const Answer read = session.ask("processor.read");
  if (!read.ok()) return read.sentence;
  const Json& all = read.result.at("registers");
  const auto found = all.find(name);
  if (found == all.end())
    return fmt::format("flip: the processor has no register '{}'", printable(name, 80));
  const auto value = found->get<uint32_t>() ^ 1U << bit;
  return session.ask("processor.write", {{"register", name}, {"value", value}}).sentence;
}

std::string flip_memory(RunSession& session, const std::string& place, unsigned bit) {
  const auto number = whole_number(place);
  if (!number || *number > UINT32_MAX - bit / 8)
    return fmt::format("flip: 'mem:{}' is no address; write mem:0x20000000", printable(place, 80));
  const Json address = *number + bit / 8;
  const Answer read = session.ask("memory.read", {{"address", address}, {"size", 1}});
  if (!read.ok()) return read.sentence;
  const std::string bytes = service::bytes_in(read.result.at("bytes"), read.frames);
  const auto byte = static_cast<uint8_t>(static_cast<uint8_t>(bytes.at(0)) ^ 1U << bit % 8);
  return session.ask("memory.write", {{"address", address}, {"bytes", {byte}}}).sentence;
}

std::string flip(RunSession& session, const Json& command) {
  const auto place = command.find("place"), bit = command.find("bit");
  if (place == command.end() || !place->is_string() || bit == command.end() ||
      !bit->is_number_unsigned() || bit->get<uint64_t>() > 31)
    return "flip: give \"place\", a text, and \"bit\", from 0 to 31";
  const auto name = place->get<std::string>();
  const auto number = bit->get<unsigned>();
  if (name.rfind("cpu.", 0) == 0) return flip_processor(session, name.substr(4), number);
  if (name.rfind("mem:", 0) == 0) return flip_memory(session, name.substr(4), number);
  return flip_register(session, name, number);
}

}  // namespace

std::optional<std::string> carry_out(RunSession& session, const Json& command) {
  static const std::map<std::string, std::string> methods = {{"button", "button.press"},
                                                             {"reset", "processor.reset"}};
  const auto what = command.at("do").get<std::string>();
  if (what == "uart") return send_text(session, command);
  if (what == "flip") return flip(session, command);
  if (what == "sensor") return change_sensor(session, command);
  const auto found = methods.find(what);
  if (found == methods.end()) return std::nullopt;
  return hand_on(session, found->second, command);
}

}  // namespace capsoc::view
