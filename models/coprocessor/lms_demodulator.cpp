#include "coprocessor/lms_demodulator.h"

#include <algorithm>

#include "base/fixed.h"

namespace capsoc::coprocessor {
namespace {

using fixed::int128;
using fixed::multiply;
using fixed::round_shift;
using fixed::saturate;
using fixed::saturate32;

// err * 2mu in Q2.46.
inline int64_t gained_error(int32_t error, uint32_t step) {
  return round_shift(int64_t{error} * int64_t{step}, 16);
}

inline int64_t update(int64_t weight, int64_t gained, int32_t reference, bool& saturated) {
  const auto delta = static_cast<int64_t>(round_shift(multiply(gained, reference), 31));
  return saturate<48>(weight + delta, saturated);
}

inline int64_t truncated_product(int64_t a, int64_t b) {
  return (a * b) >> 31;
}

inline int64_t update_paper(int64_t weight, int64_t gained, int32_t reference, bool& saturated) {
  const int64_t sum = weight + truncated_product(gained, reference);
  return fixed::scale_up(saturate<32>(sum, saturated), 15);
}

}  // namespace

int32_t limited_error(int32_t error, unsigned slew) {
  const int32_t most = INT32_MAX >> (2 * slew);
  return std::clamp(error, -most - 1, most);
}

Demodulation demodulate(const Weights& weights, const Weights& base, const Steps& steps,
                        int32_t data, const Rotation& reference, unsigned slew) {
  Demodulation out;
  const int128 products = multiply(weight_q31(weights.sine), reference.sine) +
                          multiply(weight_q31(weights.cosine), reference.cosine);
  const int64_t estimate =
      static_cast<int64_t>(round_shift(products, 31)) + weight_q31(weights.constant);
  out.error = saturate32(data - estimate, out.error_saturated);
  const int32_t error = limited_error(out.error, slew);
  out.weights.sine =
      update(base.sine, gained_error(error, steps.sine), reference.sine, out.weights_saturated);
  out.weights.cosine = update(base.cosine, gained_error(error, steps.cosine), reference.cosine,
                              out.weights_saturated);
  // The third reference is exactly one: no multiplication, no second rounding.
  out.weights.constant =
      saturate<48>(base.constant + gained_error(error, steps.constant), out.weights_saturated);
  return out;
}

Demodulation demodulate_paper(const Weights& weights, const Steps& steps, int32_t data,
                              const Rotation& reference, int step_shift, unsigned slew) {
  Demodulation out;
  const int64_t sine = paper_word(weights.sine);
  const int64_t cosine = paper_word(weights.cosine);
  const int64_t constant = paper_word(weights.constant);
  const int64_t estimate = truncated_product(sine, reference.sine) +
                           truncated_product(cosine, reference.cosine) + constant;
  out.error = saturate32(data - estimate, out.error_saturated);
  const int32_t error = limited_error(out.error, slew);
  const auto gained = [&](uint32_t step) {
    return truncated_product(error, int64_t{step} >> step_shift);
  };
  out.weights.sine = update_paper(sine, gained(steps.sine), reference.sine, out.weights_saturated);
  out.weights.cosine =
      update_paper(cosine, gained(steps.cosine), reference.cosine, out.weights_saturated);
  out.weights.constant =
      fixed::scale_up(saturate<32>(constant + gained(steps.constant), out.weights_saturated), 15);
  return out;
}

uint64_t next_error_sum(uint64_t sum, int32_t error) {
  const auto magnitude = static_cast<uint64_t>(error < 0 ? -int64_t{error} : int64_t{error});
  return sum + magnitude - round_shift(sum, 6);
}

uint32_t error_average(uint64_t sum) {
  return static_cast<uint32_t>(round_shift(sum, 6));
}

}  // namespace capsoc::coprocessor
