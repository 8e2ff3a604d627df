// What unwinding works on.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>

namespace capsoc::source {

/// r0 to r15 of one frame: 13 its stack pointer, 14 what LR holds, 15 where it continues.
using Registers = std::array<uint32_t, 16>;

/// A word of the program's memory, nothing where there is none.
using ReadWord = std::function<std::optional<uint32_t>(uint32_t address)>;

}  // namespace capsoc::source
