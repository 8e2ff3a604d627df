#include "sensor/time_stamps.h"

#include <gtest/gtest.h>

#include <functional>

namespace capsoc::sensor {
namespace {

/// The verdict on `rows` stamps; row k stands in line k + 2.
TimeStamps::Verdict verdict_of(int rows, const std::function<double(int)>& stamp) {
  TimeStamps stamps;
  for (int k = 0; k < rows; ++k) stamps.add(stamp(k), static_cast<unsigned long>(k + 2));
  return stamps.verdict();
}

TEST(TimeStamps, AnEvenClockGivesItsRateAndNoWord) {
  for (const int rows : {2, 100, 10'000}) {
    const auto verdict = verdict_of(rows, [](int k) { return 7 + k / 250.0; });
    ASSERT_TRUE(verdict.rate_hz);
    EXPECT_NEAR(*verdict.rate_hz, 250, 1e-9) << rows;
    EXPECT_TRUE(verdict.remarks.empty());
    EXPECT_EQ(verdict.error, "");
  }
}

TEST(TimeStamps, LostSamplesAreAGapAndNoOtherRate) {
  // Before and after the regular step is known.
  for (const int place : {1000, 6000}) {
    const auto verdict =
        verdict_of(8000, [place](int k) { return (k < place ? k : k + 100) / 250.0; });
    ASSERT_TRUE(verdict.rate_hz);
    EXPECT_NEAR(*verdict.rate_hz, 250, 1e-6);
    ASSERT_EQ(verdict.remarks.size(), 1u);
    EXPECT_NE(verdict.remarks[0].find("1 gap in the time stamps of 0.404 s"), std::string::npos);
    EXPECT_NE(verdict.remarks[0].find("(line " + std::to_string(place + 2) + ")"),
              std::string::npos);
    EXPECT_NE(verdict.remarks[0].find("about 100 samples"), std::string::npos);
  }
}

TEST(TimeStamps, OneLostSampleIsAGapAndJitterIsNone) {
  const auto lost = verdict_of(100, [](int k) { return k < 50 ? k : k + 1; });
  ASSERT_EQ(lost.remarks.size(), 1u);
  EXPECT_NE(lost.remarks[0].find("about 1 samples"), std::string::npos) << lost.remarks[0];
  const auto jitter = verdict_of(100, [](int k) { return k + 0.3 * (k % 2); });
  EXPECT_TRUE(jitter.remarks.empty());
}

TEST(TimeStamps, CoarseStampsGiveTheMeanRate) {
  // 4000 samples a second stamped in ms, and 300 a second: 3, 3, 4 ms.
  const auto often = verdict_of(8000, [](int k) { return (k / 4) * 1e-3; });
  EXPECT_NEAR(often.rate_hz.value_or(0), 4000, 4);
  const auto rounded = verdict_of(3000, [](int k) { return std::floor(k / 0.3) * 1e-3; });
  EXPECT_NEAR(rounded.rate_hz.value_or(0), 300, 0.2);
  EXPECT_TRUE(often.remarks.empty() && rounded.remarks.empty());
}

TEST(TimeStamps, DoubledRowsAreCounted) {
  const auto verdict = verdict_of(1000, [](int k) { return (k < 500 ? k : k - 1) * 0.004; });
  EXPECT_NEAR(verdict.rate_hz.value_or(0), 250, 1e-6);
  ASSERT_EQ(verdict.remarks.size(), 1u);
  EXPECT_EQ(verdict.remarks[0].rfind("1 row has the time stamp of the row before", 0), 0u);
}

TEST(TimeStamps, SortingIsAdvisedWhereItHelps) {
  const auto shuffled = verdict_of(1000, [](int k) { return (k * 377 % 1000) * 0.004; });
  EXPECT_NE(shuffled.error.find("sort the rows by time"), std::string::npos);
  const auto backwards = verdict_of(1000, [](int k) { return -k * 0.004; });
  EXPECT_NE(backwards.error.find("sort the rows by time"), std::string::npos);
  // A timer of 16 bits that goes round, and two recordings in one file: they are in order.
  for (const int period : {300, 500}) {
    const auto again = verdict_of(1000, [period](int k) { return (k % period) * 0.004; });
    EXPECT_EQ(again.error, "");
    EXPECT_NEAR(again.rate_hz.value_or(0), 250, 1e-6);
    ASSERT_EQ(again.remarks.size(), 1u);
    EXPECT_EQ(again.remarks[0].rfind("the clock begins again", 0), 0u);
  }
}

TEST(TimeStamps, StampsThatStandStillTellNoRate) {
  const auto verdict = verdict_of(100, [](int) { return 3.0; });
  EXPECT_FALSE(verdict.rate_hz);
  EXPECT_EQ(verdict.remarks.size(), 1u);
}

TEST(TimeStamps, UnevenStampsAreOneSentence) {
  const auto verdict = verdict_of(1000, [](int k) { return k + (k / 5) * 3; });
  ASSERT_EQ(verdict.remarks.size(), 1u);
  EXPECT_EQ(verdict.remarks[0].rfind("the time stamps are uneven", 0), 0u) << verdict.remarks[0];
}

}  // namespace
}  // namespace capsoc::sensor
