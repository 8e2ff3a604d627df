// Registers that a call changes, by their numbers in DWARF and in instructions.
#pragma once

namespace capsoc::source {

inline constexpr unsigned stack_pointer = 13, link = 14, program_counter = 15;

}  // namespace capsoc::source
