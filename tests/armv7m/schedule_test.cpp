// Random interrupt schedules on a program made for them (firmware/bench/interrupts.c), and random
// bytes as firmware. The long runs: CAPSOC_SCHEDULES=100000, CAPSOC_RANDOM_FIRMWARE=100000.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <random>

#include "bench.h"
#include "board.h"
#include "executors.h"
#include "step_counts.h"

namespace capsoc::armv7m::test {
namespace {

void expect_same_state(const Core& a, const Core& b, unsigned long schedule) {
  for (unsigned n = 0; n < 16; ++n)
    ASSERT_EQ(a.reg(n), b.reg(n)) << "r" << n << ", schedule " << schedule;
  ASSERT_EQ(a.state().xpsr(), b.state().xpsr()) << "schedule " << schedule;
  ASSERT_EQ(a.state().msp(), b.state().msp()) << "schedule " << schedule;
  ASSERT_EQ(a.state().psp(), b.state().psp()) << "schedule " << schedule;
  ASSERT_EQ(a.state().control, b.state().control) << "schedule " << schedule;
  ASSERT_EQ(a.cycles(), b.cycles()) << "schedule " << schedule;
  ASSERT_EQ(a.instructions(), b.instructions()) << "schedule " << schedule;
}

}  // namespace

class Schedules : public testing::TestWithParam<Executor> {};
class RandomFirmware : public testing::TestWithParam<Executor> {};

TEST_P(Schedules, TakeRandomInterruptsAtTheSameInstructionAndCycleAsStepping) {
  const unsigned long schedules = repetitions("CAPSOC_SCHEDULES", 2000);
  const std::string elf = std::string(CAPSOC_BENCH_PROGRAMS) + "/bench_interrupts.elf";
  Board stepping(elf), blocks(elf);
  ASSERT_TRUE(stepping.loaded()) << elf;
  stepping.core.set_executor(Executor::stepping);
  choose(blocks.core, GetParam());
  StepCounts steps(stepping.core);
  ExecutionCounts executed;
  blocks.core.count_executions(&executed);
  std::mt19937 random(1);
  auto run_both = [&](uint64_t until) {
    for (Board* board : {&stepping, &blocks}) {
      // The fast executor gets one more cut, which must change nothing.
      if (board == &blocks && random() % 2 == 0)
        board->core.run(std::min(until, board->core.cycles() + random() % 64));
      while (board->core.cycles() < until) {
        const StopReason reason = board->core.run(until);
        ASSERT_NE(reason, StopReason::lockup);
        if (reason == StopReason::sleeping)
          board->core.skip_to(std::min(until, board->core.next_internal_event()));
      }
    }
  };
  run_both(20000);  // start-up
  for (unsigned long schedule = 0; schedule < schedules; ++schedule) {
    for (unsigned pend = 1 + random() % 6; pend > 0; --pend) {
      ASSERT_NO_FATAL_FAILURE(run_both(stepping.core.cycles() + 1 + random() % 1200));
      const unsigned line = random() % 32;
      const unsigned kind = random() % 16;
      for (Board* board : {&stepping, &blocks}) {
        if (kind == 0) {
          board->core.pulse_nmi();
        } else {
          board->core.set_interrupt(line, true);
          // A short pulse mostly; now and then a level that lasts for a while.
          if (kind < 14) board->core.set_interrupt(line, false);
        }
      }
      if (kind >= 14) {
        ASSERT_NO_FATAL_FAILURE(run_both(stepping.core.cycles() + random() % 300));
        for (Board* board : {&stepping, &blocks}) board->core.set_interrupt(line, false);
      }
    }
    ASSERT_NO_FATAL_FAILURE(expect_same_state(stepping.core, blocks.core, schedule));
    ASSERT_EQ(std::memcmp(stepping.ram.data(), blocks.ram.data(), 128 << 10), 0)
        << "schedule " << schedule;
  }
  ASSERT_NO_FATAL_FAILURE(expect_same_counts(steps, executed));
  std::printf("schedules: %lu, %llu instructions, %llu faults\n", schedules,
              static_cast<unsigned long long>(blocks.core.instructions()),
              static_cast<unsigned long long>(blocks.core.fault_count()));
}

TEST_P(RandomFirmware, RandomBytesEndInAFaultALimitOrAnExitAsWithStepping) {
  const unsigned long seeds = repetitions("CAPSOC_RANDOM_FIRMWARE", 400);
  unsigned long lockups = 0, limits = 0, asleep = 0, other = 0;
  Bench stepping, blocks;
  stepping.core.set_executor(Executor::stepping);
  choose(blocks.core, GetParam());
  for (Bench* b : {&stepping, &blocks}) {
    b->core.listeners().semihosting = [](Core& core) { return core.reg(0) != 0x18; };
  }
  for (unsigned long seed = 1; seed <= seeds; ++seed) {
    std::mt19937 random(static_cast<uint32_t>(seed));
    for (std::size_t at = 0; at < stepping.flash.size(); at += 4) {
      const uint32_t word = random();
      std::memcpy(&stepping.flash[at], &word, 4);
      const uint32_t data = random() % 4 != 0 ? random() : Bench::ram_base + random() % 65536;
      std::memcpy(&stepping.ram[at], &data, 4);
    }
    // Half of the images have vectors that lead somewhere.
    for (uint32_t n = 0; n < 48 && seed % 2 == 0; ++n) {
      const uint32_t base = n == 0 || random() % 8 == 0 ? Bench::ram_base : 0;
      stepping.word(4 * n, base + (random() % 65536 | 1));
    }
    // A third of them step over what faults, and so get further.
    if (seed % 3 == 0) {
      stepping.word(12, 0x4061);
      stepping.code(0x4060, {0x9806, 0x3002, 0x9006, 0x4770});
    }
    blocks.flash = stepping.flash;
    blocks.ram = stepping.ram;
    StopReason reason{};
    for (Bench* b : {&stepping, &blocks}) {
      b->core.set_interrupt(0, false);
      b->core.invalidate_code(0, ~0u);
      b->core.reset();
      const uint64_t end = b->core.cycles() + 3000;
      do {
        reason = b->core.run(end);
        if (reason == StopReason::reset_request) b->core.reset();
      } while (b->core.cycles() < end && reason != StopReason::lockup &&
               reason != StopReason::sleeping && reason != StopReason::semihosting_exit);
    }
    ASSERT_NO_FATAL_FAILURE(expect_same_state(stepping.core, blocks.core, seed));
    ASSERT_EQ(stepping.ram, blocks.ram) << "seed " << seed;
    (reason == StopReason::lockup     ? lockups
     : reason == StopReason::budget   ? limits
     : reason == StopReason::sleeping ? asleep
                                      : other) += 1;
  }
  std::printf("random firmware: %lu images: %lu lockups, %lu limits, %lu asleep, %lu others\n",
              seeds, lockups, limits, asleep, other);
}

INSTANTIATE_TEST_SUITE_P(Executors, Schedules, testing::ValuesIn(fast_executors), executor_name);
INSTANTIATE_TEST_SUITE_P(Executors, RandomFirmware, testing::ValuesIn(fast_executors),
                         executor_name);

}  // namespace capsoc::armv7m::test
