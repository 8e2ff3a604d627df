#include <gtest/gtest.h>

#include <random>
#include <utility>
#include <vector>

#include "bench.h"
#include "kit/early_write.h"
#include "kit/steady_read.h"

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

/// Accesses at given cycles ahead of the kernel.
class GpioAhead : public GpioTest {
 protected:
  struct Access {
    uint64_t cycle;  ///< after the first
    bool write;
    uint64_t offset;
    uint32_t value;  ///< written
  };

  sc_core::sc_time lead(uint64_t cycles) const {
    return b.clock.time_of(b.cycle() + cycles) - b.clock.time_of(b.cycle());
  }
  /// Whether it was taken.
  bool write_early(uint64_t offset, uint32_t value, uint64_t cycles) {
    tlm::tlm_generic_payload payload;
    Initiator::describe(payload, tlm::TLM_WRITE_COMMAND, offset,
                        reinterpret_cast<unsigned char*>(&value), 4);
    kit::EarlyWrite told;
    told.early = true;
    payload.set_extension(&told);
    EXPECT_TRUE(b.to_gpio.send(payload, lead(cycles)).ok());
    payload.clear_extension<kit::EarlyWrite>();
    return told.taken;
  }
  uint32_t read_ahead(uint64_t offset, uint64_t cycles) {
    uint32_t value = 0;
    tlm::tlm_generic_payload payload;
    Initiator::describe(payload, tlm::TLM_READ_COMMAND, offset,
                        reinterpret_cast<unsigned char*>(&value), 4);
    kit::SteadyRead told;
    payload.set_extension(&told);
    EXPECT_TRUE(b.to_gpio.send(payload, lead(cycles)).ok());
    payload.clear_extension<kit::SteadyRead>();
    EXPECT_TRUE(told.ahead);
    EXPECT_FALSE(told.steady) << "DATA follows two cycles after a write, with no event";
    return value;
  }
  /// Both ways begin with the same pins.
  void begin(uint32_t enabled) {
    gpio.reset();
    gpio.drive(0xffff, 0x5a5a);
    b.run(4);
    set(outenset, enabled);
    b.run(4);
  }
};

TEST_F(GpioAhead, IsWhatItIsAtItsOwnTime) {
  std::minstd_rand random(20261126);
  for (int round = 0; round < 300; ++round) {
    std::vector<Access> drawn;
    uint64_t cycle = 0;
    for (int i = 0; i < 20; ++i) {
      cycle += random() % 5;
      const bool write = random() % 2 != 0;
      drawn.push_back({cycle, write, write && random() % 2 != 0 ? dataout : data,
                       static_cast<uint32_t>(random() & 0xffff)});
    }
    const uint32_t enabled = random() & 0xffff;
    std::vector<uint32_t> ahead, in_time;
    begin(enabled);
    for (const Access& each : drawn)
      if (each.write)
        EXPECT_TRUE(write_early(each.offset, each.value, each.cycle));
      else
        ahead.push_back(read_ahead(each.offset, each.cycle));
    b.run(cycle + 1);
    ahead.push_back(get(data));
    begin(enabled);
    const uint64_t start = b.cycle();
    for (const Access& each : drawn) {
      if (start + each.cycle > b.cycle()) b.run(start + each.cycle - b.cycle());
      if (each.write)
        set(each.offset, each.value);
      else
        in_time.push_back(get(each.offset));
    }
    b.run(start + cycle + 1 - b.cycle());
    in_time.push_back(get(data));
    ASSERT_EQ(ahead, in_time) << round;
  }
}

TEST_F(GpioAhead, ADebuggerSeesThePinsOfItsTime) {
  begin(0xffff);
  set(dataout, 0x1234);
  EXPECT_EQ(gpio.peek(data), 0u) << "two cycles later";
  b.run(Gpio::synchroniser_cycles);
  EXPECT_EQ(gpio.peek(data), 0x1234u) << "nothing else looked";
}

TEST_F(GpioAhead, IsNotTakenWhereItWouldBeNoticed) {
  const uint64_t before = kit::guest_error_total();
  begin(0xffff);
  EXPECT_TRUE(write_early(dataout, 1, 7));
  EXPECT_FALSE(write_early(dataout, 0x10001, 7)) << "a reserved bit is reported";
  EXPECT_FALSE(write_early(outenclr, 1, 7));
  set(intenset, 1);
  EXPECT_FALSE(write_early(dataout, 2, 7)) << "a pin interrupts";
  set(intenclr, 1);
  EXPECT_TRUE(write_early(dataout, 3, 8));
  {
    const kit::Listening looks = gpio.outputs.listen([](uint16_t, uint16_t) {});
    EXPECT_FALSE(write_early(dataout, 4, 9)) << "somebody looks";
  }
  b.run(12);
  EXPECT_EQ(get(data), 3u);
  EXPECT_EQ(kit::guest_error_total(), before);
}

}  // namespace
}  // namespace capsoc::test
