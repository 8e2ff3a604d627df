#include "peripherals/quantiser.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace {

using capsoc::peripherals::quantise;

class Quantiser : public testing::TestWithParam<unsigned> {
 protected:
  unsigned bits() const { return GetParam(); }
  double lsb() const { return std::ldexp(1.0, 1 - static_cast<int>(bits())); }
  int64_t word_of(double x) const { return int64_t{quantise(x, bits()).word} >> (32 - bits()); }
};

TEST_P(Quantiser, RoundsHalfUp) {
  EXPECT_EQ(word_of(0.0), 0);
  EXPECT_EQ(word_of(0.5 * lsb()), 1);
  EXPECT_EQ(word_of(-0.5 * lsb()), 0);
  EXPECT_EQ(word_of(-1.5 * lsb()), -1);
  EXPECT_EQ(word_of(std::nextafter(0.5 * lsb(), 0.0)), 0) << "just below one half is not one half";
  EXPECT_EQ(word_of(std::nextafter(-0.5 * lsb(), -1.0)), -1);
}

TEST_P(Quantiser, LeavesTheBitsBelowItsResolutionZero) {
  const auto word = static_cast<uint32_t>(quantise(0.7123456789, bits()).word);
  const uint64_t below = (uint64_t{1} << (32 - bits())) - 1;
  EXPECT_EQ(word & below, 0u);
}

TEST_P(Quantiser, CoversItsRangeWithoutClipping) {
  const auto highest = quantise(1.0 - lsb(), bits());
  const auto lowest = quantise(-1.0, bits());
  EXPECT_FALSE(highest.clipped);
  EXPECT_FALSE(lowest.clipped);
  EXPECT_EQ(word_of(1.0 - lsb()), (int64_t{1} << (bits() - 1)) - 1);
  EXPECT_EQ(lowest.word, std::numeric_limits<int32_t>::min());
}

TEST_P(Quantiser, ClipsOutsideItsRange) {
  for (const double x :
       {1.0, 1.0 - lsb() / 2, 1.5, 1e300, std::numeric_limits<double>::infinity()}) {
    EXPECT_TRUE(quantise(x, bits()).clipped) << x;
    EXPECT_EQ(word_of(x), (int64_t{1} << (bits() - 1)) - 1) << x;
  }
  for (const double x : {-1.0 - lsb(), -1.5, -1e300, -std::numeric_limits<double>::infinity()}) {
    EXPECT_TRUE(quantise(x, bits()).clipped) << x;
    EXPECT_EQ(quantise(x, bits()).word, std::numeric_limits<int32_t>::min()) << x;
  }
  EXPECT_FALSE(quantise(-1.0 - lsb() / 2, bits()).clipped) << "rounds up into the range";
}

TEST_P(Quantiser, IsWithinHalfAStep) {
  for (int i = -999; i < 1000; ++i) {
    const double x = i / 1000.0;
    EXPECT_LE(std::abs(quantise(x, bits()).word / 2147483648.0 - x), lsb() / 2);
  }
}

INSTANTIATE_TEST_SUITE_P(OfEveryResolution, Quantiser, testing::Range(12u, 33u));

TEST(QuantiserEdges, NoNumberIsAClippedZero) {
  const auto result = quantise(std::nan(""), 32);
  EXPECT_EQ(result.word, 0);
  EXPECT_TRUE(result.clipped);
}

TEST(QuantiserEdges, AResolutionOutsideTheLimitsCountsAsTheNearer) {
  EXPECT_EQ(quantise(0.3, 0).word, quantise(0.3, 12).word);
  EXPECT_EQ(quantise(0.3, 99).word, quantise(0.3, 32).word);
}

}  // namespace
