#include "identification/harmonics.h"

#include <gtest/gtest.h>

#include "base/constants.h"
#include "identification/ellipse_fit.h"
#include "signals.h"

namespace capsoc::identification {
namespace {

constexpr uint64_t harmonics_seed = 5;

/// The paper's: U + 0.01 a1 sin(3 theta), V + 0.01 a2 cos(3 theta).
SignalModel papers() {
  SignalModel model;
  model.fundamental = table_1;
  model.u[1].sine = 0.01;
  model.v[1].cosine = 0.01;
  return model;
}

SignalModel general() {
  SignalModel model;
  model.fundamental = table_1;
  model.u = {HarmonicTerm{0.003, -0.002}, HarmonicTerm{0.01, 0.004}};
  model.v = {HarmonicTerm{-0.004, 0.001}, HarmonicTerm{-0.006, 0.01}};
  return model;
}

struct Outcome {
  Harmonics harmonics;
  double before, ellipse, after;  // degrees peak to peak, on the samples without noise
};

Outcome outcome_of(const HarmonicSignal& signal, Assumption assumption = Assumption::automatic,
                   int highest = 3) {
  const Samples& s = signal.samples;
  const auto start = fit_taubin(s.u, s.v);
  EXPECT_TRUE(start) << start.error();
  const auto harmonics = identify_harmonics(s.u, s.v, start.value(), {highest, assumption});
  EXPECT_TRUE(harmonics) << harmonics.error();
  Eigen::ArrayXd raw(s.u.size());
  for (Eigen::Index i = 0; i < raw.size(); ++i) {
    raw[i] = uncalibrated_angle(signal.clean_u[i], signal.clean_v[i]);
  }
  Outcome outcome;
  outcome.harmonics = harmonics.value();
  outcome.before = peak_to_peak_error(raw, signal.theta) / radians_per_degree;
  outcome.ellipse =
      peak_to_peak_error(start.value(), signal.clean_u, signal.clean_v, signal.theta) /
      radians_per_degree;
  outcome.after =
      peak_to_peak_error(outcome.harmonics.model, signal.clean_u, signal.clean_v, signal.theta) /
      radians_per_degree;
  std::printf(
      "before %.2f, ellipse %.3f, with harmonics %.2e (expected %.1e) deg peak to peak, %s\n"
      "  %s\n",
      outcome.before, outcome.ellipse, outcome.after,
      outcome.harmonics.expected_error / radians_per_degree, to_string(outcome.harmonics.used),
      outcome.harmonics.reason.c_str());
  return outcome;
}

TEST(Harmonics, OfAnEvenlyCoveredTurnAreIdentifiedWithinTheBounds) {
  const std::pair<double, double> bounds[] = {{0, 0.01}, {1e-4, 0.01}, {1e-3, 0.1}};
  for (const SignalModel& model : {papers(), general()}) {
    for (const auto& [noise, bound] : bounds) {
      const auto outcome = outcome_of(
          make_harmonic_signal(model, 10000, Angles::even_shuffled, noise, harmonics_seed));
      EXPECT_EQ(outcome.harmonics.used, Assumption::even_coverage);
      EXPECT_LT(outcome.after, bound) << noise;
      EXPECT_LT(outcome.after, 4 * outcome.harmonics.expected_error / radians_per_degree + 1e-11);
    }
  }
}

TEST(Harmonics, OfThePaperAreItsSineAndCosineOfThreeTheta) {
  const auto outcome =
      outcome_of(make_harmonic_signal(papers(), 10000, Angles::even_shuffled, 0, harmonics_seed));
  EXPECT_NEAR(outcome.before, 74.17, 0.01);  // the paper's figure
  EXPECT_NEAR(outcome.ellipse, 3.64, 0.1);   // the paper: 3.77
  EXPECT_LT(outcome.after, 1e-9);
  const SignalModel& found = outcome.harmonics.model;
  EXPECT_LT(difference(found.fundamental, table_1), 1e-12);
  EXPECT_NEAR(found.u[1].sine, 0.01, 1e-12);
  EXPECT_NEAR(found.u[1].cosine, 0, 1e-12);
  EXPECT_NEAR(found.v[1].cosine, 0.01, 1e-12);
  EXPECT_NEAR(found.u[0].sine, 0, 1e-12);
}

TEST(Harmonics, AtConstantSpeedAreIdentifiedOverPartsOfTurnsToo) {
  const std::pair<double, double> bounds[] = {{0, 1e-9}, {1e-4, 0.01}, {1e-3, 0.1}};
  for (const auto& [noise, bound] : bounds) {
    const auto outcome = outcome_of(
        make_harmonic_signal(general(), 10000, Angles::constant_speed, noise, harmonics_seed));
    EXPECT_EQ(outcome.harmonics.used, Assumption::constant_speed);
    EXPECT_LT(outcome.after, bound) << noise;
  }
}

TEST(Harmonics, OfRandomAnglesComeWithTheirStatisticalBound) {
  for (const double noise : {0.0, 1e-5, 1e-4, 1e-3}) {
    const auto outcome =
        outcome_of(make_harmonic_signal(papers(), 4000, Angles::random, noise, harmonics_seed));
    EXPECT_TRUE(outcome.harmonics.identified);
    EXPECT_LT(outcome.after, 4 * outcome.harmonics.expected_error / radians_per_degree + 1e-11)
        << noise;
    EXPECT_GE(outcome.harmonics.expected_error, outcome.harmonics.coverage_error);
  }
}

TEST(Harmonics, OfThreeQuartersOfATurnFallBackOnTheEllipseUnlessTheyAreClean) {
  for (const double noise : {0.0, 1e-4}) {
    HarmonicSignal signal =
        make_harmonic_signal(papers(), 4000, Angles::even_shuffled, noise, harmonics_seed);
    Eigen::Index kept = 0;
    for (Eigen::Index i = 0; i < 4000; ++i) {
      if (signal.theta[i] > 1.5 * pi) continue;
      signal.samples.u[kept] = signal.samples.u[i];
      signal.samples.v[kept] = signal.samples.v[i];
      ++kept;
    }
    signal.samples.u.conservativeResize(kept);
    signal.samples.v.conservativeResize(kept);
    const auto start = fit_taubin(signal.samples.u, signal.samples.v);
    const auto found = identify_harmonics(signal.samples.u, signal.samples.v, start.value(), {3});
    std::printf("%s\n", found.value().reason.c_str());
    EXPECT_NE(found.value().reason.find("do not cover the turn evenly"), std::string::npos);
    EXPECT_EQ(found.value().used, noise == 0 ? Assumption::shape : Assumption::none);
    if (noise > 0) {
      EXPECT_FALSE(found.value().identified);
      EXPECT_EQ(difference(found.value().model.fundamental, start.value()), 0);
    }
  }
}

TEST(Harmonics, AreRefusedWhenTheMotionItselfIsUneven) {
  // theta -> theta + 0.01 sin(theta) once a turn passes for a second harmonic in everything but the
  // curve, whose 50 urad give it away at a noise of 1e-4.
  for (const double noise : {0.0, 1e-4}) {
    HarmonicSignal even =
        make_harmonic_signal(papers(), 10000, Angles::even_shuffled, 0, harmonics_seed);
    Random random(8);
    for (Eigen::Index i = 0; i < 10000; ++i) {
      const double theta = even.theta[i] + 0.01 * std::sin(even.theta[i]);
      const Point at = point_at(papers(), theta);
      even.theta[i] = theta;
      even.clean_u[i] = at.u;
      even.clean_v[i] = at.v;
      even.samples.u[i] = at.u + noise * std::sqrt(12.0) * (random.uniform() - 0.5);
      even.samples.v[i] = at.v + noise * std::sqrt(12.0) * (random.uniform() - 0.5);
    }
    const auto outcome = outcome_of(even);
    EXPECT_NE(outcome.harmonics.reason.find("contradicts"), std::string::npos);
    EXPECT_EQ(outcome.harmonics.used, noise == 0 ? Assumption::shape : Assumption::none);
    if (noise == 0) {
      EXPECT_LT(outcome.after, 1e-9);
    }
  }
}

TEST(Harmonics, AtASpeedThatWandersAreNotTakenForConstantSpeed) {
  HarmonicSignal signal =
      make_harmonic_signal(papers(), 4000, Angles::constant_speed, 0, harmonics_seed);
  Random random(8);
  for (Eigen::Index i = 0; i < 4000; ++i) {
    const double theta = signal.theta[i] + 0.05 * std::sin(0.31 * signal.theta[i]);
    const Point at = point_at(papers(), theta);
    signal.samples.u[i] = at.u + 1e-4 * (random.uniform() - 0.5);
    signal.samples.v[i] = at.v + 1e-4 * (random.uniform() - 0.5);
  }
  const auto start = fit_taubin(signal.samples.u, signal.samples.v);
  const auto found = identify_harmonics(signal.samples.u, signal.samples.v, start.value(),
                                        {3, Assumption::constant_speed});
  std::printf("%s\n", found.value().reason.c_str());
  EXPECT_FALSE(found.value().identified);
  EXPECT_NE(found.value().reason.find("the speed is not constant"), std::string::npos);
}

TEST(Harmonics, OfSymmetricChannelsNeedNoMotionAtAll) {
  SignalModel model;
  model.fundamental = table_1;
  model.u = {HarmonicTerm{0.003, -0.002}, HarmonicTerm{0.01, 0.004}};
  for (int k = 0; k < 2; ++k) {
    const double shift = (k + 2) * (pi / 2 + table_1.beta);
    const auto [sine, cosine] = model.u[k];
    model.v[k] = {sine * std::cos(shift) - cosine * std::sin(shift),
                  sine * std::sin(shift) + cosine * std::cos(shift)};
  }
  const std::pair<double, double> bounds[] = {{0, 1e-9}, {1e-4, 0.02}, {1e-3, 0.2}};
  for (const auto& [noise, bound] : bounds) {
    const auto outcome =
        outcome_of(make_harmonic_signal(model, 4000, Angles::random, noise, harmonics_seed),
                   Assumption::symmetric);
    EXPECT_TRUE(outcome.harmonics.identified);
    EXPECT_LT(outcome.after, bound);
  }
  // Channels that are not alike are refused.
  const auto refused =
      outcome_of(make_harmonic_signal(papers(), 4000, Angles::random, 1e-4, harmonics_seed),
                 Assumption::symmetric);
  EXPECT_FALSE(refused.harmonics.identified);
}

TEST(Harmonics, OfTheSecondOrderAloneLeaveTheThirdOut) {
  SignalModel model;
  model.fundamental = table_1;
  model.u[0] = {0.01, 0.002};
  model.v[0] = {-0.003, 0.008};
  const auto outcome =
      outcome_of(make_harmonic_signal(model, 4000, Angles::even_shuffled, 0, harmonics_seed),
                 Assumption::automatic, 2);
  EXPECT_LT(outcome.after, 1e-9);
  EXPECT_EQ(outcome.harmonics.model.u[1].sine, 0);
}

TEST(Harmonics, ThatWereNotAskedForOrAreOutOfRange) {
  const TestSignal signal = make_signal(table_1, 100, 1);
  EXPECT_FALSE(identify_harmonics(signal.u, signal.v, table_1, {4}));
  EXPECT_FALSE(identify_harmonics(signal.u, signal.v, table_1, {-1}));
  const auto none = identify_harmonics(signal.u, signal.v, table_1, {1});
  EXPECT_FALSE(none.value().identified);
  EXPECT_EQ(difference(none.value().model.fundamental, table_1), 0);
}

}  // namespace
}  // namespace capsoc::identification
