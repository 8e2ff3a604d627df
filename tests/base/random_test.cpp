#include "base/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

namespace capsoc {
namespace {

TEST(Random, GivesSplitMix64FromItsSeed) {
  Random random(0);
  EXPECT_EQ(random.word(), 0xE220A8397B1DCDAFull);  // Steele, Lea and Flood's first of seed 0
  EXPECT_NE(Random(1, 0).word(), Random(1, 1).word());
}

// Records, stimuli and training depend on which of the two a caller takes.
TEST(Random, BelowIsARemainderAndIndexAScaledFraction) {
  Random below(5), index(5), words(5);
  for (int i = 0; i < 1000; ++i) {
    const uint64_t word = words.word();
    EXPECT_EQ(below.below(10), word % 10);
    EXPECT_EQ(index.index(10),
              static_cast<int64_t>(static_cast<double>(word >> 11) * 0x1p-53 * 10));
  }
}

TEST(RandomSequence, GivesTheSameWordsOnEveryMachine) {
  const RandomSequence sequence(1, 0);
  EXPECT_EQ(sequence.word(0), 10899625468024805921ull);
  EXPECT_EQ(sequence.word(1), 11895835327869646416ull);
  EXPECT_EQ(sequence.word(1000000), 16671524352330810435ull);
  EXPECT_EQ(RandomSequence(2, 3).word(7), 6938870380877022455ull);
}

TEST(RandomSequence, DiffersBetweenSeedsAndStreams) {
  EXPECT_NE(RandomSequence(1, 0).word(0), RandomSequence(2, 0).word(0));
  EXPECT_NE(RandomSequence(1, 0).word(0), RandomSequence(1, 1).word(0));
}

TEST(RandomSequence, IsUniformWithinItsStatisticalError) {
  const RandomSequence sequence(7, 0);
  constexpr int count = 100000;
  double sum = 0.0, squares = 0.0;
  for (int i = 0; i < count; ++i) {
    const double x = sequence.uniform(i);
    ASSERT_GE(x, 0.0);
    ASSERT_LT(x, 1.0);
    sum += x;
    squares += x * x;
  }
  // Five standard errors: 5 sqrt(1/12 / count), 5 sqrt(4/45 / count).
  EXPECT_NEAR(sum / count, 0.5, 0.0046);
  EXPECT_NEAR(squares / count, 1.0 / 3.0, 0.0048);
}

TEST(RandomSequence, IsGaussianWithinItsStatisticalError) {
  const RandomSequence u(7, 1), v(7, 2);
  constexpr int count = 100000;
  double mean = 0.0, variance = 0.0, kurtosis = 0.0, cross = 0.0, lag = 0.0;
  for (int i = 0; i < count; ++i) {
    const double x = u.gaussian(i);
    mean += x / count;
    variance += x * x / count;
    kurtosis += x * x * x * x / count;
    cross += x * v.gaussian(i) / count;
    lag += x * u.gaussian(i + 1) / count;
  }
  // Five standard errors: sqrt(1, 2, 96 / count); the sums of products like the mean.
  EXPECT_NEAR(mean, 0.0, 0.016);
  EXPECT_NEAR(variance, 1.0, 0.023);
  EXPECT_NEAR(kurtosis, 3.0, 0.155);
  EXPECT_NEAR(cross, 0.0, 0.016);
  EXPECT_NEAR(lag, 0.0, 0.016);
}

TEST(RandomSequence, FindsTheLargestOfARecord) {
  const RandomSequence sequence(3, 1);
  double largest = 0.0;
  for (int i = 0; i < 1000; ++i) largest = std::max(largest, std::abs(sequence.gaussian(i)));
  EXPECT_EQ(sequence.gaussian_peak(1000), largest);
  EXPECT_EQ(sequence.gaussian_peak(0), 0.0);
}

}  // namespace
}  // namespace capsoc
