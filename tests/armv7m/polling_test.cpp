// Loops that only wait: a turn is measured and repeated exactly, and nothing else is taken for one.
#include <gtest/gtest.h>

#include "armv7m/tlm/polling_watch.h"
#include "bench.h"
#include "executors.h"
#include "step_counts.h"

namespace capsoc::armv7m::test {
namespace {

class Polling : public testing::Test {
 protected:
  /// Starts a program with r4 at the device and r5 in RAM, and runs it into its loop.
  void start(std::initializer_list<uint16_t> code) {
    b.start(code);
    b.core.set_reg(4, 0x40000000);
    b.core.set_reg(5, Bench::ram_base);
    b.core.run(40);
  }
  Bench b;
};

// ldr r0,[r4]; lsls r0,#31; bpl .-4: (1 + 1 + 3 waits) + 1 + 2 cycles
constexpr std::initializer_list<uint16_t> waits_for_bit_0 = {0x6820, 0x07C0, 0xD5FC, 0xE7FE};

TEST_F(Polling, ATurnIsMeasuredAndRepeatedExactly) {
  for (const uint64_t until : {100u, 101u, 107u, 108u, 5000u}) {
    Bench skipping, plain;
    for (Bench* bench : {&skipping, &plain}) {
      bench->start(waits_for_bit_0);
      bench->core.set_reg(4, 0x40000000);
      bench->core.run(40);
    }
    const auto turn = skipping.core.repeat_turn(Core::never);
    ASSERT_TRUE(turn);
    EXPECT_EQ(turn->cycles, 8u);
    EXPECT_EQ(turn->instructions, 3u);
    skipping.core.skip_turns(*turn, until);
    EXPECT_LE(skipping.core.cycles(), until);
    EXPECT_GT(skipping.core.cycles() + turn->cycles, until);
    for (Bench* bench : {&skipping, &plain}) {
      bench->core.run(until);
      bench->device = 1;
      bench->core.run(until + 100);
      EXPECT_EQ(bench->core.reg(15), Bench::program + 6);
    }
    EXPECT_EQ(skipping.core.cycles(), plain.core.cycles());
    EXPECT_EQ(skipping.core.instructions(), plain.core.instructions());
  }
}
/// A turn is known again by what decides on it, and by nothing less.
TEST_F(Polling, ATurnIsKnownAgainWhereNothingThatDecidesOnItHasChanged) {
  start(waits_for_bit_0);
  EXPECT_FALSE(b.core.known_turn());
  const auto turn = b.core.repeat_turn(Core::never);
  ASSERT_TRUE(turn);
  const auto knows = [&] {
    const auto known = b.core.known_turn();
    return known && known->cycles == turn->cycles && known->instructions == turn->instructions;
  };
  EXPECT_TRUE(knows());
  b.core.set_reg(7, 77);
  EXPECT_TRUE(knows()) << "no instruction of the turn names it";
  const State before = b.core.state();
  const uint32_t device = b.core.reg(4), pc = b.core.reg(15), xpsr = b.core.state().xpsr();
  b.core.set_reg(4, device + 4);
  EXPECT_FALSE(knows());
  b.core.set_reg(4, device);
  b.core.edit().set_xpsr(xpsr ^ 0x2000'0000);
  EXPECT_FALSE(knows());
  b.core.edit().set_xpsr(xpsr);
  EXPECT_TRUE(knows());
  const uint16_t ldr = 0x6820, other = 0x6821;
  b.core.debug_write(Bench::program, &other, 2);
  EXPECT_FALSE(knows()) << "other code";
  b.core.debug_write(Bench::program, &ldr, 2);
  EXPECT_TRUE(knows());
  b.core.edit().pc = pc ^ 2;
  EXPECT_FALSE(knows());
  b.core.edit().pc = pc;
  EXPECT_TRUE(knows());
  b.core.reset();
  b.core.edit() = before;
  EXPECT_FALSE(knows()) << "the reset began another program";
}

TEST_F(Polling, ATurnIsGivenUpWhereSomethingElseHappens) {
  start(waits_for_bit_0);
  ASSERT_TRUE(b.core.repeat_turn(Core::never));
  const uint64_t before = b.core.cycles();
  EXPECT_FALSE(b.core.repeat_turn(before + 2)) << "in the middle of the turn's 8 cycles";
  EXPECT_GE(b.core.cycles(), before + 2);
  EXPECT_LT(b.core.cycles(), before + 8);
  ASSERT_TRUE(b.core.repeat_turn(Core::never));
  const uint64_t instructions = b.core.instructions();
  b.core.attention();
  EXPECT_FALSE(b.core.repeat_turn(Core::never));
  EXPECT_EQ(b.core.instructions(), instructions);
}
TEST_F(Polling, TheWatchKnowsALoopAgainAndLeavesOneAloneThatDoesNotWait) {
  PollingWatch watch;
  const uint32_t status = 0x40004004, other = 0x40004000;
  EXPECT_FALSE(watch.is_worth_a_look(status, 1, true));
  EXPECT_TRUE(watch.is_worth_a_look(status, 1, true));
  watch.looked(true);
  EXPECT_FALSE(watch.is_worth_a_look(status, 1, true)) << "less than a turn is left";
  EXPECT_FALSE(watch.is_worth_a_look(status, 0, true)) << "what it waited for";
  EXPECT_FALSE(watch.is_worth_a_look(other, 0, false));
  EXPECT_TRUE(watch.is_worth_a_look(status, 1, true)) << "the same loop again";
  watch.looked(false);
  EXPECT_FALSE(watch.is_worth_a_look(status, 1, true));
  EXPECT_TRUE(watch.is_worth_a_look(status, 1, true)) << "more patient";
  watch.looked(false);
  unsigned reads = 1;
  while (!watch.is_worth_a_look(status, 1, true)) ++reads;
  EXPECT_EQ(reads, 4U);
}
TEST_F(Polling, SkippedTurnsAreCounted) {
  Bench skipping, plain;
  StepCounts steps(plain.core);
  ExecutionCounts counts;
  skipping.core.count_executions(&counts);
  for (Bench* bench : {&skipping, &plain}) {
    // ldr r0,[r4]; lsls r0,#31; ite ne; movne r1,#1; moveq r1,#2; cmp r1,#1; bne .-12; b .
    bench->start({0x6820, 0x07C0, 0xBF14, 0x2101, 0x2102, 0x2901, 0xD1F8, 0xE7FE});
    bench->core.set_reg(4, 0x40000000);
    bench->core.run(40);
  }
  const auto turn = skipping.core.repeat_turn(Core::never);
  ASSERT_TRUE(turn);
  skipping.core.skip_turns(*turn, 5000);
  for (Bench* bench : {&skipping, &plain}) {
    bench->core.run(5000);
    bench->device = 1;
    bench->core.run(5100);
    EXPECT_EQ(bench->core.reg(15), Bench::program + 14);
  }
  EXPECT_EQ(skipping.core.instructions(), plain.core.instructions());
  expect_same_counts(steps, counts);
}
TEST_F(Polling, ALoopThatCallsAFunctionIsOne) {
  // bl +4; beq .-4; b .; ldr r0,[r4]; tst r0,r0; bx lr
  start({0xF000, 0xF802, 0xD0FC, 0xE7FE, 0x6820, 0x4200, 0x4770});
  EXPECT_TRUE(b.core.repeat_turn(Core::never));
}
TEST_F(Polling, ATurnBeginsAnewWhereTheWayIntoTheLoopLeftOtherFlags) {
  Bench skipping, plain;
  StepCounts steps(plain.core);
  ExecutionCounts counts;
  skipping.core.count_executions(&counts);
  for (Bench* bench : {&skipping, &plain}) {
    // adds r2,r1,#1; ldr r0,[r4]; lsls r0,#31; bpl .-4; b .
    bench->start({0x1C4A, 0x6820, 0x07C0, 0xD5FC, 0xE7FE});
    bench->core.set_reg(4, 0x40000000);
    bench->core.run(bench->core.cycles() + 2);
    ASSERT_EQ(bench->core.reg(15), Bench::program + 4) << "behind the first load";
  }
  const uint64_t begin = skipping.core.cycles();
  const auto turn = skipping.core.repeat_turn(Core::never);
  ASSERT_TRUE(turn);
  EXPECT_EQ(turn->cycles, 8u);
  EXPECT_EQ(turn->instructions, 3u);
  EXPECT_EQ(skipping.core.cycles(), begin + 16) << "the second turn";
  skipping.core.skip_turns(*turn, 5000);
  for (Bench* bench : {&skipping, &plain}) {
    bench->core.run(5000);
    bench->device = 1;
    bench->core.run(5100);
    EXPECT_EQ(bench->core.reg(15), Bench::program + 8);
  }
  EXPECT_EQ(skipping.core.cycles(), plain.core.cycles());
  EXPECT_EQ(skipping.core.instructions(), plain.core.instructions());
  expect_same_counts(steps, counts);
  start({0x1C4A, 0x6820, 0x07C0, 0xD5FC, 0xE7FE});
  b.core.edit().set_xpsr(b.core.state().xpsr() ^ 0xF000'0000);
  ASSERT_TRUE(b.core.repeat_turn(Core::never));
  EXPECT_TRUE(b.core.known_turn()) << "by where it began anew";
}
TEST_F(Polling, ALoopThatCallsTheSameFunctionTwiceIsOne) {
  // bl +8; bl +4; beq .-8; b .; ldr r0,[r4]; tst r0,r0; bx lr
  start({0xF000, 0xF804, 0xF000, 0xF802, 0xD0FA, 0xE7FE, 0x6820, 0x4200, 0x4770});
  EXPECT_TRUE(b.core.repeat_turn(Core::never));
}
TEST_F(Polling, ALoopThatCountsIsNone) {
  start({0x6820, 0x3101, 0x07C0, 0xD5FB, 0xE7FE});  // adds r1,#1 in it
  EXPECT_FALSE(b.core.repeat_turn(Core::never));
}
TEST_F(Polling, ALoopThatWritesIsNone) {
  start({0x6820, 0x6028, 0x07C0, 0xD5FB, 0xE7FE});  // str r0,[r5] in it, the same each time
  EXPECT_FALSE(b.core.repeat_turn(Core::never));
}
TEST_F(Polling, ALoopThatReadsTheCoresOwnRegistersIsNone) {
  b.start(waits_for_bit_0);
  b.core.set_reg(4, 0xE000E010);  // SYST_CSR: reading clears COUNTFLAG
  b.core.run(40);
  EXPECT_FALSE(b.core.repeat_turn(Core::never));
}
TEST_F(Polling, ALoopIsLeftForAnInterruptThatIsPending) {
  start(waits_for_bit_0);
  const auto turn = b.core.repeat_turn(Core::never);
  ASSERT_TRUE(turn);
  const uint32_t enable = 1;
  b.core.debug_write(0xE000E100, &enable, 4);
  b.core.set_interrupt(0, true);
  const uint64_t before = b.core.cycles();
  b.core.skip_turns(*turn, before + 1000);
  EXPECT_EQ(b.core.cycles(), before);
  EXPECT_FALSE(b.core.repeat_turn(Core::never));
}
TEST_F(Polling, NoTurnIsSkippedPastSysTick) {
  start(waits_for_bit_0);
  const auto turn = b.core.repeat_turn(Core::never);
  ASSERT_TRUE(turn);
  const uint32_t load = 500, on = 7;
  b.core.debug_write(0xE000E014, &load, 4);
  b.core.debug_write(0xE000E010, &on, 4);
  const uint64_t before = b.core.cycles();
  b.core.skip_turns(*turn, before + 100000);
  EXPECT_LE(b.core.cycles(), before + 502);
  EXPECT_GT(b.core.cycles(), before + 490);
}
TEST_F(Polling, ALoopWithABreakpointOrAnObserverIsNotSkipped) {
  start(waits_for_bit_0);
  b.core.debugging().set_breakpoint(Bench::program + 6);
  EXPECT_FALSE(b.core.repeat_turn(Core::never));
}

}  // namespace
}  // namespace capsoc::armv7m::test
