#include "view/controls.h"

#include <map>
#include <optional>

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

std::string inject(RunSession& session, const Json& command) {
  const auto fault = command.find("fault");
  if (fault == command.end() || !fault->is_string()) return "fault: \"fault\" is missing";
  return session.ask("fault.inject", {{"fault", *fault}}).sentence;
}

}  // namespace

std::optional<std::string> carry_out(RunSession& session, const Json& command) {
  static const std::map<std::string, std::string> methods = {{"button", "button.press"},
                                                             {"reset", "processor.reset"}};
  const auto what = command.at("do").get<std::string>();
  if (what == "uart") return send_text(session, command);
  if (what == "fault") return inject(session, command);
  if (what == "sensor") return change_sensor(session, command);
  const auto found = methods.find(what);
  if (found == methods.end()) return std::nullopt;
  return hand_on(session, found->second, command);
}

}  // namespace capsoc::view
