// Random programs that loop, so that their code becomes hot. They have data processing, IT blocks,
// transfers through pointers that mostly lead to memory, branches, calls and returns. Their code
// crosses the border of two pages, in flash or in RAM that the program writes. Compares the fast
// executors with stepping. The long run: CAPSOC_HOT_CODE=100000.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <optional>
#include <random>

#include "armv7m/isa/decoder.h"
#include "armv7m/isa/unpredictable.h"
#include "armv7m/system/registers.h"
#include "bench.h"
#include "board.h"
#include "executors.h"
#include "step_counts.h"

namespace capsoc::armv7m::test {
namespace {

// r4 and r5 are pointers, r6 counts the loops.
constexpr uint32_t kept_registers = 1u << 4 | 1u << 5 | 1u << 6 | 1u << 13 | 1u << 14 | 1u << 15;

bool keeps(unsigned n) {
  return (kept_registers >> n & 1) != 0;
}

class Program {
 public:
  Program(std::mt19937& random, uint32_t address, const Profile& profile)
      : random_(random), profile_(profile), address_(address), start_(address) {}

  const std::vector<uint16_t>& build(uint32_t stack) {
    set(0, stack);
    put(0x4685);  // mov sp,r0
    const unsigned parts = 2 + random_() % 4;
    for (unsigned i = 0; i < parts; ++i) loop(2 + random_() % 6);
    put(0xE7FE - ((address_ - start_) / 2));  // b to the start
    return code_;
  }

 private:
  void put(uint32_t halfword) {
    code_.push_back(static_cast<uint16_t>(halfword));
    address_ += 2;
  }
  void put(const DecodedOp& op) {
    if (op.size == 4) put(op.encoding >> 16);
    put(op.encoding);
  }
  bool is_small() const { return (profile_.instruction_sets & instruction_set::v7m) == 0; }
  /// A low register by its bytes: movs, and three times lsls and adds.
  void set_small(unsigned n, uint32_t value) {
    put(0x2000u | n << 8 | value >> 24);
    for (const unsigned shift : {16u, 8u, 0u}) {
      put(0x0200u | n << 3 | n);
      put(0x3000u | n << 8 | (value >> shift & 0xFF));
    }
  }
  void set(unsigned n, uint32_t value) {  // movw, movt
    if (is_small()) return set_small(n, value);
    for (const uint32_t base : {0xF240u, 0xF2C0u}) {
      const uint32_t half = base == 0xF240u ? value & 0xFFFF : value >> 16;
      put(base | half >> 12 | (half >> 11 & 1) << 10);
      put((half >> 8 & 7) << 12 | n << 8 | (half & 0xFF));
    }
  }
  uint32_t pointer() {
    switch (random_() % 12) {
      case 0:
        return 0x40000000;
      case 1:
        return 0x2000 + random_() % 1024;  // flash
      case 2:
        return Bench::ram_base + 0x2000 - random_() % 32;  // the end of a page
      case 3:
        return Bench::ram_base + random_() % 0x8000;
      case 4:
        return start_ + random_() % 256;
      default:
        return Bench::ram_base + 0x1000 + (random_() % 0x3000 & ~3u);
    }
  }

  bool fits_fp(const DecodedOp& op) {
    switch (op.operation) {
      case Operation::vmov_to_core:
        return !keeps(op.rd);
      case Operation::vmrs:
        return op.rd == 15 || !keeps(op.rd);
      case Operation::vmov_pair_to_core:
        return !keeps(op.rd) && !keeps(op.ra);
      default:
        break;
    }
    if (!is(op, kind::fp_transfer)) return true;
    return op.addressing == Addressing::literal || op.rn == 4 || op.rn == 5 || op.rn == 13;
  }
  bool fits(const DecodedOp& op) {
    if (op.operation == Operation::undefined || unpredictable_encoding(op)) return false;
    if (is(op, kind::data_processing)) {
      const bool second = is(op, kind::long_multiply) && keeps(op.ra);
      return is(op, kind::compare) || (!keeps(op.rd) && !second);
    }
    if (is(op, kind::fp_extension)) return fits_fp(op);
    if (!is(op, kind::transfer) || is(op, kind::exclusive)) return op.operation == Operation::nop;
    const bool literal = op.addressing == Addressing::literal;
    if (!literal && op.rn != 4 && op.rn != 5 && op.rn != 13) return false;
    if (op.addressing == Addressing::reg && random_() % 64 != 0) return false;
    if (is(op, kind::multiple_load)) return (op.list.bits & kept_registers) == 0;
    if (is(op, kind::load)) return !keeps(op.rd);
    return !is(op, kind::dual_load) || (!keeps(op.rd) && !keeps(op.ra));
  }

  /// A random instruction that leaves the frame of the program alone.
  DecodedOp draw(uint8_t it) {
    while (true) {
      const Encoding& e = encodings()[random_() % encoding_count()];
      if (is(e.operation, kind::any_branch | kind::system | kind::none)) continue;
      if ((e.set & profile_.instruction_sets) == 0) continue;
      uint32_t bits = (random_() & ~e.mask) | e.value;
      bits = (bits | e.ones) & ~e.zeros;
      const bool wide = e.length == 32;
      const auto first = static_cast<uint16_t>(wide ? bits >> 16 : bits);
      const DecodedOp op = decode(address_, first, static_cast<uint16_t>(bits), it, profile_);
      if (op.size == (wide ? 4 : 2) && fits(op)) return op;
    }
  }
  void one() {
    const DecodedOp op = draw(0);
    put(op);
  }
  void it_block() {
    if (is_small()) return one();
    const uint32_t condition = random_() % 14, mask = 1 + random_() % 15;
    uint8_t it = static_cast<uint8_t>(condition << 4 | mask);
    put(0xBF00u | it);
    while (it != 0) {
      const DecodedOp op = draw(it);
      put(op);
      it = op.it_after;
    }
  }
  /// Over some instructions, on a condition or by CBZ and CBNZ.
  void branch_ahead() {
    const std::size_t at = code_.size();
    put(0);
    for (unsigned n = 1 + random_() % 4; n > 0; --n) one();
    const auto distance = static_cast<uint32_t>(code_.size() - at - 2);
    const uint32_t over =
        !is_small() && random_() % 3 == 0
            ? 0xB100u | (random_() % 2) << 11 | (distance & 0x1F) << 3 | random_() % 4
            : 0xD000u | (random_() % 14) << 8 | distance;
    code_[at] = static_cast<uint16_t>(over);
  }
  /// BL over a function that stands here.
  void call() {
    const bool pushes = random_() % 2 != 0;
    const std::size_t at = code_.size();
    put(0);  // b over the function
    const uint32_t function = address_;
    if (pushes) put(0xB50E);  // push {r1-r3,lr}
    for (unsigned n = random_() % 4; n > 0; --n) one();
    put(pushes ? 0xBD0E : 0x4770);  // pop {r1-r3,pc}, bx lr
    code_[at] = static_cast<uint16_t>(0xE000u | ((code_.size() - at - 2) & 0x7FF));
    const uint32_t offset = function - (address_ + 4);
    put(0xF000u | (offset >> 12 & 0x7FF));
    put(0xF800u | (offset >> 1 & 0x7FF));
  }
  /// One of r0 to r3, but not `other`.
  uint32_t low(uint32_t other = 4) {
    const uint32_t n = random_() % 4;
    return n != other ? n : (n + 1) % 4;
  }
  /// LDREX and STREX of one place most of the time, and something between them.
  void exclusives() {
    const uint32_t base = 4 + random_() % 2, loaded = low(), stored = low();
    const uint32_t size = random_() % 4, other = random_() % 8 == 0 ? 1 : 0;
    constexpr uint32_t narrow[] = {0xF4F, 0xF5F};
    put((size < 2 ? 0xE8D0u : 0xE850u) | base);
    put(loaded << 12 | (size < 2 ? narrow[size] : 0xF00u));
    for (unsigned n = random_() % 3; n > 0; --n) one();
    put((size < 2 ? 0xE8C0u : 0xE840u) | (base ^ other));
    const uint32_t failed = low(stored);
    put(stored << 12 | (size < 2 ? 0xF40u | size << 4 | failed : failed << 8));
  }
  /// MRS, MSR and CPS of the interrupt masks.
  void masks() {
    const uint32_t which = is_small() ? 16 : 16 + random_() % 3;
    switch (random_() % 4) {
      case 0:
        put(0xF3EF);
        return put(0x8000u | low() << 8 | which);
      case 1:
        put(0xF380u | low());
        return put(0x8800u | which);
      default:
        return put(random_() % 3 == 0 ? 0xB672 : 0xB662);  // cpsid i, cpsie i
    }
  }
  void loop(unsigned parts) {
    put(0x2600u | (random_() % 24 + 2));  // movs r6,#n
    const std::size_t top = code_.size();
    set(4, pointer());
    set(5, pointer());
    for (unsigned i = 0; i < parts; ++i) {
      switch (random_() % 8) {
        case 6:
          if (!is_small()) exclusives();
          break;
        case 7:
          masks();
          break;
        case 0:
          it_block();
          break;
        case 1:
          branch_ahead();
          break;
        case 2:
          call();
          break;
        default:
          for (unsigned n = 1 + random_() % 5; n > 0; --n) one();
          break;
      }
    }
    put(0x3E01);  // subs r6,#1
    if (is_small()) {
      put(0xD000);  // beq over the branch: b top
      const auto small_back = static_cast<uint32_t>(code_.size() - top + 2);
      return put(0xE000u | ((0u - small_back) & 0x7FF));
    }
    const auto back = static_cast<uint32_t>(code_.size() - top + 2);
    const uint32_t offset = 0u - 2 * back;  // bne.w top
    put(0xF000u | (offset >> 20 & 1) << 10 | 1u << 6 | (offset >> 12 & 0x3F));
    put(0x8000u | (offset >> 18 & 1) << 13 | (offset >> 19 & 1) << 11 | (offset >> 1 & 0x7FF));
  }

  std::mt19937& random_;
  const Profile& profile_;
  uint32_t address_, start_;
  std::vector<uint16_t> code_;
};

/// Loops that use the FPU are interrupted by handlers of which some use it, too.
void use_fpu_in_handlers(Bench& b, std::mt19937& random) {
  const auto write = [&b](uint32_t address, uint32_t value) {
    b.core.debug_write(address, &value, 4);
  };
  for (unsigned n = exception::first_interrupt; n < exception::count; n += 1 + random() % 3)
    b.code(Bench::handler(n), {0xEE30, 0x0A20, 0xEEF1, 0x0A10, 0x4770});  // vadd s0,s0,s1; vmrs r0
  write(ppb::NVIC_ISER, ~0u);
  for (uint32_t n = 0; n < 8; ++n) write(ppb::NVIC_IPR + 4 * n, random());
  write(ppb::CPACR, 0x00F00000);
  // What translated code lets the host compute: as most programs have it, or any mode and number.
  const bool usual = random() % 2 == 0;
  write(ppb::FPDSCR, usual ? 0 : random());
  if (random() % 4 == 0) write(ppb::FPCCR, random() & 0xC0000000);
  Fpu& fpu = b.core.edit().fpu;
  if (usual) fpu.status() = Fpscr(Fpscr::inexact);
  for (unsigned n = 0; n < Fpu::registers; ++n)
    fpu.set_s(n, usual ? (random() & 0x81FFFFFF) + 0x3E000000 : random());
}

void prepare_loops(Bench& b, uint32_t seed) {
  std::mt19937 random(seed);
  const bool in_ram = seed % 4 == 1;
  // Most programs lie across the border of a page.
  const uint32_t page = in_ram ? Bench::ram_base + 0x6000 : Bench::program + 0x1000;
  const uint32_t start = page - 2 * (random() % 160);
  for (uint8_t& byte : b.ram) byte = static_cast<uint8_t>(random());
  for (std::size_t i = 0x8000; i < b.flash.size(); ++i) b.flash[i] = static_cast<uint8_t>(random());
  const std::vector<uint16_t> code =
      Program(random, start, b.core.profile()).build(Bench::stack - 256);
  std::memcpy(in_ram ? &b.ram[start - Bench::ram_base] : &b.flash[start], code.data(),
              2 * code.size());
  // HardFault steps over the faulting halfword: ldr r0,[sp,#24]; adds r0,#2; str r0,[sp,#24]; bx lr
  b.code(0x4000 + 32 * 3, {0x9806, 0x3002, 0x9006, 0x4770});
  b.core.reset();
  b.core.set_reg(15, start);
  for (unsigned n = 0; n < 13; ++n) b.core.set_reg(n, random());
  if (b.core.profile().has_fpu()) use_fpu_in_handlers(b, random);
  const auto write = [&b](uint32_t address, uint32_t value) {
    b.core.debug_write(address, &value, 4);
  };
  if (seed % 3 != 0) {  // for the masks to hold back
    write(ppb::NVIC_ISER, ~0u);
    for (uint32_t n = 0; n < 8; ++n) write(ppb::NVIC_IPR + 4 * n, random());
  }
  if (seed % 5 != 0) return;
  write(0xE000ED98, 0);  // MPU: half of the RAM is read-only, the default map elsewhere
  write(0xE000ED9C, Bench::ram_base);
  write(0xE000EDA0, 0x06000000 | 12 << 1 | 1);
  if (seed % 2 == 1) {  // and so is the device
    write(0xE000ED98, 1);
    write(0xE000ED9C, 0x40000000);
    write(0xE000EDA0, 0x06000000 | 11 << 1 | 1);
  }
  write(0xE000ED94, 5);
}

/// What a device may see of the processor when it is written to.
uint64_t seen_by_device(uint64_t before, Core& core, uint32_t value) {
  uint64_t seen = before;
  for (const uint64_t part :
       {uint64_t{value}, core.cycles(), uint64_t{core.state().xpsr() >> 28},
        uint64_t{core.state().pc}, uint64_t{core.reg(0)}, uint64_t{core.reg(13)}})
    seen = (seen ^ part) * 0x100000001B3u;
  core.set_interrupt(value & 31, (value & 32) != 0);
  return seen;
}

void expect_equal_at(const Core& a, const Core& b, uint32_t seed, unsigned slice) {
  for (unsigned n = 0; n < 16; ++n)
    ASSERT_EQ(a.reg(n), b.reg(n)) << "r" << n << " seed " << seed << " slice " << slice;
  ASSERT_EQ(a.state().xpsr(), b.state().xpsr()) << "seed " << seed << " slice " << slice;
  for (unsigned n = 0; n < Fpu::registers; ++n)
    ASSERT_EQ(a.state().fpu.s(n), b.state().fpu.s(n)) << "s" << n << " seed " << seed;
  ASSERT_EQ(a.state().fpu.status().bits(), b.state().fpu.status().bits()) << "seed " << seed;
  ASSERT_EQ(a.state().control, b.state().control) << "seed " << seed;
  ASSERT_EQ(a.cycles(), b.cycles()) << "seed " << seed << " slice " << slice;
  ASSERT_EQ(a.instructions(), b.instructions()) << "seed " << seed << " slice " << slice;
}

}  // namespace

class HotCode : public testing::TestWithParam<Executor> {};
class HotLoops : public testing::TestWithParam<FastCore> {};

TEST_P(HotLoops, AgreeWithSteppingOnRandomPrograms) {
  const Executor executor = GetParam().executor;
  const Profile& profile = *GetParam().profile;
  const unsigned long programs = repetitions("CAPSOC_HOT_CODE", 1000);
  const unsigned long first = repetitions("CAPSOC_HOT_CODE_SEED", 1);
  uint64_t instructions = 0, translated = 0, evictions = 0, faults = 0, at_once = 0;
  for (auto seed = static_cast<uint32_t>(first); seed < first + programs; ++seed) {
    Bench a(seed % 3, profile), b(seed % 3, profile);
    a.core.set_executor(Executor::stepping);
    choose(b.core, executor, seed % 11 == 0 ? smallest_translator() : TranslatorLimits{});
    if (seed % 7 == 0) b.core.set_translation_threshold(20);
    prepare_loops(a, seed);
    prepare_loops(b, seed);
    b.at_once = seed % 4 != 0;
    std::array<uint64_t, 2> seen{};  // by the device
    a.on_write = [&](uint32_t value) { seen[0] = seen_by_device(seen[0], a.core, value); };
    b.on_write = [&](uint32_t value) { seen[1] = seen_by_device(seen[1], b.core, value); };
    std::optional<StepCounts> steps;
    ExecutionCounts executed;
    if (seed % 2 == 0) {
      steps.emplace(a.core);
      b.core.count_executions(&executed);
    }
    std::mt19937 random(seed * 7919);
    for (unsigned slice = 0; slice < 10; ++slice) {
      const uint64_t until = a.core.cycles() + 1 + random() % 3000;
      const uint64_t middle = a.core.cycles() + random() % 3000;
      a.core.run(until);
      if (middle < until) b.core.run(middle);
      const StopReason reason = b.core.run(until);
      ASSERT_NO_FATAL_FAILURE(expect_equal_at(a.core, b.core, seed, slice));
      if (reason == StopReason::lockup) break;
      const unsigned line = random() % 32;
      for (Bench* bench : {&a, &b}) {
        bench->core.set_interrupt(line, true);
        bench->core.set_interrupt(line, false);
        if (line == 0) bench->core.pulse_nmi();
      }
    }
    const auto differs = std::mismatch(a.ram.begin(), a.ram.end(), b.ram.begin()).first;
    ASSERT_EQ(differs - a.ram.begin(), static_cast<std::ptrdiff_t>(a.ram.size()))
        << "first byte of RAM that differs, seed " << seed;
    ASSERT_EQ(seen[0], seen[1]) << "seed " << seed;
    at_once += b.asked;
    if (steps) {
      ASSERT_NO_FATAL_FAILURE(expect_same_counts(*steps, executed)) << "seed " << seed;
    }
    instructions += b.core.instructions();
    const TranslationCounts counts = b.core.translation().value_or(TranslationCounts{});
    translated += counts.instructions;
    evictions += counts.evictions;
    faults += b.core.fault_count();
  }
  std::printf(
      "hot code: %lu programs, %llu instructions (%llu translated), %llu evictions, %llu faults\n",
      programs, static_cast<unsigned long long>(instructions),
      static_cast<unsigned long long>(translated), static_cast<unsigned long long>(evictions),
      static_cast<unsigned long long>(faults));
  EXPECT_GT(instructions, programs * 1000);
  EXPECT_GT(at_once, programs) << "accesses to the device";
  if (executor == Executor::translator && has_translator()) {
    EXPECT_GT(translated, instructions / 3);
    if (programs >= 1000) {
      EXPECT_GT(evictions, programs / 100);
    }
  }
}

/// A block leaves its flags uncomputed for one that sets them all, and that has not been executed
/// when it is written again and then reads them.
TEST_P(HotCode, CodeThatABranchLeadsToMayChangeBeforeItIsExecuted) {
  constexpr uint32_t start = Bench::ram_base + 0x100, target = start + 0x84;
  std::vector<uint32_t> results;
  for (const Executor executor : {Executor::stepping, GetParam()}) {
    Bench b;
    choose(b.core, executor);
    b.core.reset();
    // 0: cmp r0,r1; beq target; strh r3,[r4]; mov r0,r1; b 0
    const uint16_t code[] = {0x4288, 0xD03F, 0x8023, 0x4608, 0xE7FA};
    const uint16_t behind[] = {0x4292, 0xE7BB};  // cmp r2,r2, to be adcs r5,r5; b 0
    std::memcpy(&b.ram[start - Bench::ram_base], code, sizeof code);
    std::memcpy(&b.ram[target - Bench::ram_base], behind, sizeof behind);
    b.core.set_reg(1, 5);
    b.core.set_reg(3, 0x416D);
    b.core.set_reg(4, target);
    b.core.set_reg(15, start);
    b.core.run(120);
    results.push_back(b.core.reg(5));
  }
  EXPECT_GT(results[0], 3u);
  EXPECT_EQ(results[0], results[1]);
}

/// ... and that changes what the flags are computed from before they are read.
TEST_P(HotCode, FlagsLeftToTheNextBlockAreSeenRightInIt) {
  std::vector<uint32_t> seen[2];
  for (const Executor executor : {Executor::stepping, GetParam()}) {
    Bench b;
    choose(b.core, executor);
    b.at_once = executor != Executor::stepping;
    std::vector<uint32_t>& words = seen[executor == Executor::stepping ? 0 : 1];
    b.on_write = [&](uint32_t) { words.push_back(b.core.state().xpsr()); };
    // 0: cmp r0,r1; b 1; nop; 1: mov r0,r2; str r2,[r7]; cmp r2,r3; mov r0,r3; b 0
    b.start({0x4288, 0xE000, 0xBF00, 0x4610, 0x603A, 0x429A, 0x4618, 0xE7F7});
    for (const unsigned n : {0u, 1u, 3u}) b.core.set_reg(n, 5);
    b.core.set_reg(7, 0x40000000);
    b.core.run(400);
  }
  EXPECT_GT(seen[0].size(), 10u);
  EXPECT_EQ(seen[0], seen[1]);
  EXPECT_EQ(seen[0].back() >> 28, 6u) << "equal: Z and C";
}

INSTANTIATE_TEST_SUITE_P(Executors, HotCode, testing::ValuesIn(fast_executors), executor_name);
INSTANTIATE_TEST_SUITE_P(HotCode, HotLoops, testing::ValuesIn(fast_cores), core_name);

}  // namespace capsoc::armv7m::test
