// Breakpoints and watchpoints of the core: where they stop, and that they change nothing else.
#include <gtest/gtest.h>

#include <cstdio>
#include <random>

#include "armv7m/isa/decoder.h"
#include "bench.h"
#include "executors.h"

namespace capsoc::armv7m::test {
namespace {

constexpr uint64_t far = 1000;

TEST(Debug, BreakpointStopsBeforeItsInstructionOnceForEveryArrival) {
  for (const Executor executor : all_executors) {
    Bench b;
    choose(b.core, executor);
    // 1: adds r0,#1; adds r1,#1; b 1
    b.start({0x3001, 0x3101, 0xE7FC});
    b.core.run(b.core.cycles() + 50);  // decoded by now
    b.core.debugging().set_breakpoint(Bench::program + 2);
    for (int turn = 0; turn < 3; ++turn) {
      ASSERT_EQ(b.core.run(far), StopReason::breakpoint);
      EXPECT_EQ(b.core.reg(15), Bench::program + 2);
      EXPECT_EQ(b.core.reg(0), b.core.reg(1) + 1);
    }
    b.core.debugging().clear_breakpoint(Bench::program + 2);
    EXPECT_EQ(b.core.run(far), StopReason::budget);
  }
}

TEST(Debug, WatchpointsStopBehindTheAccessTheyNameOnly) {
  struct Case {
    bool on_read, on_write;
    uint32_t stop;  // after which instruction, 0: nowhere
  };
  // str r0,[r2]; ldr r1,[r2]; b .
  for (const Case& c : {Case{false, true, 2}, Case{true, false, 4}, Case{true, true, 2}}) {
    for (const Executor executor : all_executors) {
      Bench b;
      choose(b.core, executor);
      b.start({0x6010, 0x6811, 0xE7FE});
      b.core.set_reg(2, Bench::ram_base + 0x100);
      b.core.debugging().set_watchpoint({Bench::ram_base + 0x102, 1, c.on_read, c.on_write});
      ASSERT_EQ(b.core.run(far), StopReason::watchpoint);
      EXPECT_EQ(b.core.reg(15), Bench::program + c.stop);
      EXPECT_EQ(b.core.debugging().watch_hit().address, Bench::ram_base + 0x102);
    }
  }
  Bench b;
  b.start({0x6010, 0x6811, 0xE7FE});
  b.core.set_reg(2, Bench::ram_base + 0x100);
  b.core.debugging().set_watchpoint({Bench::ram_base + 0x104, 4, true, true});
  EXPECT_EQ(b.core.run(far), StopReason::budget) << "the word beside it";
}

TEST(Debug, AStepThatMakesTheAccessEndsWithTheWatchpointOnce) {
  for (const Executor executor : all_executors) {
    Bench b;
    choose(b.core, executor);
    b.start({0x6010, 0x6811, 0xE7FE});  // str r0,[r2]; ldr r1,[r2]; b .
    b.core.set_reg(2, Bench::ram_base + 0x100);
    b.core.debugging().set_watchpoint({Bench::ram_base + 0x100, 4, false, true});
    EXPECT_EQ(b.core.step_instruction(), StopReason::watchpoint);
    EXPECT_EQ(b.core.reg(15), Bench::program + 2);
    EXPECT_EQ(b.core.step_instruction(), StopReason::budget);
    EXPECT_EQ(b.core.run(far), StopReason::budget);
  }
}

// C1.6.1
TEST(Debug, BkptStopsBeforeItselfUnderHaltingDebugAndFaultsWithout) {
  Bench b;
  b.start({0xBE01, 0xE7FE});
  b.core.debugging().set_halting(true);
  ASSERT_EQ(b.core.run(far), StopReason::breakpoint);
  EXPECT_EQ(b.core.reg(15), Bench::program);
  b.start({0xBE01, 0xE7FE});
  b.core.debugging().set_halting(false);
  b.core.run(b.core.cycles() + 20);
  EXPECT_EQ(b.core.fault_count(), 1U);
}

TEST(Debug, DebugWritesReachThePrivateBus) {
  Bench b;
  b.start({0xE7FE});
  const uint32_t table = 0x400;
  ASSERT_TRUE(b.core.debug_write(0xE000ED08, &table, 4));
  EXPECT_EQ(b.peek(0xE000ED08), table);
}

void random_program(std::mt19937& random, Bench& b) {
  uint32_t at = Bench::program;
  while (at < Bench::program + 0x400) {
    const Encoding& e = encodings()[random() % encoding_count()];
    const uint32_t bits = (static_cast<uint32_t>(random()) & ~e.mask) | e.value;
    const uint16_t halves[] = {static_cast<uint16_t>(bits >> 16), static_cast<uint16_t>(bits)};
    const unsigned length = e.length == 32 ? 4 : 2;
    std::memcpy(&b.flash[at], length == 4 ? &halves[0] : &halves[1], length);
    at += length;
  }
  b.code(0x4000 + 32 * 3, {0x9806, 0x3002, 0x9006, 0x4770});
  for (uint8_t& byte : b.ram) byte = static_cast<uint8_t>(random());
  b.core.reset();
  for (unsigned n = 0; n < 13; ++n)
    b.core.set_reg(n, n % 3 == 0 ? static_cast<uint32_t>(random())
                                 : Bench::ram_base + (static_cast<uint32_t>(random()) & 0xFFFC));
}

TEST(Debug, StopsChangeNothingOfRandomPrograms) {
  uint64_t stops = 0, watches = 0, instructions = 0;
  for (uint32_t seed = 1; seed <= 1000; ++seed) {
    Bench plain(seed % 3), debugged(seed % 3);
    for (Bench* b : {&plain, &debugged}) {
      std::mt19937 random(seed);
      random_program(random, *b);
      // An MPU region with read-only RAM in a third of the runs, so that both kinds of view mix.
      if (seed % 3 == 0) {
        const uint32_t rbar = (Bench::ram_base + 0x8000) | 0x10, rasr = 0x06000000 | 13 << 1 | 1,
                       on = 5;
        b->core.debug_write(0xE000ED9C, &rbar, 4);
        b->core.debug_write(0xE000EDA0, &rasr, 4);
        b->core.debug_write(0xE000ED94, &on, 4);
      }
    }
    std::mt19937 random(seed * 31);
    for (unsigned slice = 0; slice < 10; ++slice) {
      for (unsigned i = 0; i < 3; ++i) {
        const uint32_t address = Bench::program + 2 * (random() % 0x200);
        if (random() % 2 != 0) debugged.core.debugging().set_breakpoint(address);
        if (random() % 2 != 0) debugged.core.debugging().clear_breakpoint(address);
      }
      const Watchpoint watch{Bench::ram_base + static_cast<uint32_t>(random() & 0xFFFF),
                             static_cast<uint32_t>(1 + random() % 0x2000), random() % 2 != 0,
                             random() % 2 != 0};
      debugged.core.debugging().set_watchpoint(watch);
      const uint64_t until = plain.core.cycles() + 1 + random() % 200;
      const StopReason expected = plain.core.run(until);
      StopReason reason = debugged.core.run(until);
      while (reason == StopReason::breakpoint || reason == StopReason::watchpoint) {
        ++stops;
        watches += reason == StopReason::watchpoint ? 1 : 0;
        reason = debugged.core.run(until);
      }
      if (random() % 2 != 0) debugged.core.debugging().clear_watchpoint(watch);
      ASSERT_EQ(reason, expected) << "seed " << seed;
      for (unsigned n = 0; n < 16; ++n)
        ASSERT_EQ(plain.core.reg(n), debugged.core.reg(n)) << "r" << n << " seed " << seed;
      ASSERT_EQ(plain.core.state().xpsr(), debugged.core.state().xpsr()) << "seed " << seed;
      ASSERT_EQ(plain.core.cycles(), debugged.core.cycles()) << "seed " << seed;
      ASSERT_EQ(plain.core.instructions(), debugged.core.instructions()) << "seed " << seed;
      if (reason == StopReason::lockup) break;
      const unsigned line = random() % 32;
      const bool level = random() % 2 != 0;
      for (Bench* b : {&plain, &debugged}) {
        b->core.set_interrupt(line, level);
        if (b->core.sleeping()) b->core.skip_to(until + 50);
      }
    }
    ASSERT_EQ(plain.ram, debugged.ram) << "seed " << seed;
    instructions += plain.core.instructions();
  }
  std::printf("debug: 1000 programs, %llu instructions, %llu stops, %llu of them at watchpoints\n",
              static_cast<unsigned long long>(instructions), static_cast<unsigned long long>(stops),
              static_cast<unsigned long long>(watches));
  EXPECT_GT(watches, 1000U);
}

}  // namespace
}  // namespace capsoc::armv7m::test
