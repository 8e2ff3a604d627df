#include "metrics/metrics.h"

#include <gtest/gtest.h>

#include <cmath>

namespace capsoc::run {
namespace {

const metrics::Parameters truth{0.6, 0.6, 0.1, 0.1, 0.05, 0.1};

int32_t q31(double value) {
  return static_cast<int32_t>(std::lround(value * 2147483648.0));
}
uint32_t turn(double radians) {
  return static_cast<uint32_t>(
      static_cast<int64_t>(std::llround(radians / (2 * std::acos(-1.0)) * 4294967296.0)));
}
metrics::ParameterWords words_of(const metrics::Parameters& p) {
  return {q31(p.a1), q31(p.a2), q31(p.b1), q31(p.b2), turn(p.beta), turn(p.phi)};
}

constexpr double rate_hz = 250;

metrics::SensorTruth sample(uint64_t index, double turns) {
  return {static_cast<double>(index) / rate_hz, 0.3, 0.4, turns, true};
}

metrics::CoprocessorResult answer(double turns, const metrics::Parameters& p,
                                  bool demodulating = true) {
  return {static_cast<uint32_t>(static_cast<int64_t>(std::llround(turns * 4294967296.0))), true,
          demodulating, true, words_of(p)};
}

TEST(Metrics, WordsBecomeFullScaleAndRadians) {
  const metrics::Parameters p =
      metrics::to_values({1 << 30, -(1 << 30), 0, 1 << 29, 0xC0000000u, 0x40000000u});
  EXPECT_DOUBLE_EQ(p.a1, 0.5);
  EXPECT_DOUBLE_EQ(p.a2, -0.5);
  EXPECT_DOUBLE_EQ(p.b2, 0.25);
  EXPECT_NEAR(p.beta, -std::acos(-1.0) / 2, 1e-15);
  EXPECT_NEAR(p.phi, std::acos(-1.0) / 2, 1e-15);
}

TEST(Metrics, ConvergenceCountsFromTheLastEntryIntoTheBand) {
  metrics::Metrics metrics(truth, 10 / rate_hz);
  metrics::Parameters outside = truth;
  outside.a1 *= 1.011;
  for (uint64_t k = 0; k < 40; ++k) {
    metrics.accepted(sample(k, 0.0));
    metrics.result(answer(0.0, k < 10 || k == 20 ? outside : truth));
  }
  ASSERT_EQ(metrics.convergence().state, metrics::Convergence::State::reached);
  EXPECT_DOUBLE_EQ(metrics.convergence().since_s, 21 / rate_hz);
  metrics.accepted(sample(40, 0.0));
  metrics.result(answer(0.0, outside));
  EXPECT_EQ(metrics.convergence().state, metrics::Convergence::State::not_reached);
}

TEST(Metrics, OnlyTheLastRevolutionOfDemodulationCounts) {
  metrics::Metrics metrics(truth, 5 / rate_hz);
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
  metrics::Metrics metrics(truth, 5 / rate_hz);
  metrics.accepted({0, std::sin(0.5), std::cos(0.5), 0.0, true});
  metrics.result(answer(0.0, truth));
  EXPECT_NEAR(*metrics.angle_errors().uncalibrated_max, 0.5 * 180 / std::acos(-1.0), 1e-9);
  EXPECT_NEAR(*metrics.angle_errors().uncalibrated_max_paper,
              (0.5 + truth.phi) * 180 / std::acos(-1.0), 1e-9);
}

TEST(Metrics, CalibrationModeFromTheStartHasItsErrorsAndKeepsThePresetWords) {
  metrics::Metrics metrics(truth, 5 / rate_hz);
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

TEST(Metrics, CalibrationModeCountsFromWhenItsHarmonicsWereCorrected) {
  metrics::Metrics metrics(truth, 5 / rate_hz);
  for (uint64_t k = 0; k < 40; ++k) {
    metrics.accepted(sample(k, 0.25));
    // Five samples may have been on their way when CORRECT was written.
    metrics::CoprocessorResult result = answer(k < 25 ? 0.5 : 0.25 + 1.0 / 360, truth, k < 10);
    result.correcting = k >= 20;
    metrics.result(result);
    const auto worst = metrics.angle_errors().calibration_mode_max;
    if (k == 19) {
      EXPECT_NEAR(worst.value_or(0), 90, 1e-6);
    }
    if (k == 24) {
      EXPECT_FALSE(worst.has_value());
    }
  }
  EXPECT_NEAR(*metrics.angle_errors().calibration_mode_max, 1, 1e-6);
}

TEST(Metrics, WithoutATruthThereIsNoError) {
  metrics::Metrics metrics(std::nullopt, 5 / rate_hz);
  metrics.accepted({0, 0.1, 0.2, 0.0, false});
  metrics.result(answer(0.0, truth));
  EXPECT_EQ(metrics.samples(), 1u);
  EXPECT_FALSE(metrics.angle_errors().uncalibrated_max);
  EXPECT_FALSE(metrics.angle_errors().angle_known);
  EXPECT_EQ(metrics.convergence().state, metrics::Convergence::State::not_known);
}

TEST(Metrics, AnAngleThatIsKnownIsEnoughForTheAngleErrors) {
  metrics::Metrics metrics(std::nullopt, 5 / rate_hz);
  metrics.accepted({0, std::sin(0.5), std::cos(0.5), 0.0, true});
  metrics.result(answer(0.25, truth));
  EXPECT_TRUE(metrics.angle_errors().angle_known);
  EXPECT_NEAR(*metrics.angle_errors().uncalibrated_max, 0.5 * 180 / std::acos(-1.0), 1e-9);
  EXPECT_FALSE(metrics.angle_errors().uncalibrated_max_paper) << "that takes phi";
  EXPECT_NEAR(*metrics.angle_errors().calibrated_max_last_revolution, 90, 1e-6);
  EXPECT_EQ(metrics.convergence().state, metrics::Convergence::State::not_known);
}

TEST(Metrics, TheLastRevolutionIsOneOfTheSensorsTimeWhateverTheRate) {
  for (const double rate : {100.0, 250.0, 1000.0}) {
    metrics::Metrics metrics(truth, 0.5);
    const auto turn_samples = static_cast<uint64_t>(rate / 2);
    for (uint64_t k = 0; k < 3 * turn_samples; ++k) {
      // The sample before the last turn is 2 degrees off, those of the last turn 1 degree.
      const double degrees = k == 2 * turn_samples - 1 ? 2 : 1;
      metrics.accepted({static_cast<double>(k) / rate, 0.3, 0.4, 0.25, true});
      metrics.result(answer(0.25 + degrees / 360, truth));
      const metrics::AngleErrors errors = metrics.angle_errors();
      const double expected = k + 1 < 2 * turn_samples || k + 1 == 3 * turn_samples ? 1 : 2;
      ASSERT_NEAR(*errors.calibrated_max_last_revolution, expected, 1e-6) << rate << " " << k;
    }
    EXPECT_NEAR(*metrics.angle_errors().calibrated_max_last_revolution, 1, 1e-6) << rate;
  }
}

TEST(Metrics, PhiIsComparedOnlyWithANumericReferenceFromTheSensorsStartOn) {
  const auto after = [](uint64_t first, bool numeric) {
    metrics::Metrics metrics(truth, 1);
    for (uint64_t k = first; k < first + 5; ++k) {
      metrics.accepted(sample(k, 0.0));
      metrics::CoprocessorResult result = answer(0.0, truth);
      result.numeric_reference = numeric || k < first + 4;
      metrics.result(result);
    }
    EXPECT_EQ(metrics.phi_comparable(),
              metrics.convergence().state == metrics::Convergence::State::reached);
    return metrics.phi_comparable();
  };
  EXPECT_TRUE(after(0, true));
  EXPECT_FALSE(after(0, false));
  EXPECT_FALSE(after(1, true));
  EXPECT_FALSE(metrics::Metrics(truth, 1).phi_comparable()) << "before any demodulation";
}

TEST(Metrics, ASampleThatSoftwareFedIsLeftOut) {
  metrics::Metrics metrics(truth, 5 / rate_hz);
  metrics.result(answer(0.0, truth));
  EXPECT_EQ(metrics.samples(), 0u);
}

}  // namespace
}  // namespace capsoc::run
