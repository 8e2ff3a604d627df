// What a person reads when the firmware crashed, or ended otherwise than it should.
#pragma once

#include <string>

#include "run/program_view.h"

namespace capsoc::run {

/// The first fault of the chain: its cause in words, the address, the line, the call stack and the
/// registers with what they point at; then where the processor is now.
std::string describe_fault(const ProgramView& view);

/// Of a program that did not crash: where it is, the call stack, and which exceptions wait for
/// what.
std::string describe_place(const ProgramView& view);

}  // namespace capsoc::run
