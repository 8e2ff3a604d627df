#pragma once

#include <cstdint>

namespace capsoc::peripherals {

constexpr unsigned minimum_bits = 12;
constexpr unsigned maximum_bits = 32;

struct Quantised {
  int32_t word;  ///< two's complement, left-justified in 32 bits: Q1.31
  bool clipped;  ///< the rounded value lay outside the range
};

/// One ideal conversion: `x` in units of full scale (-1 to below 1) to `bits` bits, rounded half up
/// and clipped. No number (NaN) counts as a clipped 0. `bits` outside 12 to 32 counts as the nearer
/// limit.
Quantised quantise(double x, unsigned bits);

}  // namespace capsoc::peripherals
