// LMS demodulator (LMSED, Eqs (13) to (20)): one channel, one sample.
#pragma once

#include "coprocessor/reference_generator.h"
#include "coprocessor/types.h"

namespace capsoc::coprocessor {

struct Demodulation {
  Weights weights;    // after the update
  int32_t error = 0;  // Q1.31, data minus estimate, before the update
  bool error_saturated = false;
  bool weights_saturated = false;
};

// Q2.46 to Q2.31, half up: the form in which weights enter multiplications (s34).
constexpr int64_t weight_q31(int64_t weight) {
  return (weight + (int64_t{1} << 14)) >> 15;
}

// The word of a weight in the paper's arithmetic: bits 46 to 15, Q1.31. The others are its sign and
// zeros, unless a fault has changed them.
constexpr int32_t paper_word(int64_t weight) {
  return static_cast<int32_t>(weight >> 15);
}

// The error that an update sees with JUDGE.SLEW = n (0..7): within [-4^-n, 4^-n - 2^-31], Q1.31.
int32_t limited_error(int32_t error, unsigned slew);

// Weights with 15 guard bits, every product rounded half up. The estimate is of `weights`, the
// update is added to `base`: the weights again, or the sums of a block.
Demodulation demodulate(const Weights& weights, const Weights& base, const Steps& steps,
                        int32_t data, const Rotation& reference, unsigned slew = 0);
inline Demodulation demodulate(const Weights& weights, const Steps& steps, int32_t data,
                               const Rotation& reference, unsigned slew = 0) {
  return demodulate(weights, weights, steps, data, reference, slew);
}

// 32-bit weights, every product truncated to Q1.31, steps shifted right by step_shift.
Demodulation demodulate_paper(const Weights& weights, const Steps& steps, int32_t data,
                              const Rotation& reference, int step_shift, unsigned slew = 0);

// Moving average of |error| with weight 2^-6: the accumulator holds 64 times the average (Q1.37,
// unsigned 38 bits).
uint64_t next_error_sum(uint64_t sum, int32_t error);
// The average, Q1.31 (at most 2^31).
uint32_t error_average(uint64_t sum);

}  // namespace capsoc::coprocessor
