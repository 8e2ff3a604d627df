// What is drawn of a run's samples, gathered while they come.
#include "metrics/sample_curves.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "capsoc_registers.h"
#include "metrics/last_turn.h"

namespace capsoc::metrics {
namespace {

namespace cop = registers::coprocessor;

/// Of a sensor without distortion at `turns`; the coprocessor's angle is `error_deg` off.
RecordedSample sample(double time_s, double turns, double error_deg = 0) {
  RecordedSample s;
  s.time_s = time_s;
  s.u = static_cast<int32_t>(std::lround(0.5 * q31 * std::sin(two_pi * turns)));
  s.v = static_cast<int32_t>(std::lround(0.5 * q31 * std::cos(two_pi * turns)));
  s.angle_turns = turns;
  s.has_truth = true;
  RecordedResult result;
  const double angle = turns + error_deg / 360;
  result.angle = static_cast<uint32_t>(std::llround((angle - std::floor(angle)) * q32));
  result.words = {1 << 30, 1 << 30, 0, 0, 0, 0};
  result.angle_valid = true;
  s.result = result;
  return s;
}

std::size_t length_after(std::size_t samples, double turns_per_sample) {
  LastTurn last;
  for (std::size_t i = 0; i < samples; ++i)
    last.add(sample(static_cast<double>(i), static_cast<double>(i) * turns_per_sample));
  return last.samples().size();
}

TEST(LastTurnTest, IsATurnInEitherDirectionWhereverItEnds) {
  for (const std::size_t samples : {5000U, 12345U, 20000U, 20001U, 31999U})
    for (const double direction : {1, -1})
      EXPECT_NEAR(static_cast<double>(length_after(samples, direction / 4096.0)),
                  std::min<double>(static_cast<double>(samples), 4097), 1);
}

TEST(LastTurnTest, IsNeitherShorterNorLongerThanIsDrawn) {
  EXPECT_EQ(length_after(30000, 0.3), LastTurn::least);
  EXPECT_EQ(length_after(700, 0.3), 700U);
  EXPECT_EQ(length_after(150000, 0), LastTurn::most);
  EXPECT_EQ(length_after(0, 0), 0U);
}

TEST(LastTurnTest, HoldsTheNewestInOrder) {
  LastTurn last;
  for (int i = 0; i < 123457; ++i) last.add(sample(i, i / 9000.0));
  const auto samples = last.samples();
  EXPECT_EQ(samples.back().angle_turns, 123456 / 9000.0);
  for (std::size_t i = 1; i < samples.size(); ++i)
    ASSERT_GT(samples[i].angle_turns, samples[i - 1].angle_turns);
}

TEST(LastTurnTest, SamplesWithoutAResultAreNoWay) {
  LastTurn last;
  for (int i = 0; i < 40000; ++i) {
    RecordedSample s = sample(i, i / 4096.0);
    s.result.reset();
    last.add(s);
  }
  EXPECT_EQ(last.samples().size(), LastTurn::most);
  EXPECT_FALSE(last.samples().front().has_error);
}

const Curve* find(const Curves& curves, const std::string& name) {
  for (const auto& [is, curve] : curves)
    if (is == name) return &curve;
  return nullptr;
}

constexpr int third = 3;
constexpr double amplitude_deg = 0.25;
constexpr double ratio = 1.01;  ///< of the sensor's amplitudes

/// A third harmonic of error, unequal amplitudes, and three bits: one set in the midst, one for a
/// sample, one never.
Curves of_many(int samples) {
  SampleCurves gathered;
  for (int i = 0; i < samples; ++i) {
    const double turns = i / 3000.0;
    RecordedSample s = sample(i * 1e-3, turns, amplitude_deg * std::sin(third * two_pi * turns));
    s.u = static_cast<int32_t>(std::lround(s.u * ratio));
    if (i >= samples / 2) s.result->status |= cop::STATUS_LOCK_mask;
    if (i == samples / 3) s.result->flags |= cop::FLAGS_CLIP_mask;
    gathered.add(s);
  }
  return gathered.curves({1 << 30, 1 << 30, 0, 0, 0, 0});
}

TEST(SampleCurvesTest, AHarmonicStandsInTheSpectrumAlone) {
  const Curves curves = of_many(20000);
  const Curve* spectrum = find(curves, "spectrum");
  ASSERT_NE(spectrum, nullptr);
  ASSERT_EQ(spectrum->y.size(), 17U);
  for (std::size_t h = 0; h < spectrum->y.size(); ++h)
    EXPECT_NEAR(spectrum->y[h], h == third ? amplitude_deg : 0, 1e-6) << h;
  const Curve* raw = find(curves, "raw_spectrum");
  ASSERT_NE(raw, nullptr);
  // The series of atan(k tan x) - x: q^n / n sin(2 n x).
  const double q = (ratio - 1) / (ratio + 1);
  for (std::size_t h = 1; h < raw->y.size(); ++h) {
    const double n = static_cast<double>(h) / 2;
    EXPECT_NEAR(raw->y[h], h % 2 == 0 ? std::pow(q, n) / n / radians_per_degree : 0, 1e-6) << h;
  }
}

TEST(SampleCurvesTest, AnErrorShowsOverTimeAndAngle) {
  const Curves curves = of_many(50000);
  for (const char* name : {"angle_error", "error_by_angle"}) {
    const Curve* error = find(curves, name);
    ASSERT_NE(error, nullptr) << name;
    EXPECT_LE(error->x.size(), 1200U);
    EXPECT_NEAR(*std::max_element(error->y.begin(), error->y.end()), amplitude_deg, 1e-6);
    EXPECT_NEAR(*std::min_element(error->y.begin(), error->y.end()), -amplitude_deg, 1e-6);
  }
  EXPECT_EQ(find(curves, "angle_error")->x.back(), 49.999);
  EXPECT_EQ(find(curves, "a1")->y.front(), 0.5);
}

TEST(SampleCurvesTest, ABitHasAPointForEachChange) {
  const Curves curves = of_many(3000);
  const Curve* lock = find(curves, "status.LOCK");
  ASSERT_NE(lock, nullptr);
  EXPECT_EQ(lock->x, (std::vector<double>{0, 1.5, 2.999}));
  EXPECT_EQ(lock->y, (std::vector<double>{0, 1, 1}));
  const Curve* clip = find(curves, "flags.CLIP");
  ASSERT_NE(clip, nullptr);
  EXPECT_EQ(clip->x, (std::vector<double>{0, 1.0, 1.001, 2.999}));
  EXPECT_EQ(clip->y, (std::vector<double>{0, 1, 0, 0}));
  EXPECT_EQ(find(curves, "flags.SAT"), nullptr);
}

TEST(SampleCurvesTest, WithoutTruthOrResultsNothingIsDrawnOfThem) {
  SampleCurves none;
  EXPECT_TRUE(none.curves({}).empty());
  SampleCurves blind, lost;
  for (int i = 0; i < 3000; ++i) {
    RecordedSample s = sample(i * 1e-3, i / 300.0);
    s.has_truth = false;
    blind.add(s);
    s.result.reset();
    lost.add(s);
  }
  const Curves seen = blind.curves({1 << 30, 1 << 30, 0, 0, 0, 0});
  for (const char* name : {"angle_error", "raw_error", "error_by_angle", "spectrum"})
    EXPECT_EQ(find(seen, name), nullptr) << name;
  EXPECT_NE(find(seen, "a1"), nullptr);
  EXPECT_NE(find(seen, "lissajous"), nullptr);
  EXPECT_EQ(find(lost.curves({}), "a1"), nullptr);
}

}  // namespace
}  // namespace capsoc::metrics
