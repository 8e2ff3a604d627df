#include <gtest/gtest.h>

#include "bench.h"

namespace capsoc::test {
namespace {

using cmsdk::Watchdog;

enum Offset : uint64_t {
  load = 0x000,
  value = 0x004,
  control = 0x008,
  intclr = 0x00c,
  ris = 0x010,
  mis = 0x014,
  lock = 0xc00,
  itcr = 0xf00,
  itop = 0xf04,
};

class WatchdogTest : public testing::Test {
 protected:
  WatchdogTest() {
    b.clock.set_frequency(25'000'000);
    dog.reset();
  }
  uint32_t get(uint64_t offset) { return b.to_watchdog.read(offset).value; }
  void set(uint64_t offset, uint32_t v) { ASSERT_TRUE(b.to_watchdog.write(offset, v).ok()); }

  static constexpr uint32_t both = Watchdog::control_interrupt | Watchdog::control_reset;
  Bench& b = bench();
  Watchdog& dog = b.watchdog;
};

TEST_F(WatchdogTest, SleepsAfterResetWithAFullCounter) {
  EXPECT_EQ(get(load), 0xffffffffu);
  b.run(100);
  EXPECT_EQ(get(value), 0xffffffffu);
  for (uint64_t offset : {control, ris, mis, lock}) EXPECT_EQ(get(offset), 0u);
}

TEST_F(WatchdogTest, InterruptsFirstAndResetsTheSecondTime) {
  set(load, 100);
  set(control, both);
  b.run(99);
  EXPECT_FALSE(dog.interrupt.level());
  b.run(1);
  EXPECT_TRUE(dog.interrupt.level());
  EXPECT_FALSE(dog.reset_request.level());
  b.run(100);
  EXPECT_FALSE(dog.reset_request.level());
  b.run(1);
  EXPECT_TRUE(dog.reset_request.level());
}

TEST_F(WatchdogTest, IsFedByClearingItsInterrupt) {
  set(load, 100);
  set(control, both);
  for (int i = 0; i < 10; ++i) {
    b.run(90);
    set(intclr, 1);
    EXPECT_EQ(get(value), 100u);
  }
  EXPECT_FALSE(dog.interrupt.level());
  EXPECT_FALSE(dog.reset_request.level());
}

TEST_F(WatchdogTest, OnlyInterruptsWithoutResetEnabledAndResetsOnceItIs) {
  set(load, 10);
  set(control, Watchdog::control_interrupt);
  b.run(500);
  EXPECT_TRUE(dog.interrupt.level());
  EXPECT_FALSE(dog.reset_request.level());
  set(control, both);
  EXPECT_TRUE(dog.reset_request.level());
}

TEST_F(WatchdogTest, StopsAndStartsWithItsInterruptEnable) {
  set(load, 100);
  set(control, both);
  b.run(50);
  set(control, 0);
  b.run(500);
  EXPECT_EQ(get(value), 50u);
  set(control, both);
  EXPECT_EQ(get(value), 100u);
}

TEST_F(WatchdogTest, IgnoresAndReportsWritesWhileLocked) {
  set(load, 1000);
  set(lock, 0);
  EXPECT_EQ(get(lock), 1u);
  const uint64_t before = kit::guest_error_count("watchdog");
  set(load, 5);
  set(control, both);
  EXPECT_EQ(kit::guest_error_count("watchdog"), before + 2);
  EXPECT_EQ(get(load), 1000u);
  EXPECT_EQ(get(control), 0u);
  set(lock, Watchdog::unlock_word);
  EXPECT_EQ(get(lock), 0u);
  set(load, 5);
  EXPECT_EQ(get(load), 5u);
}

TEST_F(WatchdogTest, DrivesItsOutputsFromTheTestRegisters) {
  set(itcr, 1);
  set(itop, 2);
  EXPECT_TRUE(dog.interrupt.level());
  EXPECT_FALSE(dog.reset_request.level());
  set(itop, 1);
  EXPECT_FALSE(dog.interrupt.level());
  EXPECT_TRUE(dog.reset_request.level());
}

TEST_F(WatchdogTest, AResetLowersBothOutputs) {
  set(load, 3);
  set(control, both);
  b.run(20);
  dog.reset();
  EXPECT_FALSE(dog.interrupt.level());
  EXPECT_FALSE(dog.reset_request.level());
  EXPECT_EQ(get(value), 0xffffffffu);
}

}  // namespace
}  // namespace capsoc::test
