#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <ostream>
#include <vector>

#include "bench.h"
#include "executors.h"

namespace capsoc::armv7m::test {

using Preparation = std::function<void(Bench&)>;

/// What a program came to.
struct Outcome {
  std::vector<uint32_t> registers;
  std::vector<uint8_t> ram;
  uint64_t cycles = 0, instructions = 0, faults = 0;
  uint32_t fault_status = 0, fault_address = 0;

  bool operator==(const Outcome& o) const {
    return registers == o.registers && ram == o.ram && cycles == o.cycles &&
           instructions == o.instructions && faults == o.faults && fault_status == o.fault_status &&
           fault_address == o.fault_address;
  }
};

inline std::ostream& operator<<(std::ostream& out, const Outcome& o) {
  out << std::hex;
  for (const uint32_t value : o.registers) out << value << ' ';
  return out << std::dec << o.cycles << " cycles, " << o.instructions << " instructions, "
             << o.faults << " faults";
}

inline Outcome outcome_of(const Bench& b) {
  Outcome o;
  for (unsigned n = 0; n < 16; ++n) o.registers.push_back(b.core.reg(n));
  o.registers.push_back(b.core.state().xpsr());
  o.ram = b.ram;
  o.cycles = b.core.cycles();
  o.instructions = b.core.instructions();
  o.faults = b.core.fault_count();
  o.fault_status = b.core.last_fault().cfsr;
  o.fault_address = b.core.last_fault().bfar;
  return o;
}

/// Runs a program under stepping and under the translator, and expects the same outcome. Returns
/// the translator's counts.
inline TranslationCounts translation_agrees(const Preparation& prepare_and_run,
                                            Outcome* outcome = nullptr) {
  Bench stepping, translated;
  stepping.core.set_executor(Executor::stepping);
  choose(translated.core, Executor::translator);
  for (Bench* b : {&stepping, &translated}) prepare_and_run(*b);
  const Outcome expected = outcome_of(stepping);
  EXPECT_EQ(expected, outcome_of(translated));
  if (outcome != nullptr) *outcome = expected;
  return translated.core.translation().value_or(TranslationCounts{});
}

/// The same program under both; what it came to.
inline Outcome agreed(const Preparation& prepare, uint64_t cycles = 3000) {
  Outcome outcome;
  const TranslationCounts counts = translation_agrees(
      [&](Bench& b) {
        prepare(b);
        b.core.run(cycles);
      },
      &outcome);
  EXPECT_TRUE(counts.instructions > 0 || !has_translator()) << "nothing was translated";
  return outcome;
}

inline void put(Bench& b, uint32_t address, uint32_t value) {
  std::memcpy(&b.ram[address - Bench::ram_base], &value, 4);
}

inline constexpr uint32_t end_of_ram = Bench::ram_base + 0x8000;

/// The upper half of the host's memory does not belong to the guest.
inline void shorten_ram(Bench& b) {
  b.core.unmap_memory(end_of_ram, 0x8000);
  for (std::size_t i = 0; i < b.ram.size(); ++i) b.ram[i] = static_cast<uint8_t>(i * 7);
}

/// Where tests of faults at the end of that memory have their stack.
inline constexpr uint32_t stack_in_short_ram = end_of_ram - 0x100;

/// N, Z, C, V as the first exception stacked them there.
inline uint32_t stacked_flags(const Outcome& outcome) {
  uint32_t xpsr = 0;
  std::memcpy(&xpsr, &outcome.ram[stack_in_short_ram - 4 - Bench::ram_base], 4);
  return xpsr >> 28;
}

}  // namespace capsoc::armv7m::test
