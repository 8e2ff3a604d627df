#include "peripherals/pll.h"

#include <gtest/gtest.h>

namespace {

using capsoc::peripherals::Pll;

TEST(Pll, TakesRatiosFrom1To200MHzOnly) {
  EXPECT_TRUE(Pll::legal(1, 25));
  EXPECT_FALSE(Pll::legal(1, 26));
  EXPECT_TRUE(Pll::legal(8, 1));
  EXPECT_FALSE(Pll::legal(9, 1));
  EXPECT_TRUE(Pll::legal(248, 31));
  EXPECT_FALSE(Pll::legal(249, 31));
  EXPECT_FALSE(Pll::legal(0, 1));
  EXPECT_FALSE(Pll::legal(1, 0));
  EXPECT_FALSE(Pll::legal(0, 0));
}

TEST(Pll, DrivesTheOutputOnlyWhileLockedAndSelected) {
  Pll pll;
  EXPECT_TRUE(pll.set_ratio(4, 1));
  pll.select(true);
  pll.enable(true);
  EXPECT_EQ(pll.output_hz(), Pll::reference_hz);
  pll.lock();
  EXPECT_EQ(pll.output_hz(), 100'000'000u);
  pll.select(false);
  EXPECT_EQ(pll.output_hz(), Pll::reference_hz);
}

TEST(Pll, LosesItsLockWithAnotherRatioAndWhenOff) {
  Pll pll;
  pll.enable(true);
  pll.lock();
  EXPECT_TRUE(pll.set_ratio(1, 1));
  EXPECT_TRUE(pll.locked()) << "the same ratio is no change";
  EXPECT_FALSE(pll.set_ratio(100, 1));
  EXPECT_TRUE(pll.locked()) << "an illegal ratio is ignored";
  EXPECT_TRUE(pll.set_ratio(2, 1));
  EXPECT_FALSE(pll.locked());
  pll.lock();
  pll.enable(false);
  EXPECT_FALSE(pll.locked());
  pll.lock();
  EXPECT_FALSE(pll.locked()) << "an off PLL cannot lock";
}

}  // namespace
