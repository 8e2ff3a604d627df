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

}  // namespace capsoc::registers
