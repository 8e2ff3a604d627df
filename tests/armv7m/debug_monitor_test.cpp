// The DebugMonitor exception and the comparators of the DWT, sentence by sentence of ARM DDI 0403,
// C1.6 and C1.8. Both executors.
#include <gtest/gtest.h>

#include "bench.h"
#include "executors.h"

namespace capsoc::armv7m::test {
namespace {

constexpr uint32_t demcr = 0xE000EDFC, dfsr = 0xE000ED30, shpr3 = 0xE000ED20;
constexpr uint32_t trcena = 1u << 24, mon_en = 1u << 16, mon_pend = 1u << 17, mon_step = 1u << 18;
constexpr uint32_t halted = 1, bkpt = 2, dwttrap = 4;
constexpr uint32_t function_instruction = 4, function_read = 5, function_write = 6,
                   function_cycle = 4 | 1u << 7;
constexpr unsigned debug_monitor = 12;

class DebugMonitor : public ::testing::TestWithParam<Executor> {
 protected:
  Bench b;
  void SetUp() override { choose(b.core, GetParam()); }

  void write(uint32_t address, uint32_t value) { b.core.debug_write(address, &value, 4); }
  void comparator(unsigned n, uint32_t value, uint32_t function, uint32_t mask = 0) {
    write(0xE0001020 + 16 * n, value);
    write(0xE0001024 + 16 * n, mask);
    write(0xE0001028 + 16 * n, function);
  }
  uint32_t function(unsigned n) { return b.peek(0xE0001028 + 16 * n); }
  /// Runs to the first exception or for some cycles; its number.
  unsigned run(unsigned cycles = 60) {
    const uint64_t end = b.core.cycles() + cycles;
    while (b.core.cycles() < end && (b.core.state().xpsr() & 0x1FF) == 0)
      b.core.run(b.core.cycles() + 1);
    return b.core.state().xpsr() & 0x1FF;
  }
  uint32_t stacked_pc() { return b.peek(b.core.state().msp() + 24); }
};

// C1.6.1
TEST_P(DebugMonitor, ABreakpointInstructionGoesToTheMonitorThatIsEnabled) {
  b.start({0x2001, 0xBE00, 0xE7FE});
  write(demcr, mon_en);
  EXPECT_EQ(run(), debug_monitor);
  EXPECT_EQ(stacked_pc(), Bench::program + 2);
  EXPECT_EQ(b.peek(dfsr), bkpt);
  EXPECT_EQ(b.core.fault_count(), 0u);
}
TEST_P(DebugMonitor, ABreakpointInstructionEscalatesWhileTheMonitorIsDisabled) {
  b.start({0xBE00, 0xE7FE});
  EXPECT_EQ(run(), 3u);
  EXPECT_EQ(b.peek(0xE000ED2C), 1u << 31);
  EXPECT_EQ(b.peek(dfsr), bkpt);
}
TEST_P(DebugMonitor, ABreakpointInstructionEscalatesWhereTheMonitorCannotPreempt) {
  b.start({0xBE00, 0xE7FE});
  write(demcr, mon_en);
  write(shpr3, 0x80);  // the monitor's priority
  b.core.edit().set_basepri(0x80);
  EXPECT_EQ(run(), 3u);
}
TEST_P(DebugMonitor, DfsrIsClearedByWritingOnes) {
  b.start({0xBE00, 0xE7FE});
  run();
  write(dfsr, bkpt);
  EXPECT_EQ(b.peek(dfsr), 0u);
}
// C1.6.5: MON_PEND counts whatever MON_EN is.
TEST_P(DebugMonitor, MonPendIsThePendingStateWhateverMonEnIs) {
  b.start({0xBF00, 0xBF00, 0xE7FE});
  b.core.edit().set_primask(true);
  write(demcr, mon_pend);
  run(20);
  EXPECT_EQ(b.peek(demcr) & mon_pend, mon_pend);
  b.core.edit().set_primask(false);
  EXPECT_EQ(run(), debug_monitor);
  EXPECT_EQ(b.peek(demcr) & mon_pend, 0u);
}
TEST_P(DebugMonitor, MonPendIsWithdrawnByWritingZero) {
  b.start({0xBF00, 0xE7FE});
  b.core.edit().set_primask(true);
  write(demcr, mon_pend);
  write(demcr, 0);
  b.core.edit().set_primask(false);
  EXPECT_EQ(run(), 0u);
}
TEST_P(DebugMonitor, MonStepComesBehindEveryInstructionOfTheInterruptedProgram) {
  // The handler counts in r6 and returns: adds r6,#1; bx lr
  b.code(0x4000 + 32 * debug_monitor, {0x3601, 0x4770});
  b.start({0x3001, 0x3001, 0x3001, 0xE7FE});
  write(demcr, mon_en | mon_step);
  EXPECT_EQ(run(), debug_monitor);
  EXPECT_EQ(b.peek(dfsr), halted);
  EXPECT_EQ(b.core.reg(0), 1u);
  EXPECT_EQ(stacked_pc(), Bench::program + 2);
  b.core.run(b.core.cycles() + 3 * 30);
  EXPECT_EQ(b.core.reg(0), 3u);
  EXPECT_GE(b.core.reg(6), 3u);
}
TEST_P(DebugMonitor, NothingStepsInAHandlerThatTheMonitorCannotPreempt) {
  b.code(0x4000 + 32 * 11, {0x3601, 0x3601, 0x4770});  // SVCall
  b.start({0xDF00, 0xE7FE});
  write(shpr3, 0x80);
  write(demcr, mon_en | mon_step);
  EXPECT_EQ(run(), 11u);
  b.core.run(b.core.cycles() + 2);
  EXPECT_EQ(b.core.reg(6), 2u);
  EXPECT_EQ(b.core.state().xpsr() & 0x1FF, 11u);
}

// C1.8
TEST_P(DebugMonitor, ThereAreFourComparatorsAndNoProfilingCounters) {
  b.start({0xE7FE});
  EXPECT_EQ(b.peek(0xE0001000) >> 28, 4u);
  EXPECT_EQ(b.peek(0xE0002000), 0u) << "FP_CTRL: no FPB comparators";
}
TEST_P(DebugMonitor, AWriteToAWatchedWordSetsMatchedAndRaisesTheMonitorBehindIt) {
  b.start({0x6801, 0x6001, 0x2207, 0xE7FE});  // ldr r1,[r0]; str r1,[r0]; movs r2,#7
  b.core.set_reg(0, Bench::ram_base + 0x100);
  write(demcr, trcena | mon_en);
  comparator(2, Bench::ram_base + 0x100, function_write);
  EXPECT_EQ(run(), debug_monitor);
  EXPECT_EQ(stacked_pc(), Bench::program + 4);
  EXPECT_EQ(b.peek(dfsr), dwttrap);
  EXPECT_NE(function(2) & 1u << 24, 0u);
}
TEST_P(DebugMonitor, AReadComparatorIgnoresWrites) {
  b.start({0x6001, 0x6801, 0xE7FE});
  b.core.set_reg(0, Bench::ram_base + 0x100);
  write(demcr, trcena | mon_en);
  comparator(0, Bench::ram_base + 0x100, function_read);
  EXPECT_EQ(run(), debug_monitor);
  EXPECT_EQ(stacked_pc(), Bench::program + 4);
}
TEST_P(DebugMonitor, AMaskWidensTheComparatorToAnAlignedBlock) {
  for (const uint32_t offset : {0xFCu, 0x100u, 0x13Cu, 0x140u}) {
    b.start({0x7001, 0xE7FE});
    b.core.set_reg(0, Bench::ram_base + offset);
    write(demcr, trcena | mon_en);
    comparator(1, Bench::ram_base + 0x104, function_write, 6);
    EXPECT_EQ(run() == debug_monitor, offset >= 0x100 && offset < 0x140) << offset;
  }
}
TEST_P(DebugMonitor, ReadingFunctionClearsMatched) {
  b.start({0x6001, 0x6822, 0xE7FE});  // str r1,[r0]; ldr r2,[r4]
  b.core.set_reg(0, Bench::ram_base + 0x100);
  b.core.set_reg(4, 0xE0001028);
  write(demcr, trcena);
  comparator(0, Bench::ram_base + 0x100, function_write);
  run(20);
  EXPECT_EQ(b.core.reg(2), function_write | 1u << 24);
  EXPECT_EQ(function(0), function_write);
}
TEST_P(DebugMonitor, AMatchIsNoEventWhileTheMonitorIsDisabled) {
  b.start({0x6001, 0xE7FE});
  b.core.set_reg(0, Bench::ram_base + 0x100);
  write(demcr, trcena);
  comparator(0, Bench::ram_base + 0x100, function_write);
  EXPECT_EQ(run(), 0u);
  EXPECT_EQ(b.peek(dfsr), 0u);
}
TEST_P(DebugMonitor, NothingMatchesWithoutTrcena) {
  b.start({0x6001, 0xE7FE});
  b.core.set_reg(0, Bench::ram_base + 0x100);
  write(demcr, mon_en);
  comparator(0, Bench::ram_base + 0x100, function_write);
  EXPECT_EQ(run(), 0u);
  EXPECT_EQ(function(0), function_write);
}
TEST_P(DebugMonitor, AWatchedWordInALoopMatchesEachTurn) {
  // ldr r0,[pc]; adds r0,r0,r1; b .-4; the word that is loaded: the loop never leaves its page
  b.start({0x4801, 0x1840, 0xE7FC, 0xBF00});
  b.word(Bench::program + 8, 7);
  b.core.run(200);  // hot
  write(demcr, trcena | mon_en);
  comparator(1, Bench::program + 8, function_read);
  const uint64_t cycles = b.core.cycles(), instructions = b.core.instructions();
  b.core.run(cycles + 3000);
  // A turn of the loop and of the monitor: 2 + 1 + 2 and 12 + 3 + 10 cycles, four instructions.
  EXPECT_NEAR(static_cast<double>(b.core.instructions() - instructions), 4 * 3000 / 30, 4);
}
TEST_P(DebugMonitor, AnInstructionAddressMatchesWhenItWasExecuted) {
  b.start({0x3001, 0x3001, 0x3001, 0xE7FE});
  write(demcr, trcena | mon_en);
  comparator(3, Bench::program + 2, function_instruction);
  EXPECT_EQ(run(), debug_monitor);
  EXPECT_EQ(b.core.reg(0), 2u);
  EXPECT_EQ(stacked_pc(), Bench::program + 4);
}
TEST_P(DebugMonitor, TheFirstComparatorMatchesTheCycleCounter) {
  b.start({0x3001, 0xE7FD});  // adds r0,#1; b .-2: three cycles a turn
  write(demcr, trcena | mon_en);
  write(0xE0001004, 0);
  write(0xE0001000, 1);
  comparator(0, 300, function_cycle);
  EXPECT_EQ(run(1000), debug_monitor);
  EXPECT_EQ(b.core.reg(0), 100u);
}
TEST_P(DebugMonitor, TheProgramItselfSetsItsWatchpoints) {
  // r4 = DWT: str r5,[r4,#0x20]; str r6,[r4,#0x28]; str r1,[r5]; str r1,[r5]
  b.start({0x6225, 0x62A6, 0x6029, 0x6029, 0xE7FE});
  b.core.set_reg(4, 0xE0001000);
  b.core.set_reg(5, Bench::ram_base + 0x200);
  b.core.set_reg(6, function_write);
  write(demcr, trcena | mon_en);
  EXPECT_EQ(run(), debug_monitor);
  EXPECT_EQ(stacked_pc(), Bench::program + 6);
}

INSTANTIATE_TEST_SUITE_P(Both, DebugMonitor, ::testing::ValuesIn(all_executors), executor_name);

}  // namespace
}  // namespace capsoc::armv7m::test
