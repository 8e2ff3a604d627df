#include <gtest/gtest.h>

#include "bench.h"

namespace capsoc::test {
namespace {

using cmsdk::DualTimer;

enum Offset : uint64_t {
  load = 0x00,
  value = 0x04,
  control = 0x08,
  intclr = 0x0c,
  ris = 0x10,
  mis = 0x14,
  bgload = 0x18,
  second = 0x20,  // the same registers of timer 2
  itcr = 0xf00,
  itop = 0xf04,
};

class DualTimerTest : public testing::Test {
 protected:
  DualTimerTest() {
    b.clock.set_frequency(25'000'000);
    timer.reset();
  }
  uint32_t get(uint64_t offset) { return b.to_dual_timer.read(offset).value; }
  void set(uint64_t offset, uint32_t v) { ASSERT_TRUE(b.to_dual_timer.write(offset, v).ok()); }
  bool fires_at(uint64_t cycles) {
    b.run(cycles - 1);
    const bool early = timer.interrupt.level();
    b.run(1);
    return !early && timer.interrupt.level();
  }

  static constexpr uint32_t on = DualTimer::control_enable | DualTimer::control_interrupt;
  static constexpr uint32_t periodic = on | DualTimer::control_periodic | DualTimer::control_32_bit;
  Bench& b = bench();
  DualTimer& timer = b.dual_timer;
};

TEST_F(DualTimerTest, StartsFreeRunningInSixteenBitsWithTheInterruptEnabled) {
  for (uint64_t unit : {uint64_t{0}, uint64_t{second}}) {
    EXPECT_EQ(get(unit + load), 0u);
    EXPECT_EQ(get(unit + value), 0xffffffffu);
    EXPECT_EQ(get(unit + control), DualTimer::control_interrupt);
    EXPECT_EQ(get(unit + ris), 0u);
    EXPECT_EQ(get(unit + mis), 0u);
  }
}

TEST_F(DualTimerTest, InterruptsEveryLoadPlusOneCyclesInPeriodicMode) {
  set(load, 999);
  set(control, periodic);
  EXPECT_TRUE(fires_at(999));
  for (int period = 0; period < 3; ++period) {
    set(intclr, 1);
    EXPECT_FALSE(timer.interrupt.level());
    EXPECT_TRUE(fires_at(1000));
  }
}

TEST_F(DualTimerTest, WrapsAtItsWidthWhenItRunsFreely) {
  set(load, 5);
  set(control, on);
  b.run(6);
  EXPECT_EQ(get(value), 0x0000ffffu);
  set(control, on | DualTimer::control_32_bit);
  set(load, 5);
  b.run(6);
  EXPECT_EQ(get(value), 0xffffffffu);
}

TEST_F(DualTimerTest, StopsAtZeroInOneShotModeUntilLoadedAgain) {
  set(load, 20);
  set(control, periodic | DualTimer::control_one_shot);
  EXPECT_TRUE(fires_at(20));
  set(intclr, 1);
  b.run(100);
  EXPECT_EQ(get(value), 0u);
  EXPECT_FALSE(timer.interrupt.level());
  set(load, 30);
  EXPECT_TRUE(fires_at(30));
}

TEST_F(DualTimerTest, DividesTheClockByItsPrescaler) {
  set(load, 10);
  set(control, periodic | 1u << 2);
  EXPECT_TRUE(fires_at(160));
  set(control, 0);
  set(intclr, 1);
  set(load, 10);
  set(control, periodic | 2u << 2);
  EXPECT_TRUE(fires_at(2560));
}

TEST_F(DualTimerTest, DoesNotLoseAPartialStepToAReading) {
  set(load, 10);
  set(control, periodic | 1u << 2);
  for (int i = 0; i < 30; ++i) {
    b.run(5);
    EXPECT_EQ(get(value), 10u - 5 * (i + 1) / 16);
  }
  EXPECT_TRUE(fires_at(10));
}

TEST_F(DualTimerTest, TakesABackgroundLoadAtTheNextReload) {
  set(load, 100);
  set(control, periodic);
  b.run(40);
  set(bgload, 10);
  EXPECT_EQ(get(value), 60u);
  EXPECT_EQ(get(load), 10u);
  EXPECT_TRUE(fires_at(60));
  set(intclr, 1);
  EXPECT_TRUE(fires_at(11));
}

TEST_F(DualTimerTest, MasksButKeepsTheRawInterrupt) {
  set(load, 5);
  set(control, periodic & ~DualTimer::control_interrupt);
  b.run(5);
  EXPECT_EQ(get(ris), 1u);
  EXPECT_EQ(get(mis), 0u);
  EXPECT_FALSE(timer.interrupt.level());
  set(control, periodic);
  EXPECT_EQ(get(mis), 1u);
  EXPECT_TRUE(timer.interrupt.level());
}

TEST_F(DualTimerTest, JoinsBothTimersInOneInterrupt) {
  set(load, 50);
  set(second + load, 20);
  set(control, periodic);
  set(second + control, periodic);
  EXPECT_TRUE(fires_at(20));
  EXPECT_EQ(get(ris), 0u);
  EXPECT_EQ(get(second + ris), 1u);
  set(second + control, 0);
  set(second + intclr, 1);
  EXPECT_TRUE(fires_at(30));
}

TEST_F(DualTimerTest, KeepsTheUpperHalfWhileItCountsSixteenBits) {
  set(load, 0x12340005);
  set(control, on);
  b.run(3);
  EXPECT_EQ(get(value), 0x12340002u);
  set(control, DualTimer::control_32_bit);
  EXPECT_EQ(get(value), 0x12340002u);
}

TEST_F(DualTimerTest, ReportsTheUndefinedPrescaler) {
  const uint64_t before = kit::guest_error_count("dual_timer");
  set(load, 10);
  set(control, periodic | 3u << 2);
  EXPECT_EQ(kit::guest_error_count("dual_timer"), before + 1);
  EXPECT_TRUE(fires_at(2560));
}

TEST_F(DualTimerTest, DrivesItsOutputFromTheTestRegisters) {
  set(itop, 2);
  EXPECT_FALSE(timer.interrupt.level());
  set(itcr, 1);
  EXPECT_TRUE(timer.interrupt.level());
  set(itcr, 0);
  EXPECT_FALSE(timer.interrupt.level());
}

TEST_F(DualTimerTest, StandsStillAtZeroWithoutALoadInPeriodicMode) {
  set(control, periodic);
  set(load, 0);
  b.run(50);
  EXPECT_EQ(get(value), 0u);
  EXPECT_EQ(get(ris), 0u);
}

TEST_F(DualTimerTest, AResetStopsBothAndLowersTheInterrupt) {
  set(load, 5);
  set(control, periodic);
  b.run(5);
  timer.reset();
  EXPECT_FALSE(timer.interrupt.level());
  b.run(50);
  EXPECT_EQ(get(value), 0xffffffffu);
}

}  // namespace
}  // namespace capsoc::test
