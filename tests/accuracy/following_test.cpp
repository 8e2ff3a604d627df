#include "accuracy/following.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/constants.h"

namespace capsoc::accuracy {
namespace {

FollowingRun on(std::vector<sensor::SpeedPoint> speeds, double duration_s) {
  FollowingRun run;
  run.signal.sample_rate_hz = 5000;
  run.signal.motion.kind = sensor::MotionKind::profile;
  run.signal.motion.speeds = std::move(speeds);
  run.duration_s = duration_s;
  return run;
}

FollowingRun drifting(FollowingRun run, double rate) {
  sensor::DriftConfig& drift = run.signal.drift;
  drift.a1 = drift.b1 = drift.beta = rate;
  drift.a2 = drift.b2 = -rate;
  drift.until_s = 100.0;
  return run;
}

const std::vector<sensor::SpeedPoint> with_a_rest = {
    {0, 1}, {12, 1}, {12.5, 0}, {22.5, 0}, {23, 1}};

TEST(Following, WithoutDriftNothingIsLeftAndNothingIsFrozen) {
  const FollowingOutcome outcome = follow(on({{0, 1}}, 30));
  EXPECT_TRUE(outcome.locked);
  EXPECT_NEAR(outcome.locked_s, 7, 0.2);  // a turn for its range, six to learn
  EXPECT_LT(outcome.end_error_deg, 1e-6);
  EXPECT_EQ(outcome.frozen_part, 0.0);
  EXPECT_NEAR(outcome.turns, 23, 1);
  EXPECT_NEAR(outcome.longest_blind_s, 1, 1e-3);
}

TEST(Following, ARestLeavesWhatWasLearntAsItIs) {
  const FollowingOutcome outcome = follow(on(with_a_rest, 40));
  EXPECT_LT(outcome.error_deg, 2e-4);
  EXPECT_LT(outcome.end_error_deg, 1e-6);
  // The 10 s, and the ends of the ramps, of 33 s after the lock.
  EXPECT_NEAR(outcome.frozen_part, 10.0 / 33, 0.02);
}

// At rest an angle is off by what the parameters have moved since they were learnt.
TEST(Following, AtRestTheErrorGrowsAsTheParametersMove) {
  FollowingRun run = drifting(on({{0, 10}, {5, 10}, {5.5, 0}}, 26), 1e-3);
  const FollowingOutcome outcome = follow(run);
  const double turns = 0.0876 / two_pi + 50 + 2.5;
  const double theta = two_pi * (turns - std::floor(turns));
  const auto angle = [&](double moved) {  // of the sample, with the parameters of 5.2 s
    const double age = 5.2e-3;
    const double beta = 0.0629 + age;
    const double u = 0.6079 * ((1 + moved) * std::sin(theta) + moved);
    const double v = 0.6228 * ((1 - moved) * std::cos(theta + 0.0629 + moved) - moved);
    const double x = (u - 0.6079 * age) / (0.6079 * (1 + age));
    const double y = (v + 0.6228 * age) / (0.6228 * (1 - age));
    return std::atan2(x, (y + x * std::sin(beta)) / std::cos(beta));
  };
  const double expected = std::abs(std::remainder(angle(26e-3) - theta, two_pi));
  EXPECT_GT(expected / radians_per_degree, 1);
  EXPECT_NEAR(outcome.end_error_deg, expected / radians_per_degree, 0.03);
}

// What the table's bounds rest on: twice the drift is twice the error, so they can be missed.
TEST(Following, TheErrorIsInProportionToTheDrift) {
  const double one = follow(drifting(on(with_a_rest, 40), 1e-3)).error_deg;
  const double two = follow(drifting(on(with_a_rest, 40), 2e-3)).error_deg;
  EXPECT_NEAR(two / one, 2, 0.1);
  // 12 s without a learnt turn and what they lag behind: 3.12 times 14 s of drift at most.
  EXPECT_LT(one, 3.12 * 14e-3 / radians_per_degree);
  EXPECT_GT(two, 3.12 * 14e-3 / radians_per_degree);
}

TEST(Following, AShaftThatNeverTurnsIsNeverLearnt) {
  const FollowingOutcome outcome = follow(on({{0, 0}}, 2));
  EXPECT_FALSE(outcome.locked);
  EXPECT_EQ(outcome.turns, 0u);
}

}  // namespace
}  // namespace capsoc::accuracy
