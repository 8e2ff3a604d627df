#pragma once

#include <cstdint>

#include "kit/register_description.h"

namespace capsoc::registers {

inline constexpr unsigned no_pair = ~0u;

/// The description of one word of a peripheral: its register, the values that a write may have, and
/// the 48-bit pair that the register belongs to.
struct RegisterRule {
  const RegisterDescription* about = nullptr;  ///< null: no register at this word
  uint32_t lowest = 0, highest = 0;            ///< a write outside is refused
  unsigned pair = no_pair;                     ///< number of the pair, NAME_LO and NAME_HI
  bool high = false;                           ///< it is the pair's HI
  const char* reserved_complaint = "";  ///< for the log, of a write to reserved bits; or empty

  constexpr bool in_range(uint32_t value) const { return value >= lowest && value <= highest; }
  constexpr bool read_only() const { return about->access == Access::read_only; }
};

}  // namespace capsoc::registers
