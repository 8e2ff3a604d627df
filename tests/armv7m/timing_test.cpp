// The examples and sentences of the Cortex-M3 TRM (ARM DDI 0337I), 3.3 and 5, in cycles; each with
// both executors.
#include <gtest/gtest.h>

#include "bench.h"
#include "executors.h"

namespace capsoc::armv7m::test {
namespace {

class Timing : public ::testing::TestWithParam<Executor> {
 protected:
  /// Cycles until the program counter reaches the end of the code.
  uint64_t cycles_of(std::initializer_list<uint16_t> code, uint32_t r4 = 0, uint32_t r5 = 0) {
    Bench b;
    choose(b.core, GetParam());
    b.start(code);
    b.code(Bench::program + 2 * static_cast<uint32_t>(code.size()), {0xE7FE});
    for (unsigned n = 0; n < 4; ++n) b.core.set_reg(n, Bench::ram_base + 64 * n);
    b.core.set_reg(4, r4);
    b.core.set_reg(5, r5);
    const uint32_t end = Bench::program + 2 * static_cast<uint32_t>(code.size());
    b.core.run(b.core.cycles() + 1);
    while (b.core.reg(15) != end && b.core.cycles() < 200) b.core.run(b.core.cycles() + 1);
    EXPECT_EQ(b.core.fault_count(), 0u);
    return b.core.cycles();
  }
};

TEST_P(Timing, TwoLoadsAreNormallyThreeCycles) {
  EXPECT_EQ(cycles_of({0x6808, 0x6811}), 3u);  // ldr r0,[r1]; ldr r1,[r2]
}
TEST_P(Timing, ALoadByRegisterAndAStoreByImmediateAreThreeCycles) {
  EXPECT_EQ(cycles_of({0x590E, 0x615E}), 3u);  // ldr r6,[r1,r4]; str r6,[r3,#20]
}
TEST_P(Timing, ALoadAndAStoreByRegisterAreThreeCycles) {
  EXPECT_EQ(cycles_of({0x590E, 0x511E}), 3u);  // ldr r6,[r1,r4]; str r6,[r3,r4]
}
TEST_P(Timing, ThreeLoadsAreNormallyFourCycles) {
  EXPECT_EQ(cycles_of({0x590E, 0x6811, 0x685A}), 4u);
}
TEST_P(Timing, ALoadWhoseAddressIsLoadedDoesNotPipeline) {
  Bench b;
  choose(b.core, GetParam());
  b.start({0x6809, 0x680A, 0xE7FE});  // ldr r1,[r1]; ldr r2,[r1]
  b.core.set_reg(1, Bench::ram_base);
  const uint32_t pointer = Bench::ram_base + 8;
  std::memcpy(b.ram.data(), &pointer, 4);
  b.core.run(3);
  EXPECT_EQ(b.core.cycles(), 4u);
}
TEST_P(Timing, NothingPipelinesBehindAStore) {
  EXPECT_EQ(cycles_of({0x6008, 0x6811}), 3u);  // str 1; ldr 2
}
TEST_P(Timing, AnAddressThatWasJustComputedStallsOneCycle) {
  EXPECT_EQ(cycles_of({0x3104, 0x6808}), 4u);          // adds r1,#4; ldr r0,[r1]
  EXPECT_EQ(cycles_of({0x3104, 0xBF00, 0x6808}), 4u);  // with a nop between: 1 + 1 + 2
  EXPECT_EQ(cycles_of({0x3204, 0x6808}), 3u);          // another register
}
TEST_P(Timing, ABaseUpdateDoesNotPipeline) {
  EXPECT_EQ(cycles_of({0xF851, 0x0B04, 0x6816}), 4u);  // ldr r0,[r1],#4; ldr r6,[r2]
}
TEST_P(Timing, LoadDoubleTakesThreeCyclesAndDoesNotPipeline) {
  EXPECT_EQ(cycles_of({0xE9D1, 0x6700, 0x6810}), 5u);
}
TEST_P(Timing, LoadMultipleTakesOneCycleAndOneARegister) {
  EXPECT_EQ(cycles_of({0xE891, 0x00C1}), 4u);  // ldm r1,{r0,r6,r7}
}
TEST_P(Timing, LongMultiplicationsTakeThreeToFiveAndFourToSeven) {
  const std::initializer_list<uint16_t> umull = {0xFBA4, 0x6705}, smlal = {0xFBC4, 0x6705};
  EXPECT_EQ(cycles_of(umull, 2, 3), 3u);
  EXPECT_EQ(cycles_of(umull, 0x10000, 3), 4u);
  EXPECT_EQ(cycles_of(umull, 0x10000, 0x10000), 5u);
  EXPECT_EQ(cycles_of(smlal, 2, ~0u), 4u);
  EXPECT_EQ(cycles_of(smlal, 0x10000, ~0u), 5u);
  EXPECT_EQ(cycles_of(smlal, 0x10000, 0x80000000), 7u);
}
TEST_P(Timing, DivisionTakesTwoToTwelve) {
  const std::initializer_list<uint16_t> udiv = {0xFBB4, 0xF6F5};
  EXPECT_EQ(cycles_of(udiv, 3, 4), 2u);
  EXPECT_EQ(cycles_of(udiv, 4, 4), 3u);
  EXPECT_EQ(cycles_of(udiv, ~0u, 1), 10u);
}
TEST_P(Timing, AFailedConditionTakesOneCycle) {
  EXPECT_EQ(cycles_of({0xF1B6, 0x0F01, 0xBF08, 0x6808}), 3u);  // cmp.w r6,#1; it eq; ldreq r0,[r1]
}

// DDI 0337E, 18.1
TEST_P(Timing, ABranchToANumberRefillsInOneCycle) {
  EXPECT_EQ(cycles_of({0xE000, 0xBF00, 0xBF00}), 2u + 1u);          // b over a nop; nop
  EXPECT_EQ(cycles_of({0xD100, 0xBF00, 0xBF00}), 2u + 1u);          // bne, taken: Z is clear
  EXPECT_EQ(cycles_of({0xD000, 0xBF00, 0xBF00}), 1u + 2u);          // beq, not taken
  EXPECT_EQ(cycles_of({0xB104, 0xBF00, 0xBF00}, 0), 2u + 1u);       // cbz r4
  EXPECT_EQ(cycles_of({0xF000, 0xF801, 0xBF00, 0xBF00}), 2u + 1u);  // bl
}
TEST_P(Timing, ABranchToARegisterRefillsInTwoCycles) {
  const uint32_t there = Bench::program + 4;
  EXPECT_EQ(cycles_of({0x4720, 0xBF00, 0xBF00}, there | 1), 3u + 1u);  // bx r4
  EXPECT_EQ(cycles_of({0x47A0, 0xBF00, 0xBF00}, there | 1), 3u + 1u);  // blx r4
  EXPECT_EQ(cycles_of({0x46A7, 0xBF00, 0xBF00}, there), 3u + 1u);      // mov pc,r4
  EXPECT_EQ(cycles_of({0x44A7, 0xBF00, 0xBF00}, 0), 3u + 1u);          // add pc,r4
}
// 3.3.2: LDR PC takes at least five cycles, TBB at least six.
TEST_P(Timing, ATargetThatIsLoadedRefillsInThreeCycles) {
  const uint16_t low = ((Bench::program + 8) & 0xFFFF) | 1, high = Bench::program >> 16;
  EXPECT_EQ(cycles_of({0xF8DF, 0xF000, low, high, 0xBF00}), 5u + 1u);  // ldr pc,[pc]
  EXPECT_EQ(cycles_of({0xE8DF, 0xF004, 0x0001, 0xBF00}, 0), 6u + 1u);  // tbb [pc,r4]
  EXPECT_EQ(cycles_of({0xF8DF, 0x1004, 0xB402, 0xBD00, low + 4, high}), 2u + 2u + 5u);
}
// The halves of such a target are in two words.
TEST_P(Timing, ARefillTakesACycleLongerToAWideInstructionThatIsNotAligned) {
  EXPECT_EQ(cycles_of({0xE000, 0xBF00, 0xF3AF, 0x8000}), 2u + 1u);          // b to nop.w at 4
  EXPECT_EQ(cycles_of({0xE7FF, 0xF3AF, 0x8000}), 3u + 1u);                  // b to nop.w at 2
  EXPECT_EQ(cycles_of({0xE001, 0xBF00, 0xBF00, 0xF3AF, 0x8000}), 3u + 1u);  // b to nop.w at 6
  const uint32_t there = Bench::program + 2;
  EXPECT_EQ(cycles_of({0x4720, 0xF3AF, 0x8000}, there | 1), 4u + 1u);  // bx r4
  EXPECT_EQ(cycles_of({0xBF00, 0xF3AF, 0x8000}), 2u);                  // nop: no refill
}
// The loop of many a delay function: three cycles a turn.
TEST_P(Timing, ACountingLoopTakesThreeCyclesATurn) {
  EXPECT_EQ(cycles_of({0x3C01, 0xD1FD}, 20), 20u * 3 - 1);  // subs r4,#1; bne .-2
}

TEST_P(Timing, ItIsFoldedBehindANarrowInstruction) {
  EXPECT_EQ(cycles_of({0x2E01, 0xBF08, 0x6808}), 2u);  // cmp r6,#1; it eq; ldreq r0,[r1]
  // After a wide one, a branch, and as the first instruction at all: its own cycle.
  EXPECT_EQ(cycles_of({0xF3AF, 0x8000, 0xBF08, 0xBF00}), 3u);
  EXPECT_EQ(cycles_of({0xE7FF, 0xBF08, 0xBF00}), 2u + 2u);
  EXPECT_EQ(cycles_of({0xBF08, 0xBF00}), 2u);
  // ldr r0,[r1]; it ne; ldrne r6,[r2]: what obeys a condition does not pair
  EXPECT_EQ(cycles_of({0x6808, 0xBF18, 0x6816}), 4u);
}
TEST_P(Timing, FoldingStopsWithDisfold) {
  Bench b;
  choose(b.core, GetParam());
  // str r5,[r4]; then twice: nop; it eq; nop
  b.start({0xBF00, 0xBF08, 0xBF00, 0x6025, 0xBF00, 0xBF08, 0xBF00, 0xE7FE});
  b.core.set_reg(4, 0xE000E008);  // ACTLR
  b.core.set_reg(5, 1u << 2);
  const auto run_to = [&b](uint32_t address) {
    while (b.core.reg(15) != address && b.core.cycles() < 100) b.core.run(b.core.cycles() + 1);
    return b.core.cycles();
  };
  EXPECT_EQ(run_to(Bench::program + 6), 2u);
  const uint64_t behind_store = run_to(Bench::program + 8);
  EXPECT_EQ(run_to(Bench::program + 14), behind_store + 3);
}
TEST_P(Timing, AStepIsOneInstructionEvenIfItIsFolded) {
  Bench b;
  choose(b.core, GetParam());
  b.start({0xBF00, 0xBF08, 0xBF00, 0xE7FE});
  for (unsigned n = 1; n <= 3; ++n) {
    b.core.step_instruction();
    EXPECT_EQ(b.core.reg(15), Bench::program + 2 * n);
    EXPECT_EQ(b.core.instructions(), n);
  }
}

TEST_P(Timing, TheStateOfThePipelineDoesNotDependOnWhereARunEnds) {
  // Loads, stores and computed addresses without a branch; every cut is tried.
  const std::initializer_list<uint16_t> code = {0x6808, 0x6811, 0x3204, 0x6813, 0x590E,
                                                0x615E, 0x6808, 0x511E, 0xE7F6};
  for (uint64_t cut = 1; cut < 40; ++cut) {
    Bench whole, pieces;
    for (Bench* b : {&whole, &pieces}) {
      choose(b->core, GetParam());
      b->start(code);
      for (unsigned n = 0; n < 4; ++n) b->core.set_reg(n, Bench::ram_base + 64 * n);
    }
    pieces.core.run(cut);
    whole.core.run(60);
    pieces.core.run(60);
    ASSERT_EQ(whole.core.cycles(), pieces.core.cycles()) << cut;
    ASSERT_EQ(whole.core.instructions(), pieces.core.instructions()) << cut;
  }
}

TEST_P(Timing, TheSlowestMemoryThatMayBeIsTimedInFull) {
  Bench b(timing::most_wait_states);
  choose(b.core, GetParam());
  b.start({0xE890, 0x5FFF, 0xE7FE});  // ldm r0,{r0-r12,lr}: one word of code, 1 + 14 cycles
  b.core.set_reg(0, Bench::ram_base);
  const uint64_t before = b.core.cycles();  // the vectors were read
  b.core.run(before + 1);
  EXPECT_EQ(b.core.cycles() - before, 15u + timing::most_wait_states);
}
TEST_P(Timing, WhatADebuggerWritesTakesNoTime) {
  Bench b;
  choose(b.core, GetParam());
  b.start({0x6808, 0x6813, 0x6808, 0x6813, 0xE7FE});  // four loads: 2 + 1 + 1 + 1
  b.core.set_reg(1, Bench::ram_base);
  b.core.set_reg(2, Bench::ram_base);
  const uint32_t aligned = 1u << 9;
  b.core.debug_write(0xE000ED14, &aligned, 4);
  b.core.run(4);
  b.core.debug_write(0xE000ED14, &aligned, 4);
  b.core.run(5);
  EXPECT_EQ(b.core.cycles(), 5u);
  EXPECT_EQ(b.core.reg(15), Bench::program + 8);
}
TEST_P(Timing, AnExceptionIsEnteredInTwelveCyclesAndALateArrivalCostsNone) {
  Bench b;
  choose(b.core, GetParam());
  b.start({0x6025, 0x7037, 0xE7FE});  // str r5,[r4]; strb r7,[r6]; b .
  b.core.set_reg(4, 0xE000E100);
  b.core.set_reg(5, 3);
  b.core.set_reg(6, 0xE000E400);  // line 0 gets the lower priority
  b.core.set_reg(7, 0x80);
  b.core.run(5);
  const uint64_t before = b.core.cycles();
  b.core.set_interrupt(0, true);
  b.core.run(before + 1);
  EXPECT_EQ(b.core.cycles(), before + 12);
  EXPECT_EQ(b.core.state().xpsr() & 0x1FF, 16u);
  const uint32_t frame = b.core.state().msp();
  b.core.set_interrupt(1, true);  // before the handler's first instruction (B1.5.12)
  b.core.run(before + 13);
  EXPECT_EQ(b.core.state().msp(), frame);
  EXPECT_EQ(b.peek(0xE000E300), 2u);  // only the late one is active
  EXPECT_EQ(b.peek(0xE000E200) & 3, 1u);
}

INSTANTIATE_TEST_SUITE_P(Both, Timing, ::testing::ValuesIn(all_executors), executor_name);

}  // namespace
}  // namespace capsoc::armv7m::test
