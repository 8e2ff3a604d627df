// Calibrator: from a sample to the pair (S, C) that is proportional to (sin, cos) of the angle.
#pragma once

#include "base/fixed.h"
#include "coprocessor/types.h"

namespace capsoc::coprocessor {

struct Calibrated {
  fixed::int128 s = 0;  // `fraction_bits` fraction bits
  fixed::int128 c = 0;
  int32_t det = 0;      // a_u b_v - a_v b_u, Q1.31 (paper: a1 a2 cos beta)
  bool mirror = false;  // the sensor turns against the reference
  bool saturated = false;
};

// Adjugate of the coefficient matrix applied to the sample less its offsets (Q62, 68 bits):
// S = b_v du - b_u dv, C = a_u dv - a_v du, both negated when det = a_u b_v - a_v b_u < 0.
// It needs no square root, cosine or division; the angle of (S, C) is relative to the reference.
Calibrated calibrate(int32_t u, int32_t v, const Coefficients& coefficients);

// Eq (12) on 32-bit words, products truncated: U2 and V2 in Q31. The angle of (U2, V2) contains
// phi.
Calibrated calibrate_paper(int32_t u, int32_t v, const Parameters& parameters);

// Eq (8): the coefficients that the parameters stand for; `first` = (sin, cos) of phi gives u,
// `second` = (sin, cos) of phi + beta gives v.
Weights coefficients_u(const Parameters& parameters, int32_t sine, int32_t cosine);
Weights coefficients_v(const Parameters& parameters, int32_t sine, int32_t cosine);

}  // namespace capsoc::coprocessor
