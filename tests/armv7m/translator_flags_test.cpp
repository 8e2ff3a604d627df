// Flags that translated code does not compute where they are set. Against stepping.
#include <gtest/gtest.h>

#include "translated.h"

namespace capsoc::armv7m::test {

/// The registers that a block's last flags are made from are written by the next one before it
/// faults; only then does that one set flags.
TEST(Flags, LeftToTheNextBlockAreFromBeforeItWroteTheirRegisters) {
  const Outcome outcome = agreed([](Bench& b) {
    shorten_ram(b);
    // add.w r1,r1,#4; ldr r3,[r1]; cmp r1,r5; cmp r1,r2; bne .-10: the last comparison before the
    // load that faults is with the address of the fault
    b.start({0xF101, 0x0104, 0x680B, 0x42A9, 0x4291, 0xD1F9});
    b.core.set_reg(1, end_of_ram - 40);
    b.core.set_reg(2, end_of_ram);
    b.core.set_reg(13, stack_in_short_ram);
  });
  ASSERT_GT(outcome.faults, 0u);
  EXPECT_EQ(stacked_flags(outcome), 0b1000u) << "lower";
}

/// ... and what they are made from was put aside, and the next block puts something aside as well.
TEST(Flags, LeftToTheNextBlockAreNotMadeFromWhatThatOnePutsAside) {
  const Outcome outcome = agreed([](Bench& b) {
    shorten_ram(b);
    // movs r0,r5; add.w r0,r0,#1; add.w r6,r6,#4; ldr r3,[r6]; cmp r0,r5; ldr r3,[r6];
    // cmp.w r1,r4,lsl #1; b .-20
    b.start(
        {0x0028, 0xF100, 0x0001, 0xF106, 0x0604, 0x6833, 0x42A8, 0x6833, 0xEBB1, 0x0F44, 0xE7F4});
    b.core.set_reg(1, 10);
    b.core.set_reg(4, 1);
    b.core.set_reg(5, 0x7000'0000);
    b.core.set_reg(6, end_of_ram - 40);
    b.core.set_reg(13, stack_in_short_ram);
  });
  ASSERT_GT(outcome.faults, 0u);
  EXPECT_EQ(stacked_flags(outcome), 0b0010u) << "C of the comparison before the branch";
}

/// ... and that one has set its own flags when it returns to a third that sets none.
TEST(Flags, LeftToTheNextBlockEndWithItsReturn) {
  const Outcome outcome = agreed([](Bench& b) {
    shorten_ram(b);
    // cmp r0,r1; bl f; add.w r6,r6,#4; ldr r4,[r6]; b .-12;  f: cmp r2,r3; bx lr
    b.start({0x4288, 0xF000, 0xF804, 0xF106, 0x0604, 0x6834, 0xE7F8, 0x429A, 0x4770});
    b.core.set_reg(0, 5);
    b.core.set_reg(1, 5);
    b.core.set_reg(2, 1);
    b.core.set_reg(3, 2);
    b.core.set_reg(6, end_of_ram - 40);
    b.core.set_reg(13, stack_in_short_ram);
  });
  ASSERT_GT(outcome.faults, 0u);
  EXPECT_EQ(stacked_flags(outcome), 0b1000u) << "lower, as the function found";
}

/// A maximum and a minimum under IT, whose moves write what the comparison was of.
TEST(Flags, OfAComparisonSurviveConditionalMovesOfItsRegisters) {
  agreed([](Bench& b) {
    // cmp r0,r1; itet lt; movlt r0,r1; movge r1,r0; addlt r0,#3; eors r1,r2; adds r2,#77; b .-14
    b.start({0x4288, 0xBFB6, 0x4608, 0x4601, 0x3003, 0x4051, 0x324D, 0xE7F7});
    b.core.set_reg(0, 0x7FFF'FFF0);
    b.core.set_reg(1, 0x8000'0010);
    b.core.set_reg(2, 0x5A5A'5A5A);
  });
}

/// A fault in between stacks flags that no instruction reads.
TEST(Flags, AreStackedByADivisionByZeroThatIsAFault) {
  const Outcome outcome = agreed([](Bench& b) {
    // cmp r0,r1; sdiv r2,r3,r4; cmp r5,r6; b
    b.start({0x4288, 0xFB93, 0xF2F4, 0x42B5, 0xE7FA});
    const uint32_t divide_by_zero_traps = 1u << 4;
    b.core.debug_write(0xE000ED14, &divide_by_zero_traps, 4);
    for (const unsigned n : {0u, 1u, 4u, 6u}) b.core.set_reg(n, 5);  // equal, and then lower
    b.core.run(60);
    b.core.set_reg(4, 0);
  });
  EXPECT_GT(outcome.faults, 0u);
}

TEST(Flags, GoFromOneAdditionWithCarryToTheNextThoughTheBlockIsCutBetweenThem) {
  constexpr unsigned divisions = 17;  // with them a block has nearly the most cycles it may have
  for (unsigned loads = 0; loads <= 5; ++loads) {
    SCOPED_TRACE(loads);
    agreed([loads](Bench& b) {
      uint32_t at = Bench::program;
      b.start({});
      const auto put_code = [&](unsigned times, std::initializer_list<uint16_t> code) {
        for (; times > 0; --times, at += 2 * static_cast<uint32_t>(code.size())) b.code(at, code);
      };
      put_code(divisions, {0xFBB5, 0xF4F6});  // udiv r4,r5,r6
      put_code(loads, {0x9C00});              // ldr r4,[sp]
      put_code(1, {0x1840});                  // adds r0,r0,r1
      put_code(8, {0x4152});                  // adcs r2,r2
      put_code(1, {static_cast<uint16_t>(0xE000u | ((Bench::program - (at + 4)) / 2 & 0x7FF))});
      b.core.set_reg(1, 0x8765'4321);
      b.core.set_reg(2, 1);
      b.core.set_reg(5, 0x7FFF'FFFF);
      b.core.set_reg(6, 3);
    });
  }
}

TEST(Flags, GoToASubtractionWithCarryThatIsNotTranslated) {
  // subs r0,r0,r1; sbcs r2,r2,r3; sbcs sp,r4,r5 (UNPREDICTABLE, so left to C++); mov r7,sp;
  // mov sp,r6; adds r0,r0,r7; b .-14
  const Outcome outcome = agreed([](Bench& b) {
    b.start({0x1A40, 0x419A, 0xEB74, 0x0D05, 0x466F, 0x46B5, 0x19C0, 0xE7F7});
    b.core.set_reg(1, 0x1234'5678);
    b.core.set_reg(3, 0x8000'0001);
    b.core.set_reg(4, 0x7777'0000);
    b.core.set_reg(5, 0x1111'0000);
    b.core.set_reg(6, Bench::stack);
  });
  EXPECT_EQ(outcome.faults, 0u);
}

/// Groups that are written without a jump, under every condition.
TEST(Flags, DecideOnGroupsOfArithmeticWhateverTheConditionIs) {
  for (unsigned condition = 0; condition < 14; ++condition) {
    SCOPED_TRACE(condition);
    agreed([condition](Bench& b) {
      // cmp r0,r1; ittte c: sub r0,r0,r1; mov r2,r3; orr.w r4,r4,r5,lsr #1; add r6,#5; then
      // adds r1,r1,r7; eors r0,r4; adds r3,#3; b
      const unsigned same = condition & 1;
      const unsigned mask = same << 3 | same << 2 | (same ^ 1) << 1 | 1;
      b.start({0x4288, static_cast<uint16_t>(0xBF00 | condition << 4 | mask), 0x1A40, 0x461A,
               0xEA44, 0x0455, 0x3605, 0x19C9, 0x4060, 0x3303, 0xE7F4});
      b.core.set_reg(0, 0x7FFF'FFF0);
      b.core.set_reg(1, 0x8000'0010);
      b.core.set_reg(4, 1);
      b.core.set_reg(5, 0x1234'5678);
      b.core.set_reg(7, 0x6543'2107);
    });
  }
}

TEST(Flags, AreReadBehindTheGroupThatTheirSubtractionDecidesOn) {
  agreed([](Bench& b) {
    // subs r0,r0,r1; sbcs r2,r2,r3; it hs; addhs r4,#1; adc.w r5,r5,r5; adds r3,r3,r1; b
    b.start({0x1A40, 0x419A, 0xBF28, 0x3401, 0xEB45, 0x0505, 0x185B, 0xE7F7});
    b.core.set_reg(1, 0x1234'5679);
    b.core.set_reg(3, 0x8765'4321);
  });
}

/// A carry is taken in the group that has written what it is made from.
TEST(Flags, OfAComparisonReachAnAdditionInTheSameGroup) {
  agreed([](Bench& b) {
    // cmp r0,r1; itt ne; mulne r0,r2; adcne r3,r4; cmp r3,r4; adds r2,#77; adds r1,#13; b .-14
    b.start({0x4288, 0xBF1C, 0x4350, 0x4163, 0x42A3, 0x324D, 0x310D, 0xE7F7});
    b.core.set_reg(0, 0x7FFF'FFF0);
    b.core.set_reg(1, 0x1234'5679);
    b.core.set_reg(2, 0x8765'4321);
    b.core.set_reg(4, 3);
  });
}

/// ... and by a fault in such a group.
TEST(Flags, AreStackedByAFaultInTheGroupThatTheyDecideOn) {
  const Outcome outcome = agreed([](Bench& b) {
    shorten_ram(b);
    // adds r6,#4; mov r0,r7; cmp r0,r1; itt ne; addne r0,#1; ldrne r2,[r6]; cmp r3,r4; b
    b.start({0x3604, 0x4638, 0x4288, 0xBF1C, 0x3001, 0x6832, 0x42A3, 0xE7F7});
    b.core.set_reg(1, 5);
    b.core.set_reg(7, 4);
    b.core.set_reg(3, 0);
    b.core.set_reg(4, 0);
    b.core.set_reg(6, end_of_ram - 40);
    b.core.set_reg(13, stack_in_short_ram);
  });
  ASSERT_GT(outcome.faults, 0u);
  EXPECT_EQ(stacked_flags(outcome), 0b1000u) << "lower";
}

/// A shift's carry goes to RRX while V, from before it, is computed because RRX writes its operand.
TEST(Flags, OfAComparisonAreComputedBesideACarryOnItsWay) {
  agreed([](Bench& b) {
    // cmp r2,r4; lsls r3,r3,#1; mov.w r2,r2,rrx; lsls r5,r5,#1; it vs; addvs r6,#1;
    // add.w r3,r3,r2; add.w r5,r5,r3; b
    b.start({0x42A2, 0x005B, 0xEA4F, 0x0232, 0x006D, 0xBF68, 0x3601, 0xEB03, 0x0302, 0xEB05, 0x0503,
             0xE7F3});
    b.core.set_reg(2, 0x8000'0001);
    b.core.set_reg(3, 0xC0DE'1234);
    b.core.set_reg(4, 0x1234'5678);
    b.core.set_reg(5, 0x0BAD'CAFE);
  });
}

}  // namespace capsoc::armv7m::test
