#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "bench.h"

namespace capsoc::test {
namespace {

using cmsdk::Gpio;

enum Offset : uint64_t {
  data = 0x00,
  dataout = 0x04,
  outenset = 0x10,
  outenclr = 0x14,
  altfuncset = 0x18,
  altfuncclr = 0x1c,
  intenset = 0x20,
  intenclr = 0x24,
  inttypeset = 0x28,
  inttypeclr = 0x2c,
  intpolset = 0x30,
  intpolclr = 0x34,
  intstatus = 0x38,
};

class GpioTest : public testing::Test {
 protected:
  GpioTest() {
    b.clock.set_frequency(25'000'000);
    gpio.reset();
    gpio.drive(0xffff, 0);
    b.run(4);
    gpio.reset();
  }
  uint32_t get(uint64_t offset) { return b.to_gpio.read(offset).value; }
  void set(uint64_t offset, uint32_t v) { ASSERT_TRUE(b.to_gpio.write(offset, v).ok()); }
  void drive(unsigned pin, bool level) {
    gpio.drive(static_cast<uint16_t>(1u << pin), level ? 0xffff : 0);
  }

  Bench& b = bench();
  Gpio& gpio = b.gpio;
};

TEST_F(GpioTest, HasItsRegistersAtZeroAfterReset) {
  for (uint64_t offset : {data, dataout, outenset, outenclr, altfuncset, altfuncclr, intenset,
                          intenclr, inttypeset, inttypeclr, intpolset, intpolclr, intstatus})
    EXPECT_EQ(get(offset), 0u) << offset;
}

TEST_F(GpioTest, SetsAndClearsBitsInPairsOfRegisters) {
  for (uint64_t pair : {outenset, altfuncset, intenset, inttypeset, intpolset}) {
    set(pair, 0xf0f0);
    set(pair, 0x000f);
    set(pair + 4, 0x8001);
    EXPECT_EQ(get(pair), 0x70feu) << pair;
    EXPECT_EQ(get(pair + 4), 0x70feu) << pair;
  }
}

TEST_F(GpioTest, ReportsBitsAboveTheSixteenPins) {
  const uint64_t before = kit::guest_error_count("gpio");
  set(dataout, 0x10000);
  EXPECT_EQ(get(dataout), 0u);
  EXPECT_EQ(kit::guest_error_count("gpio"), before + 1);
}

TEST_F(GpioTest, ShowsAnInputAfterTwoCyclesOfSynchroniser) {
  gpio.drive(0xffff, 0x1234);
  b.run(1);
  EXPECT_EQ(get(data), 0u);
  b.run(1);
  EXPECT_EQ(b.to_gpio.debug_read(data), 0x1234u);
  EXPECT_EQ(get(data), 0x1234u);
}

TEST_F(GpioTest, DrivesOnlyEnabledPinsAndReadsThemBack) {
  gpio.drive(0xffff, 0xff00);
  set(dataout, 0x00aa);
  set(outenset, 0x0ff0);
  EXPECT_EQ(gpio.pins(), 0xf0a0);
  EXPECT_EQ(gpio.driven(), 0x0ff0);
  b.run(2);
  EXPECT_EQ(get(data), 0xf0a0u);
  EXPECT_EQ(get(dataout), 0x00aau);
}

TEST_F(GpioTest, WritesTheOutputThroughDataAsWell) {
  set(data, 0x5a5a);
  EXPECT_EQ(get(dataout), 0x5a5au);
  EXPECT_EQ(get(data), 0u);
}

TEST_F(GpioTest, LeavesAPinToItsAlternateFunction) {
  set(dataout, 1);
  set(outenset, 1);
  set(altfuncset, 1);
  EXPECT_EQ(gpio.driven(), 0);
  EXPECT_EQ(gpio.pins(), 0);
  EXPECT_EQ(gpio.alternate_functions(), 1);
  set(altfuncclr, 1);
  EXPECT_EQ(gpio.pins(), 1);
}

TEST_F(GpioTest, TellsTheObserverEveryChangeOfAnOutputOnce) {
  std::vector<std::pair<unsigned, unsigned>> seen;
  const auto listening = gpio.outputs.listen([&](uint16_t levels, uint16_t driven) {
    seen.push_back({levels, driven});
  });
  set(outenset, 3);
  set(dataout, 1);
  set(dataout, 1);
  set(dataout, 4);  // pin 2 is no output: only pin 0 falls
  const std::vector<std::pair<unsigned, unsigned>> expected = {{0, 3}, {1, 3}, {0, 3}};
  EXPECT_EQ(seen, expected);
}

TEST_F(GpioTest, TakesBytesAndHalfWords) {
  set(dataout, 0x1122);
  EXPECT_TRUE(b.to_gpio.write(dataout + 1, 0xaa, 1).ok());
  EXPECT_EQ(get(dataout), 0xaa22u);
  EXPECT_TRUE(b.to_gpio.write(data, 0xbb, 1).ok());
  EXPECT_EQ(get(dataout), 0xaabbu);
  set(intenset, 0x0101);
  EXPECT_TRUE(b.to_gpio.write(intenclr + 1, 0x01, 1).ok());
  EXPECT_EQ(get(intenset), 0x0001u);
  EXPECT_EQ(b.to_gpio.read(dataout, 2).value, 0xaabbu);
}

TEST_F(GpioTest, MasksTheLowByteByItsAddress) {
  set(dataout, 0x5555);
  set(0x400 + 4 * 0x0f, 0xffff);
  EXPECT_EQ(get(dataout), 0x555fu);
  set(0x400 + 4 * 0xf0, 0);
  EXPECT_EQ(get(dataout), 0x550fu);
  set(0x400, 0xffff);
  EXPECT_EQ(get(dataout), 0x550fu);
}

TEST_F(GpioTest, MasksTheHighByteByItsAddress) {
  set(dataout, 0x5555);
  set(0x800 + 4 * 0x0f, 0xffff);
  EXPECT_EQ(get(dataout), 0x5f55u);
  set(0xbfc, 0x1234);
  EXPECT_EQ(get(dataout), 0x1255u);
  EXPECT_TRUE(b.to_gpio.write(0xbfc + 1, 0x77, 1).ok());
  EXPECT_EQ(get(dataout), 0x7755u);
}

TEST_F(GpioTest, ReadsThePinsThroughTheMask) {
  gpio.drive(0xffff, 0xffff);
  b.run(2);
  EXPECT_EQ(get(0x400 + 4 * 0x81), 0x0081u);
  EXPECT_EQ(get(0x800 + 4 * 0x81), 0x8100u);
  EXPECT_EQ(b.to_gpio.debug_read(0x7fc), 0x00ffu);
}

TEST_F(GpioTest, LatchesARisingEdge) {
  set(inttypeset, 1u << 3);
  set(intpolset, 1u << 3);
  set(intenset, 1u << 3);
  drive(3, true);
  b.run(1);
  EXPECT_FALSE(gpio.pin_interrupt[3].level());
  b.run(1);
  EXPECT_TRUE(gpio.pin_interrupt[3].level());
  EXPECT_TRUE(gpio.combined_interrupt.level());
  EXPECT_FALSE(gpio.pin_interrupt[2].level());
  EXPECT_EQ(get(intstatus), 1u << 3);
  set(intstatus, 1u << 3);
  EXPECT_FALSE(gpio.combined_interrupt.level());
  drive(3, false);
  b.run(2);
  EXPECT_EQ(get(intstatus), 0u);
}

TEST_F(GpioTest, LatchesAFallingEdge) {
  drive(0, true);
  b.run(2);
  set(inttypeset, 1);
  set(intenset, 1);
  EXPECT_EQ(get(intstatus), 0u);
  drive(0, false);
  b.run(2);
  EXPECT_EQ(get(intstatus), 1u);
}

TEST_F(GpioTest, ALevelInterruptIsBackWhileTheLevelLasts) {
  set(intpolset, 2);
  set(intenset, 2);
  drive(1, true);
  b.run(2);
  set(intstatus, 2);
  EXPECT_TRUE(gpio.pin_interrupt[1].level());
  drive(1, false);
  b.run(2);
  EXPECT_TRUE(gpio.pin_interrupt[1].level());
  set(intstatus, 2);
  EXPECT_FALSE(gpio.pin_interrupt[1].level());
}

TEST_F(GpioTest, ALowLevelInterruptsAsSoonAsItIsEnabled) {
  set(intenset, 0x8000);
  EXPECT_TRUE(gpio.pin_interrupt[15].level());
  EXPECT_EQ(get(intstatus), 0x8000u);
}

TEST_F(GpioTest, KeepsWhatIsLatchedWhenTheEnableGoes) {
  set(intenset, 1);
  set(intenclr, 1);
  EXPECT_EQ(get(intstatus), 1u);
  set(intstatus, 1);
  EXPECT_EQ(get(intstatus), 0u);
}

TEST_F(GpioTest, DoesNotLatchWhatIsNotEnabled) {
  set(inttypeset, 1);
  set(intpolset, 1);
  drive(0, true);
  b.run(2);
  set(intenset, 1);
  EXPECT_EQ(get(intstatus), 0u);
}

TEST_F(GpioTest, SeesAPulseOfOneCycleAndNoneWithinACycle) {
  set(inttypeset, 1);
  set(intpolset, 1);
  set(intenset, 1);
  drive(0, true);
  drive(0, false);
  b.run(4);
  EXPECT_EQ(get(intstatus), 0u);
  drive(0, true);
  b.run(1);
  drive(0, false);
  b.run(2);
  EXPECT_EQ(get(intstatus), 1u);
  EXPECT_EQ(get(data), 0u);
}

TEST_F(GpioTest, InterruptsOnItsOwnOutput) {
  set(inttypeset, 1);
  set(intpolset, 1);
  set(intenset, 1);
  set(outenset, 1);
  set(dataout, 1);
  b.run(2);
  EXPECT_EQ(get(intstatus), 1u);
}

TEST_F(GpioTest, AResetReleasesThePinsAndLowersTheInterrupts) {
  gpio.drive(0xffff, 0x8000);
  set(outenset, 1);
  set(dataout, 1);
  set(intenset, 0xffff);
  gpio.reset();
  EXPECT_EQ(gpio.pins(), 0x8000);
  EXPECT_FALSE(gpio.combined_interrupt.level());
  for (const auto& line : gpio.pin_interrupt) EXPECT_FALSE(line.level());
}

}  // namespace
}  // namespace capsoc::test
