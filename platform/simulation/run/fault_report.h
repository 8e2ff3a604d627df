// What a person reads when the firmware crashed.
#pragma once

#include <string>

#include "cortex_m3/core.h"
#include "loader/elf_image.h"

namespace capsoc::run {

/// Fault registers decoded, PC and LR with symbol names, the stacked frame, the address.
std::string describe_fault(const cortex_m3::Core& core, const loader::ElfImage& image);

}  // namespace capsoc::run
