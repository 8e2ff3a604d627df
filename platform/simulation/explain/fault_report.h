// What a person reads when the firmware crashed, or ended otherwise than it should.
#pragma once

#include <string>
#include <vector>

#include "explain/program_view.h"
#include "serial/serial_line.h"

namespace capsoc::run {

/// What an observer kept during the run for a report.
struct Finding {
  std::string heading;  ///< in the middle of a report, without its colon
  std::string text;     ///< lines, each indented by four
};
using Findings = std::vector<Finding>;

/// The first fault of the chain: its cause in words, the address, the line, the call stack and the
/// registers with what they point at; then where the processor is now.
std::string describe_fault(const ProgramView& view, const Findings& findings);

/// Of a program that did not crash: where it is, the call stack, and which exceptions wait for
/// what.
std::string describe_place(const ProgramView& view, const Findings& findings);

/// Of a line that --fail-uart names: who printed it.
std::string describe_line(const serial::SerialLine& uart, const ProgramView& view,
                          const std::string& call_stack);

}  // namespace capsoc::run
