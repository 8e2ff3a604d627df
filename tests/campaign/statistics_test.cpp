#include "campaign/statistics.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "campaign/axis.h"

namespace {

using namespace capsoc::campaign;

TEST(Statistics, WilsonsIntervalIsThatOfHisPaper) {
  // Newcombe 1998, table I: 81 of 263, 15 of 148, 0 of 20, 1 of 29.
  struct Row {
    uint64_t passed, count;
    double least, greatest;
  };
  for (const Row& row : {Row{81, 263, 0.2553, 0.3662}, Row{15, 148, 0.0624, 0.1605},
                         Row{0, 20, 0.0000, 0.1611}, Row{1, 29, 0.0061, 0.1718}}) {
    const Interval interval = wilson(row.passed, row.count);
    EXPECT_NEAR(interval.least, row.least, 5e-5);
    EXPECT_NEAR(interval.greatest, row.greatest, 5e-5);
  }
  EXPECT_EQ(wilson(20, 20).greatest, 1);
}

TEST(Statistics, ASummaryOfFewNumbers) {
  const auto summary = summarise({4, 1, 3, 2, 5});
  ASSERT_TRUE(summary);
  EXPECT_EQ(summary->mean, 3);
  EXPECT_DOUBLE_EQ(summary->deviation, std::sqrt(2.5));
  EXPECT_EQ(summary->quantiles.front(), 1);
  EXPECT_EQ(summary->quantiles[3], 2);  // 25 %
  EXPECT_EQ(summary->quantiles[4], 3);
  EXPECT_EQ(summary->quantiles.back(), 5);
  EXPECT_FALSE(summarise({}));
  EXPECT_EQ(summarise({7})->histogram.bins, std::vector<uint64_t>{1});
}

TEST(Statistics, AHistogramHasEveryValueOnce) {
  std::vector<double> values;
  for (int i = 0; i <= 1000; ++i) values.push_back(i);
  const Histogram linear = summarise(values)->histogram;
  EXPECT_FALSE(linear.logarithmic);
  uint64_t sum = 0;
  for (const uint64_t bin : linear.bins) {
    EXPECT_NEAR(static_cast<double>(bin), 50, 1);
    sum += bin;
  }
  EXPECT_EQ(sum, 1001u);
  for (double& value : values) value = std::pow(10, value / 100);
  EXPECT_TRUE(summarise(values)->histogram.logarithmic);
  EXPECT_EQ(summarise({-1e308, 0, 1e308})->histogram.bins[10], 1u);
}

TEST(Statistics, SensitivityOfAFunction) {
  std::vector<std::string> up, noise, words;
  std::vector<double> metric, bowl;
  for (uint64_t i = 0; i < 2000; ++i) {
    const double x = draw(1, "x", i);
    up.push_back(fmt::format("{}", x));
    noise.push_back(fmt::format("{}", draw(1, "other", i)));
    words.emplace_back(x < 0.5 ? "low" : "high");
    metric.push_back(std::exp(5 * x));
    bowl.push_back((x - 0.5) * (x - 0.5));
  }
  EXPECT_NEAR(*sensitivity(up, metric)->correlation, 1, 1e-9);
  EXPECT_GT(sensitivity(up, metric)->share, 0.99);
  EXPECT_LT(sensitivity(noise, metric)->share, 0.02);
  EXPECT_NEAR(*sensitivity(noise, metric)->correlation, 0, 0.07);
  EXPECT_NEAR(*sensitivity(up, bowl)->correlation, 0, 0.07);
  EXPECT_GT(sensitivity(up, bowl)->share, 0.95);
  EXPECT_NEAR(sensitivity(words, metric)->share, 0.75, 0.01);
  EXPECT_FALSE(sensitivity(words, metric)->correlation);
  EXPECT_FALSE(sensitivity({"1", "1", "1", "1"}, {1, 2, 3, 4}));
  EXPECT_FALSE(sensitivity({"1", "2", "3", "4"}, {1, 1, 1, 1}));
}

TEST(Statistics, ChanceIsWhatOneAxisInAHundredExceeds) {
  for (const int runs : {20, 60, 400})
    for (const bool texts : {false, true}) {
      constexpr int draws = 4000;
      int above = 0;
      for (uint64_t trial = 0; trial < draws; ++trial) {
        std::vector<std::string> axis;
        std::vector<double> metric;
        for (int i = 0; i < runs; ++i) {
          const uint64_t number = trial * 1000 + static_cast<uint64_t>(i);
          const double x = draw(2, "axis", number);
          axis.push_back(texts ? std::string(1, static_cast<char>('a' + static_cast<int>(4 * x)))
                               : fmt::format("{}", x));
          metric.push_back(draw(3, "metric", number));
        }
        const auto found = sensitivity(axis, metric);
        if (found && found->share > found->chance) ++above;
      }
      // 40 expected; small samples have fewer.
      EXPECT_LE(above, 60) << runs << texts;
      EXPECT_GE(above, runs > 20 ? 20 : 0) << runs << texts;
    }
}

TEST(Axis, DrawsHaveTheirDistribution) {
  Axis axis;
  axis.path = "x";
  axis.kind = Axis::Kind::normal;
  axis.a = 10;
  axis.b = 2;
  axis.least = -INFINITY;
  axis.greatest = INFINITY;
  EXPECT_NEAR(std::stod(axis.at_quantile(0.5, 1, 0)), 10, 1e-9);
  EXPECT_NEAR(std::stod(axis.at_quantile(0.975, 1, 0)), 10 + 2 * 1.959964, 1e-5);
  EXPECT_NEAR(std::stod(axis.at_quantile(0.025, 1, 0)), 10 - 2 * 1.959964, 1e-5);
  EXPECT_TRUE(std::isfinite(std::stod(axis.at_quantile(0, 1, 0))));
  axis.least = 9;
  axis.greatest = 11;
  for (const double share : {0.0, 0.3, 0.7, 1 - 0x1p-53}) {
    const double value = std::stod(axis.at_quantile(share, 1, 0));
    EXPECT_GE(value, 9);
    EXPECT_LE(value, 11);
  }
  axis.kind = Axis::Kind::integers;
  axis.a = 12;
  axis.b = 24;
  EXPECT_EQ(axis.at_quantile(0, 1, 0), "12");
  EXPECT_EQ(axis.at_quantile(1 - 0x1p-53, 1, 0), "24");
  axis.kind = Axis::Kind::log_range;
  axis.a = 0.1;
  axis.b = 1000;
  axis.count = 5;
  EXPECT_EQ(axis.value(0, 1), "0.1");
  EXPECT_NEAR(std::stod(axis.value(1, 1)), 1, 1e-12);
  EXPECT_EQ(axis.value(4, 1), "1000");
}

TEST(Axis, EqualStepsThatAreWholeNumbersAreWritten) {
  Axis axis;
  axis.kind = Axis::Kind::range;
  axis.a = -3;
  for (const uint32_t count : {2u, 37u, 71u, 1000u}) {
    axis.b = axis.a + 2.0 * (count - 1);
    axis.count = count;
    for (uint32_t i = 0; i < count; ++i)
      ASSERT_EQ(axis.value(i, 1), std::to_string(-3 + 2 * static_cast<int>(i))) << count;
  }
  axis.a = 0.1;
  axis.b = 0.7;
  axis.count = 7;
  EXPECT_EQ(axis.value(6, 1), "0.7");
}

TEST(Axis, ADrawnOrderHasEveryNumber) {
  auto order = draw_order(1, "x", 1000);
  EXPECT_NE(order, draw_order(2, "x", 1000));
  EXPECT_EQ(order, draw_order(1, "x", 1000));
  std::sort(order.begin(), order.end());
  for (uint32_t i = 0; i < 1000; ++i) EXPECT_EQ(order[i], i);
}

}  // namespace
