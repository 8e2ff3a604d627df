#include "run/metrics.h"

#include <gtest/gtest.h>

#include <cmath>

namespace capsoc::run {
namespace {

const Parameters truth{0.6, 0.6, 0.1, 0.1, 0.05, 0.1};

int32_t q31(double value) {
  return static_cast<int32_t>(std::lround(value * 2147483648.0));
}
uint32_t turn(double radians) {
  return static_cast<uint32_t>(
      static_cast<int64_t>(std::llround(radians / (2 * std::acos(-1.0)) * 4294967296.0)));
}
ParameterWords words_of(const Parameters& p) {
  return {q31(p.a1), q31(p.a2), q31(p.b1), q31(p.b2), turn(p.beta), turn(p.phi)};
}

SensorTruth sample(uint64_t index, double turns) {
  return {index, 0.3, 0.4, turns, true};
}

CoprocessorResult answer(double turns, const Parameters& p, bool demodulating = true) {
  return {static_cast<uint32_t>(static_cast<int64_t>(std::llround(turns * 4294967296.0))), true,
          demodulating, words_of(p)};
}

TEST(Metrics, WordsBecomeFullScaleAndRadians) {
  const Parameters p = to_values({1 << 30, -(1 << 30), 0, 1 << 29, 0xC0000000u, 0x40000000u});
  EXPECT_DOUBLE_EQ(p.a1, 0.5);
  EXPECT_DOUBLE_EQ(p.a2, -0.5);
  EXPECT_DOUBLE_EQ(p.b2, 0.25);
  EXPECT_NEAR(p.beta, -std::acos(-1.0) / 2, 1e-15);
  EXPECT_NEAR(p.phi, std::acos(-1.0) / 2, 1e-15);
}

TEST(Metrics, ConvergenceCountsFromTheLastEntryIntoTheBand) {
  Metrics metrics(truth, 250, 10);
  Parameters outside = truth;
  outside.a1 *= 1.011;
  for (uint64_t k = 0; k < 40; ++k) {
    metrics.accepted(sample(k, 0.0));
    metrics.result(answer(0.0, k < 10 || k == 20 ? outside : truth));
  }
  ASSERT_TRUE(metrics.convergence_s());
  EXPECT_DOUBLE_EQ(*metrics.convergence_s(), 21 / 250.0);
}

TEST(Metrics, OnlyTheLastRevolutionOfDemodulationCounts) {
  Metrics metrics(truth, 250, 5);
  for (uint64_t k = 0; k < 20; ++k) {
    metrics.accepted(sample(k, 0.25));
    metrics.result(answer(k < 15 ? 0.5 : 0.25 + 1.0 / 360, truth));
  }
  metrics.accepted(sample(20, 0.999));
  metrics.result(answer(0.001, truth, false));
  EXPECT_NEAR(*metrics.angle_errors().calibrated_max_last_revolution, 1.0, 1e-6);
  EXPECT_NEAR(*metrics.angle_errors().calibration_mode_max, 0.72, 1e-6);
}

TEST(Metrics, TheUncalibratedErrorIsTakenAgainstTheAngleAndAgainstTheReference) {
  Metrics metrics(truth, 250, 5);
  metrics.accepted({0, std::sin(0.5), std::cos(0.5), 0.0, true});
  metrics.result(answer(0.0, truth));
  EXPECT_NEAR(*metrics.angle_errors().uncalibrated_max, 0.5 * 180 / std::acos(-1.0), 1e-9);
  EXPECT_NEAR(*metrics.angle_errors().uncalibrated_max_paper,
              (0.5 + truth.phi) * 180 / std::acos(-1.0), 1e-9);
}

TEST(Metrics, CalibrationModeFromTheStartHasItsErrorsAndKeepsThePresetWords) {
  Metrics metrics(truth, 250, 5);
  metrics.preset(words_of(truth));
  metrics.accepted({0, std::sin(0.5), std::cos(0.5), 0.0, true});
  metrics.result(answer(0.25, truth, false));
  EXPECT_EQ(metrics.words().a1, words_of(truth).a1);
  EXPECT_NEAR(*metrics.angle_errors().uncalibrated_max, 0.5 * 180 / std::acos(-1.0), 1e-9);
  EXPECT_NEAR(*metrics.angle_errors().calibration_mode_max, 90, 1e-6);
  metrics.accepted({1, 0.3, 0.4, 0.0, true});
  metrics.result(answer(0.0, truth));
  metrics.accepted({2, std::sin(3.0), std::cos(3.0), 0.0, true});
  metrics.result(answer(0.0, truth, false));
  EXPECT_LT(*metrics.angle_errors().uncalibrated_max, 90) << "after demodulation it stays";
}

TEST(Metrics, WithoutATruthThereIsNoError) {
  Metrics metrics(std::nullopt, 250, 5);
  metrics.accepted({0, 0.1, 0.2, 0.0, false});
  metrics.result(answer(0.0, truth));
  EXPECT_EQ(metrics.samples(), 1u);
  EXPECT_FALSE(metrics.angle_errors().uncalibrated_max);
  EXPECT_FALSE(metrics.convergence_s());
}

TEST(Metrics, ASampleThatSoftwareFedIsLeftOut) {
  Metrics metrics(truth, 250, 5);
  metrics.result(answer(0.0, truth));
  EXPECT_EQ(metrics.samples(), 0u);
}

}  // namespace
}  // namespace capsoc::run
