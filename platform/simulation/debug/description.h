// The XML documents that GDB reads with qXfer.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "debug/target.h"

namespace capsoc::debug {

/// Features org.gnu.gdb.arm.m-profile and org.gnu.gdb.arm.m-system, with the registers that the
/// target has.
std::string target_description(Target& target);

/// All of type ram: GDB loads by plain writes, and refuses only what is not listed.
std::string memory_map(const std::vector<MemoryRange>& ranges);

/// The answer to LLDB's qMemoryRegionInfo: the range or the hole around an address, up to its
/// neighbours. A hole has no permissions.
std::string region_info(std::vector<MemoryRange> ranges, uint32_t address);

std::string thread_list(Target& target);

}  // namespace capsoc::debug
