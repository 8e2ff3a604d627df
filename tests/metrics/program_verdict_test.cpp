#include "metrics/program_verdict.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <string>
#include <vector>

namespace capsoc::run {
namespace {

constexpr uint32_t place = 0x20000100;

loader::ElfImage with_object() {
  loader::ElfImage image;
  image.symbols.push_back({place, 188, "program_verdict"});
  return image;
}

using Words = std::vector<uint32_t>;

/// The words of an object, then its reason.
std::vector<uint8_t> object(const Words& words, const char* reason, std::size_t room) {
  std::vector<uint8_t> bytes(4 * words.size() + room);
  std::memcpy(bytes.data(), words.data(), 4 * words.size());
  std::memcpy(&bytes[4 * words.size()], reason, std::min(std::strlen(reason), room));
  return bytes;
}

metrics::ReadMemory memory(std::vector<uint8_t> bytes) {
  return [bytes = std::move(bytes)](uint32_t address, void* into, uint32_t size) {
    if (address < place || address - place + size > bytes.size()) return false;
    std::memcpy(into, &bytes[address - place], size);
    return true;
  };
}

constexpr uint32_t magic = 0x32524556, first_magic = 0x31524556;
constexpr uint32_t eighth = 1U << 29U;

std::vector<uint8_t> claim(uint32_t bound, uint32_t samples, uint32_t conditions = 0) {
  return object({magic, 1, bound, samples, eighth / 8, eighth / 16, conditions}, "unused", 160);
}

metrics::SensorTruth sample(double turns) {
  metrics::SensorTruth truth;
  truth.angle_turns = turns;
  truth.has_truth = true;
  return truth;
}

/// Results of calibration mode, each with an error in degrees.
metrics::Metrics off_by(const std::vector<double>& degrees) {
  metrics::Metrics metrics({}, 1);
  for (const double error : degrees) {
    metrics.accepted(sample(0));
    metrics::CoprocessorResult result;
    result.angle = static_cast<uint32_t>(error / 360 * 0x1p32);
    result.angle_valid = true;
    metrics.result(result);
  }
  return metrics;
}

TEST(ProgramVerdict, ABoundIsComparedWithTheErrorsOfTheSamplesThatItIsAbout) {
  const metrics::Metrics metrics = off_by({100, 44.9, 3, 2, 1});
  const auto of_last = [&](uint32_t samples) {
    return metrics::read_verdict(with_object(), memory(claim(eighth, samples)), metrics);
  };
  const auto verdict = of_last(4);
  ASSERT_TRUE(verdict);
  EXPECT_TRUE(verdict->pass);
  EXPECT_DOUBLE_EQ(verdict->bound_deg, 45);
  EXPECT_EQ(verdict->samples, 4u);
  EXPECT_DOUBLE_EQ(verdict->motion_deg.value(), 45.0 / 8);
  EXPECT_EQ(verdict->reason, "");
  EXPECT_NEAR(verdict->largest_error_deg.value(), 44.9, 1e-6);
  EXPECT_EQ(verdict->bound_holds(), true);
  EXPECT_NEAR(of_last(3)->largest_error_deg.value(), 3, 1e-6);
  EXPECT_NEAR(of_last(1)->largest_error_deg.value(), 1, 1e-6);
  EXPECT_EQ(of_last(5)->bound_holds(), false);
  EXPECT_EQ(of_last(1000)->bound_holds(), false);
  EXPECT_EQ(
      metrics::read_verdict(with_object(), memory(claim(eighth, 4)), off_by({}))->bound_holds(),
      std::nullopt);
}

TEST(ProgramVerdict, WhatAPassTakesForGrantedIsSaid) {
  const auto conditions = [](uint32_t bits) {
    return metrics::read_verdict(with_object(), memory(claim(eighth, 4, bits)), off_by({1}))
        ->conditions;
  };
  EXPECT_TRUE(conditions(0).empty());
  EXPECT_EQ(conditions(1), std::vector<std::string>{"no sample is stale"});
  EXPECT_EQ(conditions(3),
            (std::vector<std::string>{"no sample is stale",
                                      "harmonics along the circle stay below 2.81 deg"}));
  EXPECT_EQ(conditions(12),
            (std::vector<std::string>{"every sample is the sensor's",
                                      "no second signal turns at almost its speed"}));
}

TEST(ProgramVerdict, AProgramOfTheFirstLayoutSpeaksOfCalibrationMode) {
  const auto read = memory(object({first_magic, 1, eighth}, "unused", 96));
  const auto verdict = metrics::read_verdict(with_object(), read, off_by({44, 1}));
  ASSERT_TRUE(verdict);
  EXPECT_DOUBLE_EQ(verdict->bound_deg, 45);
  EXPECT_EQ(verdict->samples, std::nullopt);
  EXPECT_NEAR(verdict->largest_error_deg.value(), 44, 1e-6);
  EXPECT_EQ(metrics::read_verdict(with_object(), read, off_by({46, 1}))->bound_holds(), false);
}

TEST(ProgramVerdict, AnAngleThatCountsTheOtherWayIsComparedWithTheOtherAngle) {
  metrics::Parameters truth;
  truth.a1 = truth.a2 = 0.5;
  truth.beta = 3.0;
  metrics::Metrics metrics(truth, 1);
  metrics.accepted(sample(0.1));
  metrics::CoprocessorResult result;
  result.angle = static_cast<uint32_t>(0.4 * 0x1p32);  // half a turn less 0.1
  result.angle_valid = true;
  metrics.result(result);
  EXPECT_NEAR(metrics.largest_error_of_last(1).value(), 0, 1e-6);
  result.words.beta = 1U << 31U;  // the program's parameters are of the sensor's own direction
  metrics.accepted(sample(0.1));
  metrics.result(result);
  EXPECT_NEAR(metrics.largest_error_of_last(1).value(), 108, 1e-6);
}

TEST(ProgramVerdict, AFailHasAReasonAndNothingElse) {
  const auto fail = [](const char* reason) {
    return metrics::read_verdict(
        with_object(), memory(object({magic, 2, 7, 7, 7, 7, 3}, reason, 160)), off_by({}));
  };
  const auto verdict = fail("no\x1b[31m lock");
  ASSERT_TRUE(verdict);
  EXPECT_FALSE(verdict->pass);
  EXPECT_EQ(verdict->reason, "no?[31m lock");
  EXPECT_TRUE(verdict->conditions.empty());
  EXPECT_EQ(verdict->bound_holds(), std::nullopt);
  // Without an end the sentence ends with its field.
  const std::string long_one(200, 'x');
  EXPECT_EQ(fail(long_one.c_str())->reason, std::string(160, 'x'));
}

TEST(ProgramVerdict, WhatIsNoVerdictIsNone) {
  const auto none = [](const loader::ElfImage& image, std::vector<uint8_t> bytes) {
    return !metrics::read_verdict(image, memory(std::move(bytes)), off_by({}));
  };
  EXPECT_TRUE(none({}, claim(7, 1))) << "no such object";
  EXPECT_TRUE(none(with_object(), object({magic + 7, 1, 7, 7, 7, 7, 0}, "", 160)));
  EXPECT_TRUE(none(with_object(), object({magic, 0, 7, 7, 7, 7, 0}, "", 160))) << "not yet";
  EXPECT_TRUE(none(with_object(), object({magic, 3, 7, 7, 7, 7, 0}, "", 160)));
  EXPECT_TRUE(none(with_object(), object({magic, 1, 7}, "", 96))) << "cut short";
  EXPECT_TRUE(none(with_object(), {})) << "no memory there";
}

}  // namespace
}  // namespace capsoc::run
