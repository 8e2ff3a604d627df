// Bus faults of buffered stores, and interrupted load and store multiples: ARM DDI 0403, B1.4.2,
// B1.5.14 and B3.2.15, and the Cortex-M3 TRM on ACTLR. Both executors. qemu-system-arm reports
// every bus fault as precise, so programs that look at it differ there.
#include <gtest/gtest.h>

#include "bench.h"
#include "executors.h"

namespace capsoc::armv7m::test {
namespace {

constexpr uint32_t nowhere = 0x60000000;
constexpr uint32_t actlr = 0xE000E008, disdefwbuf = 2, dismcycint = 1;
constexpr uint32_t ccr = 0xE000ED14, bfhfnmign = 1u << 8;
constexpr uint32_t shcsr = 0xE000ED24, busfaultena = 1u << 17;
constexpr uint32_t cfsr = 0xE000ED28, preciserr = 1u << 9, impreciserr = 1u << 10,
                   bfarvalid = 1u << 15;

class BusFaults : public ::testing::TestWithParam<Executor> {
 protected:
  Bench b;
  void SetUp() override { choose(b.core, GetParam()); }

  void write(uint32_t address, uint32_t value) { b.core.debug_write(address, &value, 4); }
  /// str r1,[r0]; adds r2,#1; adds r2,#1; b .
  void start(uint32_t address = nowhere) {
    b.start({0x6001, 0x3201, 0x3201, 0xE7FE});
    b.core.set_reg(0, address);
    write(shcsr, busfaultena);
  }
  unsigned run(unsigned cycles = 40) {
    const uint64_t end = b.core.cycles() + cycles;
    while (b.core.cycles() < end && (b.core.state().xpsr() & 0x1FF) == 0)
      b.core.run(b.core.cycles() + 1);
    return b.core.state().xpsr() & 0x1FF;
  }
  uint32_t stacked_pc() { return b.peek(b.core.state().msp() + 24); }
};

TEST_P(BusFaults, AStoreThroughTheWriteBufferFailsBehindItselfAndKeepsNoAddress) {
  start();
  EXPECT_EQ(run(), 5u);
  EXPECT_EQ(b.peek(cfsr), impreciserr);
  EXPECT_EQ(stacked_pc(), Bench::program + 2);
}
TEST_P(BusFaults, ALoadFailsPrecisely) {
  start();
  b.code(Bench::program, {0x6801});  // ldr r1,[r0]
  EXPECT_EQ(run(), 5u);
  EXPECT_EQ(b.peek(cfsr), preciserr | bfarvalid);
  EXPECT_EQ(stacked_pc(), Bench::program);
}
TEST_P(BusFaults, BfhfnmignLetsFaultmaskProbeTheBus) {  // B3.2.8
  start();
  b.code(Bench::program, {0x6801});  // ldr r1,[r0]
  b.core.set_reg(1, 5);
  b.core.edit().set_faultmask(true);
  write(ccr, bfhfnmign);
  EXPECT_EQ(run(20), 0u);
  EXPECT_EQ(b.core.reg(1), 0u);
  EXPECT_EQ(b.core.reg(2), 2u) << "the program goes on";
  EXPECT_EQ(b.peek(cfsr), preciserr | bfarvalid);
  EXPECT_EQ(b.peek(0xE000ED38), nowhere);
}
TEST_P(BusFaults, WithoutFaultmaskBfhfnmignIgnoresNothing) {
  start();
  b.code(Bench::program, {0x6801});
  write(ccr, bfhfnmign);
  EXPECT_EQ(run(), 5u);
}
TEST_P(BusFaults, WithoutBfhfnmignAFaultUnderFaultmaskLocksUp) {
  start();
  b.code(Bench::program, {0x6801});
  b.core.edit().set_faultmask(true);
  b.core.run(b.core.cycles() + 1);
  EXPECT_TRUE(b.core.locked_up());
}
TEST_P(BusFaults, DisdefwbufMakesStoresPrecise) {
  start();
  write(actlr, disdefwbuf);
  EXPECT_EQ(run(), 5u);
  EXPECT_EQ(b.peek(cfsr), preciserr | bfarvalid);
  EXPECT_EQ(b.peek(0xE000ED38), nowhere);
  EXPECT_EQ(stacked_pc(), Bench::program);
}
TEST_P(BusFaults, AnImpreciseFaultWaitsForItsPriority) {
  start();
  b.core.edit().set_primask(true);
  EXPECT_EQ(run(20), 0u);
  EXPECT_EQ(b.core.reg(2), 2u);
  EXPECT_EQ(b.peek(shcsr) >> 14 & 1, 1u) << "BUSFAULTPENDED";
  b.core.edit().set_primask(false);
  EXPECT_EQ(run(), 5u);
}
TEST_P(BusFaults, ADisabledImpreciseFaultIsAHardFault) {
  start();
  write(shcsr, 0);
  EXPECT_EQ(run(), 3u);
  EXPECT_EQ(b.peek(0xE000ED2C), 1u << 30);
  EXPECT_EQ(b.peek(cfsr), impreciserr);
}
TEST_P(BusFaults, AStoreExclusiveWaitsForItsAnswer) {
  b.start({0xE850, 0x1F00, 0xE847, 0x2300, 0xE7FE});  // ldrex r1,[r0]; strex r3,r2,[r7]
  b.core.set_reg(0, Bench::ram_base);
  b.core.set_reg(7, nowhere);
  write(shcsr, busfaultena);
  EXPECT_EQ(run(), 5u);
  EXPECT_EQ(b.peek(cfsr), preciserr | bfarvalid);
}
TEST_P(BusFaults, AStoreToAStronglyOrderedRegionIsNotBuffered) {
  for (const bool device : {false, true}) {
    start();
    write(0xE000ED98, 0);
    write(0xE000ED9C, nowhere);
    write(0xE000EDA0, 3u << 24 | (device ? 1u << 16 : 0) | 19 << 1 | 1);  // B for a device
    write(0xE000ED94, 5);
    EXPECT_EQ(run(), 5u);
    EXPECT_EQ(b.peek(cfsr), device ? impreciserr : preciserr | bfarvalid);
  }
}
TEST_P(BusFaults, AllOfAStoreMultipleIsTriedBeforeItFails) {
  b.start({0xC006, 0xE7FE});  // stm r0!,{r1,r2}
  b.core.set_reg(0, 0x40000FFC);
  b.core.set_reg(1, 77);
  write(shcsr, busfaultena);
  EXPECT_EQ(run(), 5u);
  EXPECT_EQ(b.device, 77u);
  EXPECT_EQ(b.core.reg(0), 0x40001004u);
}

// B1.4.2 leaves it open whether an interrupt abandons, continues or waits for a multiple transfer.
TEST_P(BusFaults, AnInterruptWaitsForAMultipleTransferWithAndWithoutDismcycint) {
  for (const uint32_t setting : {0u, dismcycint}) {
    b.start({0xC006, 0xE7FE});  // stm r0!,{r1,r2}
    write(actlr, setting);
    write(0xE000E100, 1);
    b.core.set_reg(0, 0x40000000);
    b.on_write = [this](uint32_t) {
      b.core.set_interrupt(0, true);
      b.core.set_interrupt(0, false);
    };
    EXPECT_EQ(run(), 16u);
    EXPECT_EQ(stacked_pc(), Bench::program + 2);
    EXPECT_EQ(b.peek(b.core.state().msp() + 28) & 0x0600FC00u, 0u) << "ICI";
  }
}
TEST_P(BusFaults, AContinuationBeforeAnotherInstructionRaisesInvstate) {
  b.start({0xBF00, 0xE7FE});
  b.core.edit().set_xpsr(1u << 24 | 3u << 12);  // ICI says r3
  EXPECT_EQ(run(), 3u);
  EXPECT_EQ(b.peek(cfsr), 1u << 17);
}
TEST_P(BusFaults, AContinuedMultipleTransferStartsOver) {
  b.start({0xC806, 0xE7FE});  // ldm r0!,{r1,r2}
  b.core.set_reg(0, Bench::ram_base);
  b.ram[0] = 5;
  b.core.edit().set_xpsr(1u << 24 | 2u << 12);
  EXPECT_EQ(run(10), 0u);
  EXPECT_EQ(b.core.reg(1), 5u);
}

INSTANTIATE_TEST_SUITE_P(Both, BusFaults, ::testing::ValuesIn(all_executors), executor_name);

}  // namespace
}  // namespace capsoc::armv7m::test
