#include <gtest/gtest.h>

#include "bench.h"
#include "cortex_m3/decoder.h"

namespace capsoc::cortex_m3::test {

TEST(Instructions, ItBlockExecutesThenAndSkipsElse) {
  Bench b;
  // movs r0,#1; cmp r0,#1; ite eq; moveq r1,#2; movne r1,#3; b .
  b.start({0x2001, 0x2801, 0xBF0C, 0x2102, 0x2103, 0xE7FE});
  b.core.run(20);
  EXPECT_EQ(b.core.reg(1), 2u);
}

TEST(Instructions, StackPointerKeepsItsLowBitsZero) {
  Bench b;
  b.start({0x2003, 0x4685, 0xE7FE});  // movs r0,#3; mov sp,r0
  b.core.run(4);
  EXPECT_EQ(b.core.reg(13), 0u);
}

TEST(Instructions, BitBandAliasSetsOneBitAndReadsOneBit) {
  Bench b;
  // movs r1,#1; str r1,[r0]; ldr r2,[r0]; b .
  b.start({0x2101, 0x6001, 0x6802, 0xE7FE});
  b.core.set_reg(0, 0x22000000 + 0x100 * 32 + 5 * 4);
  b.core.run(12);
  EXPECT_EQ(b.ram[0x100], 0x20);
  EXPECT_EQ(b.core.reg(2), 1u);
}

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

TEST(Instructions, DspAndUnallocatedEncodingsAreUndefined) {
  EXPECT_EQ(decode(0, 0xFA80, 0xF000, 0).operation, Operation::undefined);  // sadd8
  EXPECT_EQ(decode(0, 0xDE00, 0, 0).operation, Operation::undefined);
  EXPECT_EQ(decode(0, 0xEE00, 0x0A10, 0).operation, Operation::coprocessor);
}

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
  b.start({0x2001, 0x6811, 0xE7FE});  // movs 1; ldr 2; b 3
  b.core.set_reg(2, Bench::ram_base);
  b.core.run(1);
  EXPECT_EQ(b.core.cycles(), 1u);
  b.core.run(2);
  EXPECT_EQ(b.core.cycles(), 3u);
  b.core.run(4);
  EXPECT_EQ(b.core.cycles(), 6u);
}

TEST(Instructions, ADeviceAccessSeesItsExactCycle) {
  for (Executor executor : {Executor::stepping, Executor::blocks}) {
    Bench b;
    uint64_t seen = 0;
    b.on_write = [&](uint32_t) { seen = b.core.cycles(); };
    b.start({0x2001, 0x6811, 0x6018, 0xE7FE});  // movs; ldr r1,[r2]; str r0,[r3]
    b.core.set_executor(executor);
    b.core.set_reg(2, Bench::ram_base);
    b.core.set_reg(3, 0x40000000);
    b.core.run(20);
    EXPECT_EQ(seen, 3u);
  }
}

TEST(Instructions, TheDisassemblerNamesOperands) {
  EXPECT_EQ(disassemble(decode(0, 0x1888, 0, 0)), "adds r0, r1, r2");
  EXPECT_EQ(disassemble(decode(0, 0xB510, 0, 0)), "push {r4, lr}");
}

}  // namespace capsoc::cortex_m3::test
