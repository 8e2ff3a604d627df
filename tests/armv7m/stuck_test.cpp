// The end of a program that no lockup marks: a fault handler that branches to itself.
#include <gtest/gtest.h>

#include "bench.h"
#include "executors.h"

namespace capsoc::armv7m::test {
namespace {

constexpr uint64_t far = 2000;
constexpr uint16_t branch_to_self = 0xE7FE, undefined = 0xDE00;
constexpr unsigned hard_fault = 3, usage_fault = 6;
constexpr uint32_t shcsr = 0xE000ED24, system_handlers = 0xE000ED18, systick_csr = 0xE000E010,
                   systick_rvr = 0xE000E014, nvic_iser = 0xE000E100;

uint32_t handler(unsigned number) {
  return 0x4000 + 32 * number;
}

void poke(Bench& b, uint32_t address, uint32_t value) {
  ASSERT_TRUE(b.core.debug_write(address, &value, 4));
}

/// A program that faults, with a handler that gives up.
void prepare(Bench& b, Executor executor, unsigned number) {
  choose(b.core, executor);
  b.code(handler(number), {branch_to_self});
  b.core.listeners().hopeless = [] { return true; };
  b.start({0x2001, undefined, branch_to_self});
}

TEST(Stuck, AHandlerThatBranchesToItselfEndsTheRunAtTheSameCycle) {
  uint64_t cycles[std::size(all_executors)] = {};
  for (const Executor executor : all_executors) {
    Bench b;
    prepare(b, executor, hard_fault);
    ASSERT_EQ(b.core.run(far), StopReason::stuck);
    EXPECT_EQ(b.core.reg(15), handler(hard_fault));
    EXPECT_EQ(b.core.first_fault().exception, hard_fault);
    cycles[static_cast<unsigned>(executor)] = b.core.cycles();
    const uint64_t before = b.core.instructions();
    ASSERT_EQ(b.core.run(far), StopReason::stuck) << "it may go on, and is there again";
    EXPECT_EQ(b.core.instructions(), before + 1);
  }
  EXPECT_EQ(cycles[0], cycles[1]);
  EXPECT_EQ(cycles[0], cycles[2]);
}

TEST(Stuck, TheWideBranchIsOne) {
  Bench b;
  prepare(b, Executor::blocks, hard_fault);
  b.code(handler(hard_fault), {0xF7FF, 0xBFFE});
  EXPECT_EQ(b.core.run(far), StopReason::stuck);
}

TEST(Stuck, NothingIsSaidUnlessAskedForAndHopeless) {
  Bench b;
  prepare(b, Executor::blocks, hard_fault);
  b.core.listeners().hopeless = {};
  EXPECT_EQ(b.core.run(far), StopReason::budget);
  b.core.listeners().hopeless = [] { return false; };
  EXPECT_EQ(b.core.run(2 * far), StopReason::budget);
}

TEST(Stuck, ALoopOutsideFaultHandlersIsNone) {
  Bench b;
  b.core.listeners().hopeless = [] { return true; };
  b.start({branch_to_self});
  EXPECT_EQ(b.core.run(far), StopReason::budget);
  b.code(handler(16), {branch_to_self});
  poke(b, nvic_iser, 1);
  b.core.set_interrupt(0, true);
  EXPECT_EQ(b.core.run(2 * far), StopReason::budget);
  EXPECT_EQ(b.core.reg(15), handler(16));
}

TEST(Stuck, WhatMayBePreemptedIsNotStuck) {
  for (const bool by_systick : {true, false}) {
    Bench b;
    prepare(b, Executor::blocks, usage_fault);
    poke(b, shcsr, 1U << 18);
    poke(b, system_handlers, 0x20U << 16);  // UsageFault below the others
    if (by_systick) {
      poke(b, systick_rvr, 0xFFFFFF);
      poke(b, systick_csr, 7);
    } else {
      poke(b, nvic_iser, 2);
    }
    EXPECT_EQ(b.core.run(far), StopReason::budget);
    EXPECT_EQ(b.core.reg(15), handler(usage_fault));
    poke(b, system_handlers, 0);
    EXPECT_EQ(b.core.run(2 * far), StopReason::stuck) << "now nothing is above it";
  }
}

TEST(VectorTable, IsReadWhereItIs) {
  Bench b;
  b.word(0x200, Bench::stack - 64);
  b.word(0x204, 0x2001);
  b.core.set_vector_table(0x200);
  b.core.reset();
  EXPECT_EQ(b.core.reg(13), Bench::stack - 64);
  EXPECT_EQ(b.core.reg(15), 0x2000U);
  EXPECT_EQ(b.peek(0xE000ED08), 0x200U);
}

}  // namespace
}  // namespace capsoc::armv7m::test
