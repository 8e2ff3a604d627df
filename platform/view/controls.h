// The commands of a page that ask something of the simulation.
#pragma once

#include <string>

#include "service/run_session.h"
#include "view/hub.h"

namespace capsoc::view {

/// Carries out one of sensor, fault, uart, button and reset, each by a method that the session
/// records. What is wrong is a sentence that says what to do; "": it was done. Null: the command
/// is none of these.
///
///   {"do": "sensor", "parameters": {"a1": 0.5}}     as sensor.set, and "speed" as sensor.speed
///   {"do": "fault", "fault": "flip cpu.r3[5]"}      as fault.inject
///   {"do": "uart", "uart": 0, "text": "help\r"}
///   {"do": "button", "button": 0, "pressed": true}
///   {"do": "reset"}
std::optional<std::string> carry_out(service::RunSession& session, const Json& command);

}  // namespace capsoc::view
