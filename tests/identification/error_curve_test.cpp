// The error table from a recorded angle: read off as docs/reference/coprocessor.md says, on samples
// that it was not learnt from.
#include "identification/error_curve.h"

#include <gtest/gtest.h>

#include "signals.h"

namespace capsoc::identification {
namespace {

const Parameters round_sensor = {0.45, 0.40, 0.06, -0.09, 0.2};
const SignalModel bent = {
    round_sensor, {{{0.006, 0.01}, {0.008, 0}}}, {{{0.002, -0.006}, {-0.01, 0.004}}}};

struct Learnt {
  HarmonicSignal signal;
  ErrorCurve curve;
};

/// At random angles: no motion is assumed.
Learnt learn(const SignalModel& model, Eigen::Index count, double noise, double zero = 0,
             double direction = 1) {
  Learnt learnt;
  learnt.signal = make_harmonic_signal(model, count, Angles::random, noise, 5);
  const Eigen::ArrayXd truth = direction * learnt.signal.theta + zero;
  learnt.curve = error_curve_of(learnt.signal.samples, truth, model.fundamental, {});
  return learnt;
}

/// The coprocessor's rule for the relative angle, 2^-32 turn.
double corrected(const ErrorCurve& curve, double theta) {
  const auto angle = static_cast<uint32_t>(std::llround(theta / two_pi * 0x1p32));
  const uint32_t q = angle >> 9, j = q >> 16, f = q & 0xFFFF;
  const int64_t left = curve.nodes[j], right = curve.nodes[(j + 1) % error_nodes];
  const int64_t correction = (left * (0x10000 - f) + right * f) >> 16;
  return static_cast<double>(angle - static_cast<uint32_t>(correction * 256)) * 0x1p-32 * two_pi;
}

double largest_error(const ErrorCurve& curve, const SignalModel& model, double zero) {
  double largest = 0;
  for (int i = 0; i < 3600; ++i) {
    const double theta = two_pi * i / 3600;
    const Point at = point_at(model, theta);
    const double found = corrected(curve, angle_of(model.fundamental, at.u, at.v));
    largest = std::max(largest, std::abs(wrapped(found - theta + zero)));
  }
  return largest * degrees_per_radian;
}

TEST(ErrorCurve, TheTableTakesHarmonicsOffSamplesThatItDidNotSee) {
  const Learnt learnt = learn(bent, 5000, 1e-5);
  ASSERT_TRUE(learnt.curve.identified) << learnt.curve.reason;
  EXPECT_GT(learnt.curve.before.largest * degrees_per_radian, 0.8);
  EXPECT_LT(learnt.curve.after.rms, learnt.curve.before.rms / 50);
  EXPECT_LT(largest_error(learnt.curve, bent, 0), 0.02);
}

TEST(ErrorCurve, TheReferencesOwnZeroAndDirectionAreTakenOff) {
  for (const double zero : {0.1, 1.0}) {
    const Learnt learnt = learn(bent, 5000, 1e-5, zero, -1);
    ASSERT_TRUE(learnt.curve.identified) << learnt.curve.reason;
    EXPECT_TRUE(learnt.curve.reversed);
    // Near zero it is an error of the angle: the recorded one counts. -truth = theta - zero.
    EXPECT_LT(largest_error(learnt.curve, bent, zero < own_zero ? zero : 0), 0.05) << zero;
  }
}

TEST(ErrorCurve, HeldOutErrorIsThatOfNewSamples) {
  constexpr double noise = 2e-3;
  const Learnt learnt = learn(bent, 2000, noise);
  ASSERT_TRUE(learnt.curve.identified) << learnt.curve.reason;
  const HarmonicSignal fresh = make_harmonic_signal(bent, 20000, Angles::random, noise, 99);
  double square = 0;
  for (Eigen::Index i = 0; i < fresh.theta.size(); ++i) {
    const double theta = angle_of(round_sensor, fresh.samples.u[i], fresh.samples.v[i]);
    const double rest = wrapped(theta - fresh.theta[i] - error_at(learnt.curve, theta));
    square += rest * rest;
  }
  const double rms = std::sqrt(square / static_cast<double>(fresh.theta.size()));
  EXPECT_NEAR(learnt.curve.after.rms / rms, 1, 0.05);
}

TEST(ErrorCurve, NoiseAloneGivesNoTable) {
  int identified = 0;
  for (uint64_t seed = 1; seed <= 100; ++seed) {
    const HarmonicSignal signal =
        make_harmonic_signal({round_sensor, {}, {}}, 1000, Angles::random, 1e-3, seed);
    const ErrorCurve curve = error_curve_of(signal.samples, signal.theta, round_sensor, {});
    identified += curve.identified ? 1 : 0;
  }
  EXPECT_LE(identified, 10);
}

TEST(ErrorCurve, TooFewSamplesAndGapsAreNamed) {
  const Learnt few = learn(bent, 150, 1e-5);
  EXPECT_FALSE(few.curve.identified);
  EXPECT_NE(few.curve.reason.find("150 samples are too few"), std::string::npos);
  HarmonicSignal arc = make_harmonic_signal(bent, 4000, Angles::even_shuffled, 0, 1);
  std::vector<Eigen::Index> left_out;
  for (Eigen::Index i = 0; i < arc.theta.size(); ++i)
    if (std::abs(wrapped(arc.theta[i] - 1)) < 0.3) left_out.push_back(i);
  const ErrorCurve curve = error_curve_of(arc.samples, arc.theta, round_sensor, left_out);
  EXPECT_FALSE(curve.identified);
  EXPECT_NE(curve.reason.find("without a true angle"), std::string::npos) << curve.reason;
}

TEST(ErrorCurve, AnErrorBeyondTheTableIsNamed) {
  SignalModel wild = bent;
  wild.u[0] = {0.3, 0.2};
  const Learnt learnt = learn(wild, 5000, 0);
  EXPECT_FALSE(learnt.curve.identified);
  EXPECT_NE(learnt.curve.reason.find("larger than the table can take"), std::string::npos)
      << learnt.curve.reason;
}

}  // namespace
}  // namespace capsoc::identification
