// What firmware/apps/follow decides by, compiled for the host, on angles that are given.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

extern "C" {
#include "apps/follow/follower.c"
}

namespace {

constexpr uint32_t longest = 100000;

uint32_t word(double turns) {
  return static_cast<uint32_t>(static_cast<int64_t>(std::floor(turns * 0x1p32)));
}

/// A follower and the shaft that it sees.
struct Bench {
  follower state{};
  double turns = 0;

  explicit Bench(uint32_t turn) {
    state.longest = longest;
    follower_begin(&state, turn, 0);
  }

  /// The tasks of `samples` samples at a speed in turns a sample, without follower_nothing.
  std::vector<follower_task> run(double speed, int samples) {
    std::vector<follower_task> tasks;
    for (int i = 0; i < samples; ++i) {
      turns += speed;
      const follower_task task = follower_feed(&state, word(turns));
      if (task != follower_nothing) tasks.push_back(task);
    }
    return tasks;
  }
};

using Tasks = std::vector<follower_task>;

TEST(Follower, StepsAreThoseOfTheNormalEquationsTimesWhatTheAngleHides) {
  for (const uint32_t n : {22u, 50u, 5000u, 1000000u}) {
    EXPECT_NEAR(follower_step_of_offsets(n) * 0x1p-31, 2.0 / n, 0x1p-31);
    EXPECT_NEAR(follower_step_of_amplitudes(n) * 0x1p-31, 4.0 / 3 * 2 / n, 0x1p-31);
    EXPECT_LT(follower_step_of_amplitudes(n), 1u << 31);
  }
  EXPECT_EQ(follower_watchdog(1000), 1501u);
}

TEST(Follower, ASteadyShaftIsLeftToLearn) {
  for (const double speed : {0.001, -0.001, 0.003, -0.02}) {
    Bench bench(1000);
    EXPECT_EQ(bench.run(speed, 5000), Tasks());
    EXPECT_FALSE(bench.state.resting);
  }
}

TEST(Follower, AShaftThatStopsFreezesAfterHalfATurnsTimeAndOnce) {
  Bench bench(1000);
  EXPECT_EQ(bench.run(0.001, 1000), Tasks());
  EXPECT_EQ(bench.run(0, 376), Tasks());  // up to 125 of them are of the part that moved
  EXPECT_EQ(bench.run(0, 200), Tasks{follower_freeze});
  EXPECT_TRUE(bench.state.resting);
  EXPECT_EQ(bench.run(0, 3 * longest), Tasks());
}

TEST(Follower, AQuarterOfTheSpeedIsRestAndABitMoreIsNot) {
  EXPECT_EQ(Bench(1000).run(0.001 / 4.1, 3000).at(0), follower_freeze);
  EXPECT_EQ(Bench(1000).run(0.001 / 3.9, 3000), Tasks());
}

TEST(Follower, AfterRestItLearnsAgainWithTheSpeedThatItSees) {
  for (const double speed : {0.0004, -0.0025, 0.02}) {
    Bench bench(1000);
    bench.run(0, 30000);
    ASSERT_TRUE(bench.state.resting);
    const Tasks tasks = bench.run(speed, static_cast<int>(0.2 / std::abs(speed)));
    EXPECT_EQ(tasks, (Tasks{follower_restart, follower_adjust}));
    EXPECT_FALSE(bench.state.resting);
    // Half of an eighth of a turn is a few samples: to one of them.
    EXPECT_NEAR(bench.state.turn * std::abs(speed), 1, 16 * std::abs(speed));
  }
}

TEST(Follower, WhatOnlyTremblesIsAtRest) {
  Bench bench(1000);
  bench.run(0, 1000);
  for (int i = 0; i < 1000; ++i) {
    EXPECT_EQ(bench.run(0.002, 25), Tasks());
    EXPECT_EQ(bench.run(-0.002, 25), Tasks());
  }
  EXPECT_TRUE(bench.state.resting);
}

TEST(Follower, ATurnOfOtherLengthGivesOtherSteps) {
  Bench bench(1000);
  bench.run(0.002, 500);
  EXPECT_EQ(follower_turn_ended(&bench.state, 500, false), follower_adjust);
  EXPECT_EQ(bench.state.turn, 500u);
  // It slows down: the last eighth at 0.001 a sample counts, not the turn before it.
  bench.run(0.001, 260);
  EXPECT_EQ(follower_turn_ended(&bench.state, 510, false), follower_adjust);
  EXPECT_NEAR(bench.state.turn, 1000, 1);
}

TEST(Follower, AWindowThatTimedOutSaysNothingOfTheTurn) {
  Bench bench(1000);
  bench.run(0.001, 1000);
  EXPECT_EQ(follower_turn_ended(&bench.state, 1501, true), follower_adjust);
  EXPECT_NEAR(bench.state.turn, 1000, 1);
}

TEST(Follower, AtRestATurnChangesNothing) {
  Bench bench(1000);
  bench.run(0, 1000);
  ASSERT_TRUE(bench.state.resting);
  EXPECT_EQ(follower_turn_ended(&bench.state, 1501, true), follower_nothing);
  EXPECT_EQ(bench.state.turn, 1000u);
}

TEST(Follower, TheTurnStaysWithinWhatCanBeJudgedAndWhatIsAskedFor) {
  Bench bench(5);
  EXPECT_EQ(bench.state.turn, 22u);
  follower_turn_ended(&bench.state, 4000000, false);
  EXPECT_EQ(bench.state.turn, longest);
  // From rest to half a part in one sample.
  Bench jump(1000);
  jump.run(0, 1000);
  EXPECT_EQ(jump.run(0.2, 2).at(0), follower_restart);
  EXPECT_EQ(jump.state.turn, 22u);
}

}  // namespace
