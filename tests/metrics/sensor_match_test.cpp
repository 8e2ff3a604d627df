#include "metrics/sensor_match.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sensor/described_source.h"
#include "sensor/recorded_source.h"

namespace capsoc::run {
namespace {

using Reference = metrics::SamplingState::Reference;
using sensor::MotionKind;

constexpr double clock_hz = 25e6;

/// The default program's: 250 samples a second, a numeric reference of 0.05 Hz.
metrics::SamplingState program(double rate_hz = 250, double speed_hz = 0.05,
                               Reference reference = Reference::numeric) {
  metrics::SamplingState state;
  state.demodulating = true;
  state.reference = reference;
  state.period_cycles = static_cast<uint32_t>(clock_hz / rate_hz);
  state.rate_hz = clock_hz / state.period_cycles;
  state.frequency = static_cast<int32_t>(std::floor(speed_hz / rate_hz * 0x1p32));
  return state;
}

sensor::Description turning(double frequency_hz) {
  sensor::Description description;
  description.motion = MotionKind::constant;
  description.frequency_hz = frequency_hz;
  description.sample_rate_hz = 250;
  return description;
}

sensor::Description recording(double rate_hz) {
  sensor::Description description;
  description.motion = MotionKind::recorded;
  description.sample_rate_hz = rate_hz;
  return description;
}

/// What a run of `samples` results says.
std::vector<std::string> warnings(const sensor::Description& description,
                                  std::optional<double> speed, const metrics::SamplingState& state,
                                  unsigned samples = 20'000) {
  std::vector<std::string> said;
  metrics::SensorMatch match("x.csv", description, speed,
                             [&](const std::string& sentence) { said.push_back(sentence); });
  for (unsigned k = 0; k < samples; ++k) match.result(state);
  match.finish();
  return said;
}

TEST(SensorMatch, AProgramThatFitsIsLeftInPeace) {
  EXPECT_TRUE(warnings(turning(0.05), {}, program()).empty());
  EXPECT_TRUE(warnings(turning(0.05 * (1 + 1e-4)), {}, program()).empty());
  EXPECT_TRUE(warnings(recording(250), {}, program()).empty());
  EXPECT_TRUE(warnings(recording(250), 0.05 / 250, program()).empty());
}

TEST(SensorMatch, ATraceAtAnotherRateIsNamedWithBothRates) {
  const auto said = warnings(recording(1000), {}, program());
  ASSERT_EQ(said.size(), 1u);
  EXPECT_EQ(said[0].rfind("x.csv: the trace was sampled at 1000 Hz and the program samples at 250 "
                          "Hz: to the program the sensor turns 0.25 times as fast",
                          0),
            0u)
      << said[0];
}

TEST(SensorMatch, ADescribedSignalCanBeSampledAtAnyRate) {
  EXPECT_TRUE(warnings(turning(0.05), {}, program(1000)).empty());
  EXPECT_TRUE(warnings(turning(0.05), {}, program(100)).empty());
}

TEST(SensorMatch, TheNearestRateThatTheClockHasIsRight) {
  EXPECT_TRUE(warnings(recording(300'000), {}, program(300'000)).empty()) << "83 cycles";
  EXPECT_FALSE(warnings(recording(310'000), {}, program(300'000)).empty());
}

TEST(SensorMatch, AReferenceAtAnotherSpeedIsNamedWithBothSpeeds) {
  auto said = warnings(turning(0.051), {}, program());
  ASSERT_EQ(said.size(), 1u);
  EXPECT_NE(said[0].find("the sensor turns at 0.051 Hz and the program's reference at 0.05 Hz"),
            std::string::npos)
      << said[0];
  said = warnings(recording(250), 1.0 / 250, program());
  ASSERT_EQ(said.size(), 1u);
  EXPECT_NE(said[0].find("turns at 1 Hz and"), std::string::npos) << said[0];
}

TEST(SensorMatch, ADirectionIsNoSpeed) {
  EXPECT_TRUE(warnings(turning(-0.05), {}, program()).empty());
  EXPECT_TRUE(warnings(turning(0.05), {}, program(250, -0.05)).empty());
}

TEST(SensorMatch, ARateThatExplainsTheSpeedIsAllThatIsSaid) {
  EXPECT_EQ(warnings(recording(1000), 0.05 / 1000, program()).size(), 1u) << "same Hz";
  EXPECT_EQ(warnings(recording(1000), 0.05 / 250, program()).size(), 1u) << "same turns a sample";
  EXPECT_EQ(warnings(recording(1000), 0.07 / 1000, program()).size(), 2u);
}

TEST(SensorMatch, TheAngleReferenceNeedsNeitherRateNorSpeedNorOrder) {
  const metrics::SamplingState angle = program(250, 0.05, Reference::angle);
  sensor::Description shuffled;
  shuffled.motion = MotionKind::shuffled;
  EXPECT_TRUE(warnings(recording(1000), 1.0 / 250, angle).empty());
  EXPECT_TRUE(warnings(turning(0.051), {}, angle).empty());
  EXPECT_TRUE(warnings(shuffled, {}, angle).empty());
  metrics::SamplingState calibrating = program();
  calibrating.demodulating = false;
  EXPECT_TRUE(warnings(turning(0.051), {}, calibrating).empty());
}

TEST(SensorMatch, TrackingFindsTheSpeedButNoOrder) {
  const metrics::SamplingState tracking = program(250, 0.05, Reference::tracking);
  EXPECT_TRUE(warnings(turning(0.051), {}, tracking).empty());
  for (const auto kind : {MotionKind::shuffled, MotionKind::walk, MotionKind::swing,
                          MotionKind::ripple, MotionKind::profile}) {
    sensor::Description description;
    description.motion = kind;
    EXPECT_EQ(warnings(description, {}, program()).size(), 1u) << name_of(kind);
    EXPECT_EQ(warnings(description, {}, tracking).empty(), kind != MotionKind::shuffled);
  }
}

TEST(SensorMatch, AProgramThatSteersItsReferenceLooksForTheSpeedItself) {
  std::vector<std::string> said;
  metrics::SensorMatch match("x", turning(0.05), {},
                             [&](const std::string& s) { said.push_back(s); });
  for (int k = 0; k < 20'000; ++k) {
    metrics::SamplingState state = program(250, 0.0505 - 2e-8 * k);
    match.result(state);
  }
  EXPECT_TRUE(said.empty()) << "every value stands for less than two turns";
}

TEST(SensorMatch, ARunOfLessThanTwoTurnsIsJudgedAtItsEnd) {
  EXPECT_EQ(warnings(turning(0.051), {}, program(), 10).size(), 1u);
  EXPECT_TRUE(warnings(turning(0.051), {}, program(), 0).empty());
}

TEST(SensorMatch, ATurnedReferenceIsNotANewOne) {
  std::vector<std::string> said;
  metrics::SensorMatch match("x", turning(-0.051), {},
                             [&](const std::string& s) { said.push_back(s); });
  for (int k = 0; k < 10'000; ++k) match.result(program(250, k < 4000 ? 0.05 : -0.05));
  EXPECT_EQ(said.size(), 1u);
}

TEST(SensorMatch, AVerySlowReferenceIsNotHeldToDigitsThatItsUpperWordHasNot) {
  EXPECT_TRUE(warnings(turning(2e-6), {}, program(250, 2e-6)).empty());
}

sensor::RecordedSource rows(const std::vector<double>& turns, bool truth = true) {
  sensor::SampleColumn u, v, angle;
  for (const double turn : turns) {
    u.push_back(0.1);
    v.push_back(0.2);
    if (truth) angle.push_back(turn - std::floor(turn));
  }
  return {sensor::Description{}, std::move(u), std::move(v), std::move(angle)};
}

TEST(RecordedSpeed, LeavesAGapOut) {
  std::vector<double> turns;
  for (int k = 0; k < 2000; ++k) turns.push_back(0.002 * (k < 1000 ? k : k + 100));
  sensor::RecordedSource source = rows(turns);
  EXPECT_NEAR(metrics::recorded_speed(source).value_or(0), 0.002, 1e-12);
}

TEST(RecordedSpeed, IsTheMeanOfTheTrueAngles) {
  std::vector<double> turns;
  for (int k = 0; k < 101; ++k) turns.push_back(-0.03 * k + (k % 2 == 0 ? 0.001 : 0.0));
  sensor::RecordedSource source = rows(turns);
  const auto speed = metrics::recorded_speed(source);
  ASSERT_TRUE(speed);
  EXPECT_NEAR(*speed, -0.03, 1e-12);
}

TEST(RecordedSpeed, IsNotKnownWithoutAnglesOrASteadyDirection) {
  sensor::RecordedSource blind = rows({0.1, 0.2, 0.3}, false), one = rows({0.1}),
                         still = rows({0.1, 0.1}), swing = rows({0.1, 0.2, 0.3, 0.2, 0.1, 0.2});
  for (sensor::RecordedSource* source : {&blind, &one, &still, &swing})
    EXPECT_FALSE(metrics::recorded_speed(*source));
  sensor::DescribedSource described({});
  EXPECT_FALSE(metrics::recorded_speed(described));
}

}  // namespace
}  // namespace capsoc::run
