// The units that the SoC paper describes and the precise arithmetic does without.
#pragma once

#include <cstdint>

namespace capsoc::coprocessor::paper {

struct Table {
  int32_t sine = 0;
  int32_t cosine = 0;
};

// Sine and cosine from a table of 512 per turn with linear interpolation, Q1.31, truncated.
// angle: 2^-32 turn.
Table look_up(uint32_t angle);

// Square root by Eq (10), y <- y^2 - x + y from 0, 30 iterations, then negated: as printed the
// iteration converges to the negative root. square: Q1.31, not negative. Serves roots 0.2 .. 0.8.
int32_t square_root(int32_t square);

// Amplitude sqrt(a^2 + b^2) of Eq (9), Q1.31; sets `saturated` when the sum of squares is 1 or
// more.
int32_t amplitude(int32_t a, int32_t b, bool& saturated);

// Arctangent by the PI loop of Eq (11) from 0, 30 iterations, P = 0, I = 1.9 rad per unit error.
// y, x: Q1.31; result 2^-32 turn. Both multiplications take operands cut to `operand_bits` bits.
// Needs amplitudes of about 0.3 .. 0.9; an input at exactly half a turn stays at 0.
uint32_t arctangent(int32_t y, int32_t x, int operand_bits);

struct Polar {
  uint32_t angle = 0;     // 2^-32 turn
  int32_t magnitude = 0;  // Q1.31, along that angle; 0 .. 2^31 - 1
  bool settled = false;   // the angle is right to 2^-10 rad, or there is none
};

// Angle by arctangent() and the magnitude along it. Unless `plain`, the vector is shifted so that
// the loop converges at any amplitude, and folded into the right half plane.
Polar to_polar(int32_t y, int32_t x, int operand_bits, bool plain);

}  // namespace capsoc::coprocessor::paper
