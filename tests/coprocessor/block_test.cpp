// Block learning (CTRL.BLOCK and GUARD): how soon and how exactly the parameters are found, what
// harmonics do to them, and what a shaft that stands still does not. The figures of
// docs/reference/coprocessor.md, "Block learning".
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <functional>
#include <random>

#include "bench.h"

namespace capsoc::coprocessor::test {
namespace {

constexpr double sample_hz = 250;
constexpr int turn = 5000;  // samples
constexpr uint32_t lms_step = 1349307;
// Normal equations of a whole turn: 2 / N for sine and cosine, 1 / N for the constant, Q1.31.
constexpr uint32_t block_step = 858993, block_step_constant = 429497;
constexpr uint32_t learning = ctrl_demod | ctrl_calib;

void start(Bench& bench, uint32_t ctrl) {
  const bool block = (ctrl & ctrl_block) != 0;
  bench.start(ctrl, 1.0 / turn, block ? block_step : lms_step);
  if (!block) return;
  bench.write(description::STEP_CU_offset, block_step_constant);
  bench.write(reg_step_cv, block_step_constant);
}

std::array<int64_t, 6> coefficients(const Bench& bench) {
  const Nodes& n = bench.dut.nodes();
  return {n.a_u, n.b_u, n.c_u, n.a_v, n.b_v, n.c_v};
}

// What is added to both channels at an angle: of the amplitude, as offsets.
using Disturbance = std::function<std::array<double, 2>(double angle)>;

std::array<double, 2> none(double) {
  return {0, 0};
}
// The harmonics of part B.2 of the measurements: second and third order, 1 % in sum.
std::array<double, 2> harmonics(double angle) {
  return {0.005 * std::sin(2 * angle) + 0.003 * std::sin(3 * angle),
          0.005 * std::cos(2 * angle) + 0.003 * std::cos(3 * angle)};
}

struct Course {
  double within = 0;      // s, until all six parameters stay within 1 %
  double parameters = 0;  // largest relative deviation in the last turn
};

Course course(uint32_t ctrl, double seconds, const Disturbance& disturbance) {
  const Sensor sensor;
  Bench bench;
  start(bench, ctrl);
  Course out;
  const int samples = static_cast<int>(seconds * sample_hz);
  for (int k = 0; k < samples; ++k) {
    const double shaft = tau * k / turn;
    const auto [u, v] = disturbance(shaft + sensor.phi);
    Sensor disturbed = sensor;
    disturbed.b1 += sensor.a1 * u;
    disturbed.b2 += sensor.a2 * v;
    bench.sample(disturbed, shaft);
    const auto deviation = deviations(bench.parameters(), sensor);
    const double worst = *std::max_element(deviation.begin(), deviation.end());
    if (worst > 0.01) out.within = (k + 1) / sample_hz;
    if (k >= samples - turn) out.parameters = std::max(out.parameters, worst);
  }
  return out;
}

TEST(Block, FindsTheParametersInOneTurn) {
  const Course lms = course(learning, 400, none);
  const Course block = course(learning | ctrl_block, 400, none);
  std::printf("Eq (21): LMS within 1 %% after %.1f s, at 400 s %.2g; block %.1f s, %.2g\n",
              lms.within, lms.parameters, block.within, block.parameters);
  EXPECT_NEAR(lms.within, 95.7, 0.1);
  // One turn, and the sample that it is taken over with.
  EXPECT_GT(block.within, 19.9);
  EXPECT_LT(block.within, 20.1);
  EXPECT_LT(block.parameters, 5e-8);
  EXPECT_LE(block.parameters, lms.parameters);
}

TEST(Block, IsNotBiasedByHarmonics) {
  const Course lms = course(learning, 400, harmonics);
  const Course block = course(learning | ctrl_block, 400, harmonics);
  std::printf("harmonics: parameters off by %.2g (LMS), %.2g (block)\n", lms.parameters,
              block.parameters);
  EXPECT_GT(lms.parameters, 1e-3);
  EXPECT_LT(block.parameters, 1e-7);
}

TEST(Block, ChangesTheCoefficientsOnceATurn) {
  const Sensor sensor;
  Bench bench;
  start(bench, learning | ctrl_block);
  std::vector<int> changes;
  auto before = coefficients(bench);
  for (int k = 0; k < 3 * turn + 10; ++k) {
    bench.sample(sensor, tau * k / turn);
    const auto now = coefficients(bench);
    if (k > 0 && now != before) changes.push_back(k);
    before = now;
  }
  // FREQ is a little less than 2^48 / 5000, so the reference completes a turn with sample 5000. The
  // one after it takes the block over.
  EXPECT_EQ(changes, (std::vector<int>{turn + 1, 2 * turn + 1, 3 * turn + 1}));
}

TEST(Block, BeginsWithAWindow) {
  const Sensor sensor;
  Bench bench;
  start(bench, learning);
  for (int k = 0; k < turn / 3; ++k) bench.sample(sensor, tau * k / turn);
  start(bench, learning | ctrl_block);
  const auto before = coefficients(bench);
  int k = turn / 3;
  for (; k < 2 * turn + 1; ++k) {
    bench.sample(sensor, tau * k / turn);
    ASSERT_EQ(coefficients(bench), before) << "sample " << k;
  }
  bench.sample(sensor, tau * k / turn);
  EXPECT_NE(coefficients(bench), before);
}

// After three turns the shaft stops: in numeric the reference continues without it.
std::array<int64_t, 6> moved_at_rest(uint32_t ctrl, uint32_t time_out) {
  const Sensor sensor;
  Bench bench;
  start(bench, ctrl);
  bench.write(reg_turn_limit, time_out);
  int k = 0;
  for (; k < 3 * turn + 100; ++k) bench.sample(sensor, tau * k / turn);
  const auto before = coefficients(bench);
  for (int i = 0; i < 4 * turn; ++i) bench.sample(sensor, tau * k / turn);
  auto moved = coefficients(bench);
  for (size_t i = 0; i < moved.size(); ++i) moved[i] -= before[i];
  return moved;
}

TEST(Block, GuardKeepsTheWeightsOfAShaftAtRest) {
  constexpr std::array<int64_t, 6> still{};
  EXPECT_EQ(moved_at_rest(learning | ctrl_block | ctrl_guard, 0), still);
  EXPECT_NE(moved_at_rest(learning | ctrl_block, 0), still) << "without the guard they move";
  EXPECT_NE(moved_at_rest(learning, 0), still);
  // With the angle source only the time-out ends a window then, which never counts.
  EXPECT_EQ(moved_at_rest(learning | ctrl_block | 2u << ctrl_ref_shift, 3 * turn / 2), still);
}

TEST(Block, PaperHasNone) {
  Options options;
  options.arithmetic = Arithmetic::paper;
  Bench bench(options);
  bench.write(reg_ctrl, learning | ctrl_block | ctrl_guard);
  EXPECT_EQ(bench.read(reg_ctrl), learning);
  EXPECT_EQ(bench.read(reg_flags), flag_config);
}

TEST(Block, SaturatesItsSumsAsWeights) {
  // Steps of almost 1 and a signal at full scale: the sum passes 2 within a turn.
  Bench bench;
  bench.start(learning | ctrl_block, 1.0 / turn, 0x7FFFFFFF);
  Sensor sensor;
  sensor.a1 = sensor.a2 = 0;
  sensor.b1 = sensor.b2 = 0.99;
  bench.sample(sensor, 0);
  bench.write(reg_flags, flags_all);
  for (int k = 1; k < 4; ++k) bench.sample(sensor, 0);
  EXPECT_NE(bench.read(reg_flags) & flag_sat, 0u);
}

}  // namespace
}  // namespace capsoc::coprocessor::test
