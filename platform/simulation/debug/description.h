// The XML documents that GDB reads with qXfer.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace capsoc::debug {

/// Features org.gnu.gdb.arm.m-profile and org.gnu.gdb.arm.m-system.
std::string target_description();

/// A range that a debugger may read and write.
struct MemoryRange {
  uint64_t start, length;
};
/// All of type ram: GDB loads by plain writes, and refuses only what is not listed.
std::string memory_map(const std::vector<MemoryRange>& ranges);

std::string thread_list(const std::string& state);

}  // namespace capsoc::debug
