// The UNPREDICTABLE cases of ARM DDI 0403: what is chosen (unpredictable.def), and that each is
// reported once. Both executors.
#include "armv7m/isa/unpredictable.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "armv7m/isa/decoder.h"
#include "bench.h"
#include "executors.h"

namespace capsoc::armv7m::test {
namespace {

class Choices : public ::testing::TestWithParam<Executor> {
 protected:
  Bench b;
  std::vector<std::string> told;  ///< name and address of each report

  void SetUp() override {
    choose(b.core, GetParam());
    b.core.listeners().unpredictable = [this](Unpredictable which, uint32_t address) {
      told.push_back(std::string(describe(which).name) + "@" +
                     std::to_string(address - Bench::program));
      EXPECT_EQ(b.core.reg(15), address) << "what else is said names the same instruction";
    };
  }
  /// Runs the code to its end with r0 to r12 holding 0x20000100, 0x20000110 and so on.
  void run(std::initializer_list<uint16_t> code) {
    b.start(code);
    const uint32_t end = Bench::program + 2 * static_cast<uint32_t>(code.size());
    b.code(end, {0xE7FE});
    for (unsigned n = 0; n < 13; ++n) b.core.set_reg(n, Bench::ram_base + 0x100 + 16 * n);
    b.core.run(b.core.cycles() + 100);
    EXPECT_EQ(b.core.reg(15), end);
    EXPECT_EQ(b.core.fault_count(), 0u);
  }
  static std::vector<std::string> once(const std::string& text) { return {text}; }
};

// "Once": a loop over one case is one report.
TEST_P(Choices, ACaseIsToldOnceHoweverOftenItIsMet) {
  b.start({0xEA41, 0x000F, 0xEA42, 0x000F, 0xE7FA});  // orr r0,r1,pc; orr r0,r2,pc; b .-8
  b.core.run(b.core.cycles() + 200);
  EXPECT_EQ(told, once("special_register@0"));
}
TEST_P(Choices, WhatIsSkippedByItsConditionIsNotTold) {
  run({0x2000, 0xBF18, 0xEA41, 0x000F});  // movs r0,#0; it ne; orrne r0,r1,pc
  EXPECT_TRUE(told.empty());
}
TEST_P(Choices, OrdinaryCodeIsNotToldOf) {
  // add.w r0,sp,#4; sub.w sp,sp,#8; ldr.w r1,[sp,#4]; mov.w r2,sp; cmp.w sp,#0; add.w sp,sp,#8
  run({0xF10D, 0x0004, 0xF1AD, 0x0D08, 0xF8DD, 0x1004, 0xEA4F, 0x020D, 0xF1BD, 0x0F00, 0xF10D,
       0x0D08});
  EXPECT_TRUE(told.empty());
}
TEST_P(Choices, AnItBlockAcrossTheEndOfAPageIsOrdinary) {
  b.start({0xE7FE});
  b.code(0x1FFC, {0x2000, 0xBF06, 0x3001, 0x3002, 0x3004, 0xE7FE});  // itte eq over 0x2000
  b.core.set_reg(15, 0x1FFC);
  b.core.run(b.core.cycles() + 30);
  EXPECT_EQ(b.core.reg(0), 3u);
  EXPECT_TRUE(told.empty());
}
// A5.1.2
TEST_P(Choices, TheProgramCounterReadsAsTheAddressPlusFour) {
  run({0xEA4F, 0x0000, 0xEA80, 0x000F, 0xEA80, 0x0001});  // mov.w; eor r0,r0,pc; eor r0,r0,r1
  EXPECT_EQ(b.core.reg(0), (0x20000100u ^ (Bench::program + 8)) ^ 0x20000110u);
  EXPECT_EQ(told, once("special_register@4"));
}
TEST_P(Choices, AResultForTheProgramCounterIsLost) {
  run({0xEA01, 0x0F02, 0x2007});  // and r15,r1,r2; movs r0,#7
  EXPECT_EQ(b.core.reg(0), 7u);
  EXPECT_EQ(told, once("special_register@0"));
}
// A5.1.1
TEST_P(Choices, ABitThatShouldBeZeroIsIgnored) {
  run({0xFA0F, 0xF0C1});  // sxth.w r0,r1 with bit 6 set
  EXPECT_EQ(b.core.reg(0), 0x110u);
  EXPECT_EQ(told, once("should_be_bits@0"));
}
// A7.7
TEST_P(Choices, AStoreThatUpdatesItsOwnBaseStoresTheOldOne) {
  run({0xF840, 0x0B04});  // str r0,[r0],#4
  EXPECT_EQ(b.peek(0x20000100), 0x20000100u);
  EXPECT_EQ(b.core.reg(0), 0x20000104u);
  EXPECT_EQ(told, once("written_back_base@0"));
}
TEST_P(Choices, ALoadThatUpdatesItsOwnBaseKeepsWhatItLoaded) {
  run({0x6041, 0xF850, 0x0F04});  // str r1,[r0,#4]; ldr r0,[r0,#4]!
  EXPECT_EQ(b.core.reg(0), 0x20000110u);
}
TEST_P(Choices, TheUpperHalfOfAProductStaysInACommonRegister) {
  run({0xFBA2, 0x0003, 0xFBA2, 0x1003, 0xFBA2, 0x4403});  // umull r0,r0; r1,r0; r4,r4 = r2*r3
  EXPECT_EQ(b.core.reg(4), static_cast<uint32_t>((0x20000120ull * 0x20000130) >> 32));
  EXPECT_EQ(told, once("same_destination@0"));
}
TEST_P(Choices, AnEmptyListTransfersNothingAndKeepsTheBase) {
  run({0xC000});  // stm r0!,{}
  EXPECT_EQ(b.core.reg(0), 0x20000100u);
  EXPECT_EQ(told, once("register_list@0"));
}
TEST_P(Choices, AFieldBeyondBit31EndsThere) {
  run({0xF3C1, 0x700F});  // ubfx r0,r1,#28,#16
  EXPECT_EQ(b.core.reg(0), 2u);
  EXPECT_EQ(told, once("bit_field@0"));
}
// A5.3.2
TEST_P(Choices, ARepeatedByteOfZeroIsZero) {
  run({0xF441, 0x3000});  // orr r0,r1,#0x20000: i:imm3 = 0b1011, rotated
  EXPECT_TRUE(told.empty());
  run({0xF041, 0x3000});  // the same with i = 0: repeated
  EXPECT_EQ(b.core.reg(0), 0x20000110u);
  EXPECT_EQ(told, once("repeated_zero@0"));
}
TEST_P(Choices, APlainZeroIsOrdinary) {
  run({0xF041, 0x0000, 0xF201, 0x1000});  // orr r0,r1,#0; addw r0,r1,#0x100
  EXPECT_TRUE(told.empty());
}
// A7.7.38
TEST_P(Choices, AConditionalBranchInAnItBlockObeysBoth) {
  run({0x2000, 0xBF0C, 0xD000, 0x2001, 0x3002, 0xBF00});  // ite eq; beq +4; movne; adds r0,#2
  EXPECT_EQ(told, once("inside_it_block@4"));
}
// B5.2.2
TEST_P(Choices, AnUnallocatedSpecialRegisterReadsAsZero) {
  run({0xF3EF, 0x800A});  // mrs r0, 10
  EXPECT_EQ(b.core.reg(0), 0u);
  EXPECT_EQ(told, once("special_name@0"));
}
// B1.4.1
TEST_P(Choices, TheStackPointerDropsItsTwoLowestBits) {
  run({0x3003, 0x4685});  // adds r0,#3; mov sp,r0
  EXPECT_EQ(b.core.reg(13), 0x20000100u);
  EXPECT_EQ(told, once("stack_pointer_bits@2"));
}
// A3.2.1
TEST_P(Choices, AnUnalignedAccessToADeviceIsMadeInPieces) {
  b.start({0x6001, 0xE7FE});  // str r1,[r0]
  std::vector<uint32_t> written;
  b.on_write = [&](uint32_t value) { written.push_back(value); };
  b.core.set_reg(0, 0x40000001);
  b.core.set_reg(1, 0x44332211);
  b.core.run(b.core.cycles() + 20);
  EXPECT_EQ(written, (std::vector<uint32_t>{0x11, 0x3322, 0x44}));
  EXPECT_EQ(told, once("device_unaligned@0"));
}
// A3.4.1
TEST_P(Choices, AStoreExclusiveToAnotherAddressStores) {
  run({0xE850, 0x4F00, 0xE841, 0x5300});  // ldrex r4,[r0]; strex r3,r5,[r1]
  EXPECT_EQ(b.core.reg(3), 0u);
  EXPECT_EQ(b.peek(0x20000110), 0x20000150u);
  EXPECT_EQ(told, once("exclusive_pair@4"));
}
// B3.1.1
TEST_P(Choices, AByteOfASystemRegisterIsAccessedAlone) {
  b.start({0x7001, 0x7082, 0xE7FE});  // strb r1,[r0]; strb r2,[r0,#2]: VTOR
  b.core.set_reg(0, 0xE000ED09);
  b.core.set_reg(1, 0x12);
  b.core.set_reg(2, 0x34);
  b.core.run(b.core.cycles() + 10);
  EXPECT_EQ(b.peek(0xE000ED08), 0x34001200u & 0x3FFFFF80u);
  EXPECT_EQ(told, once("register_size@0"));
}
TEST_P(Choices, ByteWritesOfPrioritiesAreOrdinary) {
  b.start({0x7001, 0xE7FE});
  b.core.set_reg(0, 0xE000E401);
  b.core.set_reg(1, 0x40);
  b.core.run(b.core.cycles() + 10);
  EXPECT_TRUE(told.empty());
}
// B3.5.8
TEST_P(Choices, AnMpuRegionBelow32BytesMatchesNothing) {
  b.start({0x6001, 0xE7FE});  // str r1,[r0]: RASR
  b.core.set_reg(0, 0xE000EDA0);
  b.core.set_reg(1, 3u << 24 | 3 << 1 | 1);  // 16 bytes
  b.core.run(b.core.cycles() + 10);
  EXPECT_EQ(told, once("mpu_size@0"));
}
// B3.5.7, B3.5.8
TEST_P(Choices, AnMpuRegionAbove7IsTakenModulo8) {
  b.start({0x6001, 0xE7FE});  // str r1,[r0]: RNR
  b.core.set_reg(0, 0xE000ED98);
  b.core.set_reg(1, 11);
  b.core.run(b.core.cycles() + 10);
  EXPECT_EQ(b.peek(0xE000ED98), 3u);
  EXPECT_EQ(told, once("mpu_number@0"));
}
TEST_P(Choices, TheRegionInRbarCountsOnlyIfItIsValid) {
  b.start({0x6001, 0x6002, 0xE7FE});  // str r1,[r0]; str r2,[r0]: RBAR
  b.core.set_reg(0, 0xE000ED9C);
  b.core.set_reg(1, 0x20000000 | 9);         // VALID 0: not a number
  b.core.set_reg(2, 0x20000000 | 0x10 | 9);  // VALID 1
  b.core.run(b.core.cycles() + 10);
  EXPECT_EQ(b.peek(0xE000ED98), 1u);
  EXPECT_EQ(told, once("mpu_number@2"));
}
// B3.5.8: a task's new base meets the size of the last one until RASR is written, too.
TEST_P(Choices, AnMpuRegionIsLookedAtWhenItIsComplete) {
  b.start(
      {0xC006, 0x3804, 0x6003, 0xE7FE});  // stm r0!,{r1,r2}; subs r0,#4; str r3,[r0]: RBAR, RASR
  b.core.set_reg(0, 0xE000ED9C);
  b.core.set_reg(1, 0x20000100);
  b.core.set_reg(2, 3u << 24 | 7 << 1 | 1);  // 256 bytes
  b.core.set_reg(3, 3u << 24 | 8 << 1 | 1);  // 512 bytes: misplaced
  b.core.run(b.core.cycles() + 20);
  EXPECT_EQ(told, once("mpu_base@4"));
}
TEST_P(Choices, AMisplacedBaseIsToldOfWhenTheMpuIsEnabled) {
  // str r1,[r0]; str r2,[r0,#4]; str r4,[r0]; str r3,[r0,#-8]: RBAR, RASR, RBAR, CTRL
  b.start({0x6001, 0x6042, 0x6004, 0xF840, 0x3C08, 0xE7FE});
  b.core.set_reg(0, 0xE000ED9C);
  b.core.set_reg(1, 0x20000100);
  b.core.set_reg(2, 3u << 24 | 7 << 1 | 1);
  b.core.set_reg(3, 5);
  b.core.set_reg(4, 0x20000120);
  b.core.run(b.core.cycles() + 20);
  EXPECT_EQ(told, once("mpu_base@6"));
}
// B1.5.8
TEST_P(Choices, AnExceptionReturnToAnOddAddressDropsTheBit) {
  b.code(0x4000 + 32 * 11,
         {0x9806, 0x3001, 0x9006, 0x4770});  // SVCall: pc on the frame |= 1; bx lr
  b.start({0xDF00, 0x2007, 0xE7FE});         // svc; movs r0,#7
  b.core.run(b.core.cycles() + 60);
  EXPECT_EQ(b.core.reg(0), 7u);
  EXPECT_EQ(b.core.fault_count(), 0u);
  EXPECT_EQ(told, once("return_address@" + std::to_string(0x4000 + 32 * 11 + 6 - Bench::program)));
}
TEST_P(Choices, AnExcReturnWithZerosInItsMiddleRaisesInvpc) {
  b.code(0x4000 + 32 * 11, {0x4700});  // SVCall: bx r0
  b.start({0xDF00, 0xE7FE});
  b.core.set_reg(0, 0xF0000009);
  b.core.run(b.core.cycles() + 40);
  EXPECT_EQ(b.core.first_fault().cfsr, 1u << 18);
  EXPECT_EQ(told, once("exc_return@" + std::to_string(0x4000 + 32 * 11 - Bench::program)));
}
// What a device says of an access names the instruction, not the block that it is in.
TEST_P(Choices, DuringAnAccessToADeviceThePcIsTheInstructions) {
  b.start({0x3101, 0x3101, 0x6001, 0x6842, 0x3101, 0x6081, 0xE7FE});  // str, ldr, str
  std::vector<uint32_t> pcs;
  b.on_write = [&](uint32_t) { pcs.push_back(b.core.reg(15) - Bench::program); };
  b.core.set_reg(0, 0x40000000);
  b.core.run(b.core.cycles() + 60);
  EXPECT_EQ(pcs, (std::vector<uint32_t>{4, 10}));
}

INSTANTIATE_TEST_SUITE_P(Both, Choices, ::testing::ValuesIn(all_executors), executor_name);

TEST(Unpredictable, EveryCaseHasASectionAReasonAndAChoice) {
  for (unsigned i = 0; i < static_cast<unsigned>(Unpredictable::count); ++i) {
    const UnpredictableCase& c = describe(static_cast<Unpredictable>(i));
    EXPECT_TRUE(std::string(c.section).find_first_of("AB") == 0) << c.name;
    EXPECT_FALSE(std::string(c.what).empty() || std::string(c.choice).empty()) << c.name;
  }
}

TEST(Unpredictable, TheDocumentationHasTheTable) {
  std::ifstream file(CAPSOC_PROCESSOR_PAGE);
  const std::string page((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  for (unsigned i = 0; i < static_cast<unsigned>(Unpredictable::count); ++i) {
    const UnpredictableCase& c = describe(static_cast<Unpredictable>(i));
    const std::string row =
        std::string("| ") + c.name + " | " + c.section + " | " + c.what + " | " + c.choice + " |\n";
    EXPECT_NE(page.find(row), std::string::npos) << row;
  }
}

}  // namespace
}  // namespace capsoc::armv7m::test
