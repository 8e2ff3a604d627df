// The executors against each other: random programs, random interrupts, random quanta.
#include <gtest/gtest.h>

#include <cstdio>
#include <optional>
#include <random>

#include "armv7m/isa/decoder.h"
#include "armv7m/system/registers.h"
#include "bench.h"
#include "board.h"
#include "executors.h"
#include "step_counts.h"

namespace capsoc::armv7m::test {
namespace {

/// Random bits through the pattern of a random line of isa.def; plain random bits now and then.
/// Of another core's lines only every fourth stays.
void random_code(std::mt19937& random, std::vector<uint8_t>& flash, const Profile& profile) {
  uint32_t at = Bench::program;
  auto put = [&](uint32_t halfword) {
    uint16_t h = static_cast<uint16_t>(halfword);
    std::memcpy(&flash[at], &h, 2);
    at += 2;
  };
  while (at < Bench::program + 0x400) {
    const Encoding& e = encodings()[random() % encoding_count()];
    if ((e.set & profile.instruction_sets) == 0 && random() % 4 != 0) continue;
    uint32_t bits = (random() & ~e.mask) | e.value;
    if (random() % 32 == 0) {
      put(random());
    } else if (e.length == 32) {
      put(bits >> 16);
      put(bits);
    } else {
      put(bits);
    }
  }
}

/// The DWT and the DebugMonitor at work in a third of the programs.
void watch_at_random(Bench& b, std::mt19937& random) {
  const auto write = [&b](uint32_t address, uint32_t value) {
    b.core.debug_write(address, &value, 4);
  };
  write(0xE000EDFC, 1u << 24 | 1u << 16 | (random() % 4 == 0 ? 1u << 18 : 0));
  write(0xE0001000, 1);
  for (uint32_t n = 0; n < 4; ++n) {
    const uint32_t place = random() % 2 == 0 ? Bench::ram_base + (random() & 0xFFFF)
                                             : Bench::program + (random() & 0x3FE);
    write(0xE0001020 + 16 * n, n == 0 ? random() % 2000 : place);
    write(0xE0001024 + 16 * n, random() % 16);
    write(0xE0001028 + 16 * n, n == 0 ? 0x84 : random() % 8);
  }
}

/// The floating-point extension: open to programs in most of them, its registers full, its context
/// counted and saved as FPCCR says, and some of the stack beyond what the MPU allows.
void use_fpu_at_random(Bench& b, std::mt19937& random) {
  const auto write = [&b](uint32_t address, uint32_t value) {
    b.core.debug_write(address, &value, 4);
  };
  write(ppb::CPACR, random() % 8 == 0 ? random() : 0x00F00000);
  write(ppb::FPCCR, random() % 4 == 0 ? random() & 0xC000017A : 0xC0000000);
  write(ppb::FPDSCR, random());
  // vadd s0,s0,s1; vmrs r0,fpscr; bx lr
  for (unsigned n = exception::first_interrupt; n < exception::count; n += 1 + random() % 3)
    b.code(Bench::handler(n), {0xEE30, 0x0A20, 0xEEF1, 0x0A10, 0x4770});
  State& state = b.core.edit();
  for (unsigned n = 0; n < Fpu::registers; ++n) state.fpu.set_s(n, random());
  state.fpu.status() = Fpscr(random());
  if (random() % 4 != 0) return;
  write(ppb::SHCSR, (random() & 7) << 16);
  write(ppb::MPU_RBAR, Bench::stack - 0x80 - (random() & 0x1E0) + 0x10);
  write(ppb::MPU_RBAR + 4, 5u << 24 | (4 + random() % 2) << 1 | 1);  // read only
  write(ppb::MPU_CTRL, 5 + (random() & 2));
}

void prepare(Bench& b, uint32_t seed) {
  std::mt19937 random(seed);
  random_code(random, b.flash, b.core.profile());
  // HardFault steps over the faulting halfword: ldr r0,[sp,#24]; adds r0,#2; str r0,[sp,#24]; bx lr
  b.code(0x4000 + 32 * 3, {0x9806, 0x3002, 0x9006, 0x4770});
  for (uint8_t& byte : b.ram) byte = static_cast<uint8_t>(random());
  b.on_write = [&b](uint32_t value) { b.core.set_interrupt(value & 31, (value & 32) != 0); };
  b.core.reset();
  for (unsigned n = 0; n < 13; ++n) {
    b.core.set_reg(n, n % 3 == 0 ? random() : Bench::ram_base + (random() & 0xFFFC));
  }
  b.core.set_reg(7, 0x40000000);
  uint32_t enable = 0xE000E100;
  b.core.set_reg(6, enable);
  if (seed % 3 == 2) watch_at_random(b, random);
  if (b.core.profile().has_fpu()) use_fpu_at_random(b, random);
}

void expect_equal(Bench& a, Bench& b, uint32_t seed) {
  for (unsigned n = 0; n < 16; ++n)
    ASSERT_EQ(a.core.reg(n), b.core.reg(n)) << "r" << n << " seed " << seed;
  ASSERT_EQ(a.core.state().xpsr(), b.core.state().xpsr()) << "seed " << seed;
  for (unsigned n = 0; n < Fpu::registers; ++n)
    ASSERT_EQ(a.core.state().fpu.s(n), b.core.state().fpu.s(n)) << "s" << n << " seed " << seed;
  ASSERT_EQ(a.core.state().fpu.status().bits(), b.core.state().fpu.status().bits())
      << "seed " << seed;
  ASSERT_EQ(a.core.state().control, b.core.state().control) << "seed " << seed;
  ASSERT_EQ(a.peek(ppb::FPCCR), b.peek(ppb::FPCCR)) << "seed " << seed;
  ASSERT_EQ(a.peek(ppb::FPCAR), b.peek(ppb::FPCAR)) << "seed " << seed;
  ASSERT_EQ(a.core.cycles(), b.core.cycles()) << "seed " << seed;
  ASSERT_EQ(a.core.instructions(), b.core.instructions()) << "seed " << seed;
}

}  // namespace

class Agreement : public testing::TestWithParam<FastCore> {};

TEST_P(Agreement, WithSteppingOnRandomProgramsForEveryQuantum) {
  const Executor executor = GetParam().executor;
  const Profile& profile = *GetParam().profile;
  const unsigned long programs = repetitions("CAPSOC_AGREEMENT", 1500);
  uint64_t instructions = 0, faults = 0, translated = 0, registers_unchanged = 0;
  const unsigned long first = repetitions("CAPSOC_AGREEMENT_SEED", 1);
  for (auto seed = static_cast<uint32_t>(first); seed < first + programs; ++seed) {
    Bench a(seed % 3, profile), b(seed % 3, profile);
    a.core.set_executor(Executor::stepping);
    choose(b.core, executor);
    prepare(a, seed);
    prepare(b, seed);
    b.at_once = seed % 4 != 0;
    std::optional<StepCounts> steps;
    ExecutionCounts executed;
    std::map<uint32_t, ExecutionCounts::Totals> totals;
    if (seed % 2 == 0) {
      steps.emplace(a.core);
      b.core.count_executions(&executed);
    }
    std::mt19937 random(seed * 7919);
    for (unsigned slice = 0; slice < 12; ++slice) {
      const uint64_t longest = seed % 2 == 0 ? 200 : 1500;
      uint64_t until = a.core.cycles() + 1 + random() % longest,
               middle = a.core.cycles() + random() % longest;
      a.core.run(until);
      if (middle < until) b.core.run(middle);  // one more cut must change nothing
      StopReason reason = b.core.run(until);
      ASSERT_NO_FATAL_FAILURE(expect_equal(a, b, seed));
      if (steps) {
        const uint32_t changed = steps->take_changed(), told = executed.changed_registers(totals);
        ASSERT_EQ(changed & ~told, 0U) << "seed " << seed;
        totals = executed.totals();
        registers_unchanged += 15 - static_cast<uint64_t>(__builtin_popcount(told));
      }
      if (reason == StopReason::lockup) break;
      unsigned line = random() % 32;
      bool level = random() % 2 != 0;
      for (Bench* bench : {&a, &b}) {
        bench->core.set_interrupt(line, level);
        if (line == 0) bench->core.pulse_nmi();
        if (bench->core.sleeping()) bench->core.skip_to(until + 50);
      }
    }
    ASSERT_EQ(a.ram, b.ram) << "seed " << seed;
    if (steps) {
      ASSERT_NO_FATAL_FAILURE(expect_same_counts(*steps, executed)) << "seed " << seed;
    }
    instructions += b.core.instructions();
    faults += b.core.fault_count();
    translated += b.core.translation().value_or(TranslationCounts{}).instructions;
  }
  std::printf("agreement: %lu programs, %llu instructions (%llu translated), %llu faults\n",
              programs, static_cast<unsigned long long>(instructions),
              static_cast<unsigned long long>(translated), static_cast<unsigned long long>(faults));
  EXPECT_GT(instructions, programs * 66);
  EXPECT_GT(registers_unchanged, programs);
  if (executor == Executor::translator && has_translator()) {
    EXPECT_GT(translated, programs);
  }
}

INSTANTIATE_TEST_SUITE_P(Executors, Agreement, testing::ValuesIn(fast_cores), core_name);

}  // namespace capsoc::armv7m::test
