#include <gtest/gtest.h>

#include <string>

#include "armv7m/isa/decoder.h"
#include "bench.h"
#include "executors.h"

namespace capsoc::armv7m::test {

// A7.3.2
TEST(Instructions, ItBlockExecutesThenAndSkipsElse) {
  Bench b;
  // movs r0,#1; cmp r0,#1; ite eq; moveq r1,#2; movne r1,#3; b .
  b.start({0x2001, 0x2801, 0xBF0C, 0x2102, 0x2103, 0xE7FE});
  b.core.run(20);
  EXPECT_EQ(b.core.reg(1), 2u);
}

// B1.4.1
TEST(Instructions, StackPointerKeepsItsLowBitsZero) {
  Bench b;
  b.start({0x2003, 0x4685, 0xE7FE});  // movs r0,#3; mov sp,r0
  b.core.run(4);
  EXPECT_EQ(b.core.reg(13), 0u);
}

// TRM, 3.7
TEST(Instructions, BitBandAliasSetsOneBitAndReadsOneBit) {
  Bench b;
  // movs r1,#1; str r1,[r0]; ldr r2,[r0]; b .
  b.start({0x2101, 0x6001, 0x6802, 0xE7FE});
  b.core.set_reg(0, 0x22000000 + 0x100 * 32 + 5 * 4);
  b.core.run(12);
  EXPECT_EQ(b.ram[0x100], 0x20);
  EXPECT_EQ(b.core.reg(2), 1u);
}

// A3.2.1
TEST(Instructions, UnalignedWordLoadsWorkAndUnalignedDoublesFault) {
  Bench b;
  b.ram[1] = 0x11;
  b.ram[4] = 0x44;
  b.start({0x6801, 0xE9D0, 0x2300, 0xE7FE});  // ldr r1,[r0]; ldrd r2,r3,[r0]
  b.core.set_reg(0, Bench::ram_base + 1);
  b.core.run(3);
  EXPECT_EQ(b.core.reg(1), 0x44000011u);
  b.core.run(20);
  EXPECT_EQ(b.core.last_fault().cfsr, 1u << 24);
}

// A5.3
TEST(Instructions, DspAndUnallocatedEncodingsAreUndefined) {
  EXPECT_EQ(decode(0, 0xFA80, 0xF000, 0).operation, Operation::undefined);  // sadd8
  EXPECT_EQ(decode(0, 0xDE00, 0, 0).operation, Operation::undefined);
}

// A5.3.18: what names a coprocessor is refused by it, the lines that none has included; 111x1111 is
// no coprocessor instruction of ARMv7-M (in ARMv7-A it is Advanced SIMD).
TEST(Instructions, CoprocessorEncodingsEndWhereThoseOfAdvancedSimdBegin) {
  for (const uint32_t high : {0xEC00U, 0xED00U, 0xEE00U, 0xFC00U, 0xFD00U, 0xFE00U})
    for (const uint32_t low : {0x00U, 0x10U, 0x90U, 0xFFU})
      EXPECT_EQ(decode(0, static_cast<uint16_t>(high | low), 0x0A10, 0).operation,
                Operation::coprocessor)
          << std::hex << (high | low);
  for (uint32_t low = 0; low < 0x100; ++low)
    for (const uint32_t high : {0xEF00U, 0xFF00U})
      EXPECT_EQ(decode(0, static_cast<uint16_t>(high | low), 0x0A10, 0).operation,
                Operation::undefined)
          << std::hex << (high | low);
}

// The architecture asks for an ISB; none is needed here.
TEST(Instructions, CodeThatOverwritesItselfRunsTheNewCode) {
  Bench b;
  b.start({0x4700});  // bx r0, into RAM
  // strh r1,[r2]; nop; movs r3,#1 (replaced by movs r3,#2); b .
  const uint16_t program[] = {0x8011, 0xBF00, 0x2301, 0xE7FE};
  std::memcpy(b.ram.data(), program, sizeof(program));
  b.core.set_reg(0, Bench::ram_base | 1);
  b.core.set_reg(1, 0x2302);
  b.core.set_reg(2, Bench::ram_base + 4);
  b.core.run(30);
  EXPECT_EQ(b.core.reg(3), 2u);
}

// A3.4.1
TEST(Instructions, AStoreExclusiveSucceedsOnceAfterItsLoad) {
  Bench b;
  // ldrex r1,[r0]; strex r2,r3,[r0]; strex r4,r3,[r0]; b .
  b.start({0xE850, 0x1F00, 0xE840, 0x3200, 0xE840, 0x3400, 0xE7FE});
  b.core.set_reg(0, Bench::ram_base);
  b.core.set_reg(3, 77);
  b.core.run(12);
  EXPECT_EQ(b.core.reg(2), 0u);
  EXPECT_EQ(b.core.reg(4), 1u);
  EXPECT_EQ(b.ram[0], 77);
}

TEST(Instructions, CyclesFollowTheTable) {
  Bench b;
  b.start({0x2001, 0x6811, 0xE7FE});  // movs 1; ldr 2; b 2
  b.core.set_reg(2, Bench::ram_base);
  b.core.run(1);
  EXPECT_EQ(b.core.cycles(), 1u);
  b.core.run(2);
  EXPECT_EQ(b.core.cycles(), 3u);
  b.core.run(4);
  EXPECT_EQ(b.core.cycles(), 5u);
}

TEST(Instructions, ADeviceAccessSeesItsExactCycle) {
  for (Executor executor : all_executors) {
    Bench b;
    uint64_t seen = 0;
    b.on_write = [&](uint32_t) { seen = b.core.cycles(); };
    b.start({0x2001, 0x6811, 0x6018, 0xE7FE});  // movs; ldr r1,[r2]; str r0,[r3]
    choose(b.core, executor);
    b.core.set_reg(2, Bench::ram_base);
    b.core.set_reg(3, 0x40000000);
    b.core.run(20);
    EXPECT_EQ(seen, 3u);
  }
}

// A7.7.44: an offset that looks like a register's number is an offset still.
TEST(Instructions, ALiteralLoadGoesBackwardsByFewBytes) {
  Bench b;
  b.start({0x1234, 0x5678, 0xF85F, 0x1008, 0xF81F, 0x200A, 0xE7FE});
  b.core.set_reg(15, Bench::program + 4);  // ldr r1,[pc,#-8]; ldrb r2,[pc,#-10]
  b.core.run(12);
  EXPECT_EQ(b.core.reg(1), 0x56781234u);
  EXPECT_EQ(b.core.reg(2), 0x78u);
}

TEST(Instructions, TheDisassemblerNamesOperands) {
  EXPECT_EQ(disassemble(decode(0, 0x1888, 0, 0)), "adds r0, r1, r2");
  EXPECT_EQ(disassemble(decode(0, 0xB510, 0, 0)), "push {r4, lr}");
}

// C1.7.
TEST(Instructions, AnEnabledStimulusPortIsReadyAndPassesOnWhatIsWritten) {
  Bench b;
  std::string text;
  b.core.listeners().stimulus = [&](unsigned port, uint32_t value, unsigned size) {
    text += std::to_string(port) + ":" + std::to_string(size) + ":" + std::to_string(value) + " ";
  };
  // strb r1,[r0,#4]; ldr r2,[r0,#4]; unlock; TER = 2; TCR = 1; ldr r3; strb; strh
  b.start({0x7101, 0x6842, 0x6025, 0x6037, 0xF8C6, 0x8080, 0x6843, 0x7101, 0x8081, 0xE7FE});
  b.core.set_reg(0, 0xE0000000);
  b.core.set_reg(1, 'A');
  b.core.set_reg(4, 0xE0000FB0);
  b.core.set_reg(5, 0xC5ACCE55);
  b.core.set_reg(6, 0xE0000E00);
  b.core.set_reg(7, 2);
  b.core.set_reg(8, 1);
  const uint32_t trcena = 1u << 24;
  b.core.run(6);  // not enabled yet: not ready, dropped
  EXPECT_EQ(b.core.reg(2), 0u);
  b.core.set_reg(9, 0xE000EDFC);
  b.core.set_reg(10, trcena);
  b.code(0x3000, {0xF8C9, 0xA000, 0x4758});  // str r10,[r9]; bx r11
  b.core.set_reg(11, b.core.reg(15) | 1);
  b.core.set_reg(15, 0x3000);
  b.core.run(60);
  EXPECT_EQ(b.core.reg(3), 1u);
  EXPECT_EQ(text, "1:1:65 1:2:65 ");
}

}  // namespace capsoc::armv7m::test
