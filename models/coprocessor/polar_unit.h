// Polar unit: vectoring CORDIC with normalised input. Magnitude and four-quadrant angle together;
// it stands in for the paper's square root (Eq (10)) and PI arctangent (Eq (11)).
#pragma once

#include "base/fixed.h"
#include "coprocessor/types.h"

namespace capsoc::coprocessor {

struct Polar {
  uint32_t angle = 0;     // atan2(y, x), 2^-32 turn; 0 for a zero vector
  int32_t magnitude = 0;  // Q1.31, saturated
  bool zero = false;
  bool saturated = false;  // the magnitude was 1 or more
};

// y, x: signed, at most 80 bits, with `fraction_bits` (31..62) fraction bits each.
Polar to_polar(fixed::int128 y, fixed::int128 x, unsigned fraction_bits);

}  // namespace capsoc::coprocessor
