#include "sensor/sample_units.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"

namespace capsoc::sensor {
namespace {

UnitGuess guess(double least, double most, bool whole, const std::string& unit = "") {
  ValueRange range;
  range.take(least);
  range.take(most);
  range.whole = whole;
  return guess_unit(range, unit);
}

SampleColumn column(int count, const std::function<double(int)>& value) {
  SampleColumn column;
  for (int k = 0; k < count; ++k) column.push_back(value(k));
  return column;
}

TEST(SampleUnits, GuessesCountsVoltsAndPercent) {
  struct Case {
    UnitGuess guess;
    const char* name;
    double full_scale, zero;
  };
  const Case cases[] = {
      {guess(548, 3548, true), "12-bit counts", 2048, 2048},
      {guess(12, 1020, true), "10-bit counts", 512, 512},
      {guess(100, 65000, true), "16-bit counts", 32768, 32768},
      {guess(-1800, 1900, true), "signed 12-bit counts", 2048, 0},
      {guess(-8388608, 8388607, true), "signed 24-bit counts", 8388608, 0},
      {guess(1.2, 2.1, false), "volts of a 3.3 V supply", 1.65, 1.65},
      {guess(0.9, 4.1, false), "volts of a 5 V supply", 2.5, 2.5},
      {guess(-4.1, 4.3, false), "volts", 5, 0},
      {guess(1203.5, 2101.25, false), "millivolts of a 3.3 V supply", 1650, 1650},
      {guess(3, 97, true, "%"), "percent", 50, 50},
      {guess(-72.5, 81, false), "percent", 100, 0},
      {guess(1203, 2101, true, "mv"), "millivolts of a 3.3 V supply", 1650, 1650},
  };
  for (const Case& each : cases) {
    EXPECT_EQ(each.guess.name, each.name);
    EXPECT_EQ(each.guess.full_scale, each.full_scale) << each.name;
    EXPECT_EQ(each.guess.zero, each.zero) << each.name;
  }
}

TEST(SampleUnits, AGuessHoldsEveryRange) {
  for (uint64_t k = 0; k < 20'000; ++k) {
    const RandomSequence random(k, 1);
    const double size = std::pow(10, -3 + 15 * random.uniform(0));
    double least = size * (2 * random.uniform(1) - 1), most = size * (2 * random.uniform(2) - 1);
    if (least > most) std::swap(least, most);
    const bool whole = k % 2 == 0;
    if (whole) least = std::floor(least), most = std::floor(most);
    const char* units[] = {"", "v", "mv", "%"};
    const UnitGuess found = guess(least, most, whole, units[k % 4]);
    EXPECT_LE(std::fabs(least - found.zero), 1.000001 * found.full_scale) << least << " " << most;
    EXPECT_LE(std::fabs(most - found.zero), 1.000001 * found.full_scale) << least << " " << most;
  }
}

TEST(SampleUnits, AFewOutliersAreNoOtherUnit) {
  ValueRange range;
  for (int k = 0; k < 1000; ++k) range.take(k % 200 == 0 ? 7 : 0.5);
  EXPECT_FALSE(range.outside_full_scale());
  for (int k = 0; k < 1000; ++k) range.take(k % 20 == 0 ? 7 : 0.5);
  EXPECT_TRUE(range.outside_full_scale());
}

TEST(SampleUnits, TheStepIsThatOfTheConverter) {
  for (const double step : {1.0, 1.0 / 2048, 3.3 / 4096, 0x1p-15}) {
    const auto counts =
        column(5000, [step](int k) { return 0.3 + step * std::round(700 * std::sin(0.01 * k)); });
    const auto found = grid_step(counts);
    ASSERT_TRUE(found) << step;
    EXPECT_NEAR(*found, step, 1e-9 * step);
  }
}

TEST(SampleUnits, DigitsOfATextDoNotHideTheStep) {
  const auto volts = column(5000, [](int k) {
    return std::round(3.3 / 4096 * std::round(2048 + 1500 * std::sin(0.01 * k)) * 1e6) / 1e6;
  });
  ASSERT_TRUE(grid_step(volts));
  EXPECT_NEAR(*grid_step(volts), 3.3 / 4096, 1e-9);
}

TEST(SampleUnits, SmoothValuesHaveNoStep) {
  EXPECT_FALSE(grid_step(column(5000, [](int k) { return std::sin(0.01 * k); })));
  EXPECT_FALSE(grid_step(column(5000, [](int k) { return (k % 12) * 0.1; }))) << "too few values";
  // One value off the grid is no converter's.
  EXPECT_FALSE(grid_step(column(5000, [](int k) { return k == 4321 ? 7.37 : k % 100; })));
}

TEST(SampleUnits, TwoConvertersHaveNoCommonStep) {
  const auto one = column(1000, [](int k) { return k % 100; });
  const auto other = column(1000, [](int k) { return 0.5 * (k % 100); });
  EXPECT_EQ(common_step(one, one), 1);
  EXPECT_FALSE(common_step(one, other));
}

}  // namespace
}  // namespace capsoc::sensor
