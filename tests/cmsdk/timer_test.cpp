#include <gtest/gtest.h>

#include "bench.h"

namespace capsoc::test {
namespace {

using cmsdk::Timer;

enum Offset : uint64_t { ctrl = 0x0, value = 0x4, reload = 0x8, intstatus = 0xc };

class TimerTest : public testing::Test {
 protected:
  TimerTest() {
    b.clock.set_frequency(25'000'000);
    timer.reset();
  }
  uint32_t get(uint64_t offset) { return b.to_timer.read(offset).value; }
  void set(uint64_t offset, uint32_t v) { ASSERT_TRUE(b.to_timer.write(offset, v).ok()); }
  bool fires_at(uint64_t cycles) {
    b.run(cycles - 1);
    const bool early = timer.interrupt.level();
    b.run(1);
    return !early && timer.interrupt.level();
  }

  static constexpr uint32_t on = Timer::ctrl_enable | Timer::ctrl_interrupt;
  Bench& b = bench();
  Timer& timer = b.timer;
};

TEST_F(TimerTest, HasItsRegistersAtZeroAfterReset) {
  for (uint64_t offset : {ctrl, value, reload, intstatus}) EXPECT_EQ(get(offset), 0u);
}

TEST_F(TimerTest, KeepsOnlyTheControlBitsThatExist) {
  set(ctrl, 0xfffffff8);
  EXPECT_EQ(get(ctrl), 8u);
}

TEST_F(TimerTest, LoadsTheCounterWithAWriteToReload) {
  set(reload, 0x12345678);
  EXPECT_EQ(get(reload), 0x12345678u);
  EXPECT_EQ(get(value), 0x12345678u);
  set(value, 5);
  EXPECT_EQ(get(value), 5u);
  EXPECT_EQ(get(reload), 0x12345678u);
}

TEST_F(TimerTest, StandsStillUntilEnabled) {
  set(value, 100);
  b.run(10);
  EXPECT_EQ(get(value), 100u);
  set(ctrl, Timer::ctrl_enable);
  EXPECT_EQ(get(value), 100u);
  b.run(10);
  EXPECT_EQ(get(value), 90u);
  set(ctrl, 0);
  b.run(10);
  EXPECT_EQ(get(value), 90u);
}

TEST_F(TimerTest, CountsDownToZeroHoldsOneCycleAndReloads) {
  set(reload, 3);
  set(ctrl, Timer::ctrl_enable);
  for (uint32_t expected : {3u, 2u, 1u, 0u, 3u, 2u, 1u, 0u, 3u}) {
    EXPECT_EQ(b.to_timer.debug_read(value), expected);
    EXPECT_EQ(get(value), expected);
    b.run(1);
  }
}

TEST_F(TimerTest, InterruptsEveryReloadPlusOneCycles) {
  set(reload, 999);
  set(ctrl, on);
  EXPECT_TRUE(fires_at(999));
  for (int period = 0; period < 3; ++period) {
    set(intstatus, 1);
    EXPECT_TRUE(fires_at(1000));
  }
}

TEST_F(TimerTest, KeepsThePhaseWhenTheInterruptIsServedLate) {
  set(reload, 99);
  set(ctrl, on);
  b.run(99 + 250);  // two more zeros go by unseen, at 199 and 299
  EXPECT_EQ(get(intstatus), 1u);
  set(intstatus, 1);
  EXPECT_FALSE(timer.interrupt.level());
  EXPECT_TRUE(fires_at(50));
}

TEST_F(TimerTest, ClearsTheInterruptWithAOneOnly) {
  set(value, 1);
  set(ctrl, on);
  b.run(1);
  set(intstatus, 0);
  EXPECT_TRUE(timer.interrupt.level());
  set(intstatus, 1);
  EXPECT_FALSE(timer.interrupt.level());
  EXPECT_EQ(get(intstatus), 0u);
}

TEST_F(TimerTest, StopsAtZeroWithoutAReloadValue) {
  set(value, 5);
  set(ctrl, on);
  EXPECT_TRUE(fires_at(5));
  set(intstatus, 1);
  b.run(100);
  EXPECT_FALSE(timer.interrupt.level());
  EXPECT_EQ(get(value), 0u);
}

TEST_F(TimerTest, TakesTheReloadValueOneCycleAfterZero) {
  set(reload, 10);
  set(value, 0);
  set(ctrl, on);
  EXPECT_TRUE(fires_at(11));
}

TEST_F(TimerTest, DoesNotRememberAZeroThatWasNotEnabledToInterrupt) {
  set(reload, 10);
  set(ctrl, Timer::ctrl_enable);
  b.run(15);
  EXPECT_EQ(get(intstatus), 0u);
  set(ctrl, on);
  EXPECT_EQ(get(intstatus), 0u);
  EXPECT_TRUE(fires_at(6));  // zeros at 10 and 21
}

TEST_F(TimerTest, KeepsAPendingInterruptWhenStopped) {
  set(value, 1);
  set(ctrl, on);
  b.run(1);
  set(ctrl, 0);
  EXPECT_TRUE(timer.interrupt.level());
}

TEST_F(TimerTest, RestartsFromAValueWrittenWhileCounting) {
  set(reload, 1000);
  set(ctrl, on);
  b.run(500);
  set(value, 20);
  EXPECT_TRUE(fires_at(20));
}

TEST_F(TimerTest, CountsTheWholeThirtyTwoBits) {
  set(reload, 0xffffffff);
  set(ctrl, on);
  EXPECT_TRUE(fires_at(0xffffffff));
  EXPECT_EQ(get(value), 0u);
  b.run(1);
  EXPECT_EQ(get(value), 0xffffffffu);
}

TEST_F(TimerTest, DoesNotCountWithTheExternalInputAndTellsTheGuest) {
  const uint64_t before = kit::guest_error_count("timer");
  set(value, 10);
  set(ctrl, on | Timer::ctrl_external_enable);
  b.run(20);
  set(ctrl, on | Timer::ctrl_external_clock);
  b.run(20);
  EXPECT_EQ(get(value), 10u);
  EXPECT_EQ(kit::guest_error_count("timer"), before + 2);
}

TEST_F(TimerTest, KeepsItsCycleWhenTheClockChanges) {
  set(value, 1000);
  set(ctrl, on);
  b.run(400);
  b.clock.set_frequency(30'000'000);
  EXPECT_EQ(get(value), 600u);
  EXPECT_TRUE(fires_at(600));
}

TEST_F(TimerTest, ShowsADebuggerTheCounterWithoutMovingIt) {
  set(value, 100);
  set(ctrl, on);
  b.run(30);
  EXPECT_EQ(b.to_timer.debug_read(value), 70u);
  EXPECT_TRUE(fires_at(70));
}

TEST_F(TimerTest, MergesAByteWriteIntoReload) {
  set(reload, 0x11223344);
  EXPECT_TRUE(b.to_timer.write(reload + 1, 0xaa, 1).ok());
  EXPECT_EQ(get(reload), 0x1122aa44u);
}

TEST_F(TimerTest, AResetStopsItAndLowersTheInterrupt) {
  set(value, 1);
  set(ctrl, on);
  b.run(1);
  timer.reset();
  EXPECT_FALSE(timer.interrupt.level());
  EXPECT_EQ(get(ctrl), 0u);
  EXPECT_EQ(get(value), 0u);
}

}  // namespace
}  // namespace capsoc::test
