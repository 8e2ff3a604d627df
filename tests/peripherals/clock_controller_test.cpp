#include <gtest/gtest.h>

#include "kit/guest_error.h"
#include "test_bench.h"

namespace {

using namespace capsoc::registers::clockctrl;
using sc_core::sc_time;

constexpr uint32_t ratio(uint32_t multiplier, uint32_t divider) {
  return multiplier << PLL_MULT_shift | divider << PLL_DIV_shift;
}

class ClockController : public capsoc::test::DeviceTest {
 protected:
  void select_pll() { EXPECT_OK(bus.write(CTRL_offset, CTRL_PLL_EN_mask | CTRL_SELECT_mask)); }
  bool locked() { return (bus.value_at(STATUS_offset) & STATUS_LOCKED_mask) != 0; }

  capsoc::test::BusAccess& bus = clock_controller;
};

TEST_F(ClockController, StartsWithTheReference) {
  EXPECT_EQ(bus.value_at(ID_offset), 0x43434C4Bu);
  EXPECT_EQ(bus.value_at(FREQ_offset), 25'000'000u);
  EXPECT_EQ(bus.value_at(STATUS_offset), 0u);
  EXPECT_EQ(bench.clock.frequency_hz(), 25'000'000u);
}

TEST_F(ClockController, LocksAfterTheLockTimeAndNotBefore) {
  EXPECT_OK(bus.write(PLL_offset, ratio(4, 1)));
  select_pll();
  bench.run(2499);
  EXPECT_FALSE(locked());
  EXPECT_EQ(bus.value_at(FREQ_offset), 25'000'000u);
  bench.run(1);
  EXPECT_EQ(bus.value_at(STATUS_offset), STATUS_LOCKED_mask | STATUS_SELECTED_mask);
  EXPECT_EQ(bus.value_at(FREQ_offset), 100'000'000u);
}

TEST_F(ClockController, ALockedPllThatIsNotSelectedDrivesNothing) {
  EXPECT_OK(bus.write(PLL_offset, ratio(4, 1)));
  EXPECT_OK(bus.write(CTRL_offset, CTRL_PLL_EN_mask));
  bench.run(2500);
  EXPECT_EQ(bus.value_at(STATUS_offset), STATUS_LOCKED_mask);
  EXPECT_EQ(bench.clock.frequency_hz(), 25'000'000u);
  select_pll();
  EXPECT_EQ(bench.clock.frequency_hz(), 100'000'000u);
}

TEST_F(ClockController, AFrequencySwitchKeepsTheCycleCount) {
  EXPECT_OK(bus.write(PLL_offset, ratio(8, 3)));
  EXPECT_OK(bus.write(LOCK_TIME_offset, 10));
  const uint64_t before = bench.cycle();
  const sc_time start = sc_core::sc_time_stamp();
  select_pll();
  bench.run(10);
  ASSERT_EQ(bench.clock.frequency_hz(), 66'666'666u);
  EXPECT_EQ(bench.cycle(), before + 10);
  EXPECT_EQ(sc_core::sc_time_stamp() - start, sc_time(400, sc_core::SC_NS));
  for (uint64_t cycle = before + 10; cycle < before + 2000; ++cycle) {
    ASSERT_EQ(bench.clock.cycles_at(bench.clock.time_of(cycle)), cycle);
    ASSERT_LT(bench.clock.time_of(cycle), bench.clock.time_of(cycle + 1));
  }
  bench.run(66'666'666);
  EXPECT_EQ(sc_core::sc_time_stamp() - start,
            sc_time(400, sc_core::SC_NS) + sc_time(1, sc_core::SC_SEC));
  EXPECT_OK(bus.write(CTRL_offset, 0));
  EXPECT_EQ(bench.cycle(), before + 10 + 66'666'666);
  bench.run(25);
  EXPECT_EQ(bench.cycle(), before + 35 + 66'666'666);
}

TEST_F(ClockController, AnotherRatioFallsBackToTheReferenceAndLocksAgain) {
  EXPECT_OK(bus.write(PLL_offset, ratio(4, 1)));
  select_pll();
  bench.run(2500);
  ASSERT_EQ(bench.clock.frequency_hz(), 100'000'000u);
  EXPECT_OK(bus.write(PLL_offset, ratio(2, 1)));
  EXPECT_EQ(bench.clock.frequency_hz(), 25'000'000u);
  EXPECT_FALSE(locked());
  bench.run(2499);
  EXPECT_FALSE(locked());
  bench.run(1);
  EXPECT_EQ(bench.clock.frequency_hz(), 50'000'000u);
}

TEST_F(ClockController, AChangeWhileLockingStartsTheLockAnew) {
  EXPECT_OK(bus.write(PLL_offset, ratio(4, 1)));
  select_pll();
  bench.run(2000);
  EXPECT_OK(bus.write(PLL_offset, ratio(3, 1)));
  bench.run(2499);
  EXPECT_FALSE(locked());
  bench.run(1);
  EXPECT_TRUE(locked());
}

TEST_F(ClockController, SwitchingOffCancelsTheLock) {
  select_pll();
  bench.run(100);
  EXPECT_OK(bus.write(CTRL_offset, 0));
  bench.run(5000);
  EXPECT_FALSE(locked());
}

TEST_F(ClockController, WithoutLockTimeItLocksAtOnce) {
  EXPECT_OK(bus.write(LOCK_TIME_offset, 0));
  EXPECT_OK(bus.write(PLL_offset, ratio(2, 1)));
  select_pll();
  EXPECT_EQ(bench.clock.frequency_hz(), 50'000'000u);
}

TEST_F(ClockController, IllegalRatiosAreIgnoredAndRemembered) {
  for (const uint32_t illegal : {ratio(0, 1), ratio(9, 1), ratio(1, 0), ratio(1, 26), 0u}) {
    EXPECT_OK(bus.write(PLL_offset, illegal));
    EXPECT_EQ(bus.value_at(PLL_offset), PLL_reset) << illegal;
    EXPECT_EQ(bus.value_at(STATUS_offset), STATUS_ERROR_mask) << illegal;
    EXPECT_OK(bus.write(STATUS_offset, 0));
    EXPECT_EQ(bus.value_at(STATUS_offset), STATUS_ERROR_mask) << "sticky";
    EXPECT_OK(bus.write(STATUS_offset, STATUS_ERROR_mask));
    EXPECT_EQ(bus.value_at(STATUS_offset), 0u);
  }
}

TEST_F(ClockController, AWriteAheadOfTimeTakesEffectThen) {
  EXPECT_OK(bus.write(LOCK_TIME_offset, 0));
  EXPECT_OK(bus.write(PLL_offset, ratio(2, 1)));
  bus.ahead = sc_time(400, sc_core::SC_NS);
  select_pll();
  bench.run(9);
  EXPECT_EQ(bench.clock.frequency_hz(), 25'000'000u);
  bench.run(1);
  EXPECT_EQ(bench.clock.frequency_hz(), 50'000'000u);
}

TEST_F(ClockController, SystemResetReturnsToTheReference) {
  EXPECT_OK(bus.write(LOCK_TIME_offset, 0));
  EXPECT_OK(bus.write(PLL_offset, ratio(2, 1)));
  select_pll();
  bench.clock_controller.reset();
  EXPECT_EQ(bench.clock.frequency_hz(), 25'000'000u);
  EXPECT_EQ(bus.value_at(PLL_offset), PLL_reset);
}

TEST_F(ClockController, BytesAndHolesAreBusErrors) {
  uint32_t value = 0;
  EXPECT_ADDRESS_ERROR(bus.write(CTRL_offset, 1, 1));
  EXPECT_ADDRESS_ERROR(bus.read(0x18, value));
  EXPECT_GT(capsoc::kit::guest_error_count("bench.clock_controller"), 0u);
}

}  // namespace
