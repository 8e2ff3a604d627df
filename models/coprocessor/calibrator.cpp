#include "coprocessor/calibrator.h"

#include "coprocessor/lms_demodulator.h"
#include "coprocessor/paper_units.h"

namespace capsoc::coprocessor {

using fixed::int128;
using fixed::multiply;
using fixed::saturate32;

Calibrated calibrate(int32_t u, int32_t v, const Coefficients& coefficients) {
  const int64_t a_u = weight_q31(coefficients.u.sine);
  const int64_t b_u = weight_q31(coefficients.u.cosine);
  const int64_t a_v = weight_q31(coefficients.v.sine);
  const int64_t b_v = weight_q31(coefficients.v.cosine);
  const int64_t du = u - weight_q31(coefficients.u.constant);
  const int64_t dv = v - weight_q31(coefficients.v.constant);
  Calibrated out;
  out.s = multiply(b_v, du) - multiply(b_u, dv);
  out.c = multiply(a_u, dv) - multiply(a_v, du);
  const int128 det = multiply(a_u, b_v) - multiply(a_v, b_u);
  bool clamped = false;
  out.det = saturate32(fixed::round_shift(det, 31), clamped);
  out.mirror = det < 0;
  if (out.mirror) {
    out.s = -out.s;
    out.c = -out.c;
  }
  return out;
}

Calibrated calibrate_paper(int32_t u, int32_t v, const Parameters& parameters) {
  const auto product = [](int64_t a, int64_t b) { return (a * b) >> 31; };
  const paper::Table beta = paper::look_up(parameters.beta);
  Calibrated out;
  const int64_t du = saturate32(int64_t{u} - parameters.b1, out.saturated);
  const int64_t dv = saturate32(int64_t{v} - parameters.b2, out.saturated);
  const int64_t u1 = saturate32(product(parameters.a2, du), out.saturated);
  const int64_t v1 = saturate32(product(parameters.a1, dv), out.saturated);
  out.s = saturate32(product(u1, beta.cosine), out.saturated);
  out.c = saturate32(v1 + product(u1, beta.sine), out.saturated);
  bool clamped = false;
  const int64_t area = saturate32(product(parameters.a1, parameters.a2), clamped);
  out.det = saturate32(product(area, beta.cosine), clamped);
  // The paper has no such flag; cos(beta) < 0 is how its parameters show reverse rotation.
  out.mirror = beta.cosine < 0;
  return out;
}

Weights coefficients_u(const Parameters& parameters, int32_t sine, int32_t cosine) {
  const auto product = [&](int64_t a) { return fixed::round_shift(parameters.a1 * a, 16); };
  return {product(cosine), product(sine), fixed::scale_up(int64_t{parameters.b1}, 15)};
}

Weights coefficients_v(const Parameters& parameters, int32_t sine, int32_t cosine) {
  const auto product = [&](int64_t a) { return fixed::round_shift(parameters.a2 * a, 16); };
  return {product(-int64_t{sine}), product(cosine), fixed::scale_up(int64_t{parameters.b2}, 15)};
}

}  // namespace capsoc::coprocessor
