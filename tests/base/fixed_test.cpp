#include "base/fixed.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace capsoc::fixed {
namespace {

TEST(RoundShift, SendsTiesTowardsPlusInfinity) {
  EXPECT_EQ(round_shift<int64_t>(5, 1), 3);
  EXPECT_EQ(round_shift<int64_t>(-5, 1), -2);
  EXPECT_EQ(round_shift<int64_t>(6, 2), 2);
  EXPECT_EQ(round_shift<int64_t>(-6, 2), -1);
  EXPECT_EQ(round_shift<int64_t>(-7, 2), -2);
  EXPECT_EQ(round_shift<int64_t>(-9, 0), -9);
}

TEST(RoundShift, AgreesWithFloorOfHalfMore) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 100000; ++i) {
    const auto value = static_cast<int32_t>(random());
    const unsigned shift = static_cast<unsigned>(random() % 31);
    const double expected = std::floor(std::ldexp(value, -static_cast<int>(shift)) + 0.5);
    ASSERT_EQ(round_shift<int64_t>(value, shift), static_cast<int64_t>(expected));
    ASSERT_EQ(static_cast<int64_t>(round_shift<int128>(value, shift)),
              static_cast<int64_t>(expected));
  }
}

TEST(Saturate, ClampsAtBothEndsAndSaysSo) {
  bool saturated = false;
  EXPECT_EQ(saturate32(int64_t{INT32_MAX}, saturated), INT32_MAX);
  EXPECT_EQ(saturate32(int64_t{INT32_MIN}, saturated), INT32_MIN);
  EXPECT_FALSE(saturated);
  EXPECT_EQ(saturate32(int64_t{INT32_MAX} + 1, saturated), INT32_MAX);
  EXPECT_TRUE(saturated);
  saturated = false;
  EXPECT_EQ(saturate<48>(-(int128{1} << 90), saturated), -(int64_t{1} << 47));
  EXPECT_TRUE(saturated);
  EXPECT_EQ(saturate<48>(int64_t{3}, saturated), 3);
  EXPECT_TRUE(saturated) << "sticky";
}

TEST(MagnitudeBits, CountsWithoutTheSign) {
  EXPECT_EQ(magnitude_bits(0), 0u);
  EXPECT_EQ(magnitude_bits(-1), 0u);
  EXPECT_EQ(magnitude_bits(1), 1u);
  EXPECT_EQ(magnitude_bits(-(int128{1} << 66)), 66u);
  EXPECT_EQ(magnitude_bits(int128{1} << 66), 67u);
  EXPECT_EQ(leading_zeros(0), 64u);
  EXPECT_EQ(leading_zeros(1), 63u);
}

TEST(SignExtend, ReadsTheLowBits) {
  EXPECT_EQ(sign_extend<37>(uint64_t{1} << 36), -(int64_t{1} << 36));
  EXPECT_EQ(sign_extend<37>((uint64_t{1} << 40) | 5), 5);
}

TEST(ToQ31, RoundsHalfUpAndSaturates) {
  EXPECT_EQ(to_q31(0.0), 0);
  EXPECT_EQ(to_q31(1.5 / 2147483648.0), 2);
  EXPECT_EQ(to_q31(-1.5 / 2147483648.0), -1);
  EXPECT_EQ(to_q31(-2.5 / 2147483648.0), -2);
  EXPECT_EQ(to_q31(-2.6 / 2147483648.0), -3);
  EXPECT_EQ(to_q31(1.0), INT32_MAX);
  EXPECT_EQ(to_q31(2147483647.4 / 2147483648.0), INT32_MAX);
  EXPECT_EQ(to_q31(-1.0), INT32_MIN);
  EXPECT_EQ(to_q31(-7.0), INT32_MIN);
  EXPECT_EQ(to_q31(std::nan("")), 0);
}

}  // namespace
}  // namespace capsoc::fixed
