// Clamps whose flag nothing else of the sample raises: the weights that cause one are gone before
// the stages after it read theirs.
#include <array>

#include "coprocessor/register_map.h"
#include "regress/scenario.h"

namespace capsoc::regress {

using namespace coprocessor;

namespace {

using SixWeights = std::array<int64_t, 6>;  // Q2.46: a_u, b_u, c_u, a_v, b_v, c_v

// Results of `weights` in T0 alone; from T3 on the sample lies where weights of 1/4 have their
// offset.
void calibrate_with(Bench& bench, const SixWeights& weights, int32_t u, int32_t v) {
  constexpr int64_t quarter = int64_t{1} << 44;
  const SixWeights behind = {quarter, 0, int64_t{u} * 0x8000, 0, quarter, int64_t{v} * 0x8000};
  bench.drain();
  bench.wait(2);
  bench.write(reg_ctrl, ctrl_srst);
  bench.write(reg_ctrl, ctrl_adc | ctrl_demod | ctrl_calib);
  for (uint32_t i = 0; i < 6; ++i) bench.write_pair(reg_au_lo + 8 * i, weights[i]);
  bench.sample(static_cast<uint32_t>(u), static_cast<uint32_t>(v));
  bench.wait(2);
  for (uint32_t i = 0; i < 6; ++i) bench.write_pair(reg_au_lo + 8 * i, behind[i]);
  bench.drain();
  bench.read(reg_flags);
}

}  // namespace

void run_lone_clamps(Bench& bench, Random& random, const Budget&) {
  constexpr int64_t one = int64_t{1} << 46, small = int64_t{1} << 30;  // 2^15 units of Q1.31
  // DET: no flag.
  for (int64_t area : {one, one + one / 2, -one - one / 2})
    calibrate_with(bench, {one + one / 2, 0, 0, 0, area, 0}, 1 << 20, 1 << 20);
  // C, then S, are one half of a unit below 1 and rounded to 1; the magnitude stays below, if the
  // CORDIC's own error is negative. The other one is small and at random.
  for (unsigned i = 0; i < 24 && !bench.failed(); ++i) {
    const auto other = -static_cast<int64_t>(random.between(20000, 30000)) * 0x8000;
    calibrate_with(bench, {one, other, 0, -small, small, 0}, 1 << 15, INT32_MAX);
    calibrate_with(bench, {small, -small, 0, other, one, 0}, INT32_MAX, 1 << 15);
  }
}

}  // namespace capsoc::regress
