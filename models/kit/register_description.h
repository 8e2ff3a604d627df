#pragma once

#include <cstdint>

namespace capsoc::registers {

enum class Access : uint8_t { read_only, read_write, write_only };

/// One register as its description has it. Masks select bits of the 32-bit word.
struct RegisterDescription {
  const char* name;
  uint32_t offset;  ///< bytes from the base of the peripheral
  Access access;
  uint32_t reset;
  uint32_t writable_mask;      ///< bits that take the value written
  uint32_t one_to_clear_mask;  ///< bits that a written 1 clears
  uint32_t readable_mask;      ///< bits that can read as something other than 0
};

/// A field of a register, which it names.
struct FieldDescription {
  const char *reg, *name;
  unsigned low, bits;
};

/// Value of a register with the value `old` after a write to the bytes in `lanes` (a mask).
/// Writable bits take the written value; write-1-to-clear bits are cleared by a 1.
constexpr uint32_t stored(const RegisterDescription& about, uint32_t old, uint32_t written,
                          uint32_t lanes) {
  const uint32_t takes = about.writable_mask & lanes;
  const uint32_t clears = about.one_to_clear_mask & ~about.writable_mask & lanes & written;
  return (old & ~takes & ~clears) | (written & takes);
}

}  // namespace capsoc::registers
