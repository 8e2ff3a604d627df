// Random sequences of instructions against Unicorn 2: IT blocks, branches, loads and stores among
// them. The long run: CAPSOC_FUZZ=10000000 (instructions); it must reach every line of isa.def that
// the oracle knows.
#include <gtest/gtest.h>
#include <unicorn/unicorn.h>

#include <array>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "armv7m/isa/decoder.h"
#include "bench.h"
#include "board.h"
#include "oracle_policy.h"

namespace capsoc::armv7m::test {
namespace {

constexpr uint32_t code_base = 0x100000, sequence_ram_size = 0x4000, length = 48;  // halfwords

using Registers = std::array<uint32_t, 17>;  // r0 to r15, xPSR

class Sequence {
 public:
  std::vector<uint8_t> code = std::vector<uint8_t>(0x10000);
  std::vector<uint64_t> reached = std::vector<uint64_t>(encoding_count());
  uint64_t instructions = 0, sequences = 0, faults = 0;
  std::string difference;

  explicit Sequence(const OracleCore& core) : core_(core) {
    open_oracle();
    bench_.core.unmap_memory(Bench::ram_base, 65536);
    bench_.core.map_memory(Bench::ram_base, sequence_ram_size, bench_.ram.data(), true, 0);
    bench_.core.map_memory(code_base, static_cast<uint32_t>(code.size()), code.data(), false, 0);
    bench_.core.set_executor(Executor::stepping);
    for (uint8_t& byte : initial_) byte = static_cast<uint8_t>(random_());
  }
  ~Sequence() { uc_close(uc_); }
  Sequence(const Sequence&) = delete;
  Sequence& operator=(const Sequence&) = delete;

  bool run(uint32_t seed) {
    random_.seed(seed);
    // Not to see an old translation, each sequence has its own place, and what a branch from
    // elsewhere may have translated there is dropped.
    const uint32_t at = code_base + (static_cast<uint32_t>(sequences) % 512) * 128;
    // Unicorn 2.0.1 crashes in its own bookkeeping of pages after some 100,000 dropped
    // translations.
    if (++sequences % 20000 == 0) {
      uc_close(uc_);
      open_oracle();
    }
    uc_ctl_remove_cache(uc_, at, at + 128);
    write_program(at);
    std::memcpy(uc_ram_.data(), initial_.data(), sequence_ram_size);
    std::memcpy(bench_.ram.data(), initial_.data(), sequence_ram_size);
    exclusive_address_ = ~0u;
    bench_.core.reset();
    Registers start{};
    for (unsigned n = 0; n < 15; ++n) {
      start[n] = random_() % 4 == 0 ? random_() : Bench::ram_base + 0x1000 + (random_() & 0x1FFC);
      if (n == 13) start[n] = Bench::ram_base + 0x2000;
      if (foreign(start[n])) start[n] ^= 0x10000000;
      bench_.core.set_reg(n, start[n]);
      uc_reg_write(uc_, ids()[n], &start[n]);
    }
    fill_fpu(bench_.core, uc_, random_);
    const uint32_t disdefwbuf = 2;  // the oracle's bus faults are precise
    bench_.core.debug_write(0xE000E008, &disdefwbuf, 4);
    uint32_t psr = (random_() & apsr_bits(*core_.profile)) | 1u << 24;
    bench_.core.edit().set_xpsr(psr);
    bench_.core.set_reg(15, at);
    write_flags(uc_, psr);
    trace_.clear();
    // The last instruction that fits the count is announced, too, but not executed.
    error_ = uc_emu_start(uc_, at | 1, at + 2 * length, 0, 2 * length);
    if (trace_.size() > 2 * length) trace_.resize(2 * length);
    return compare(at, seed);
  }

 private:
  void open_oracle() {
    uc_open(UC_ARCH_ARM, UC_MODE_THUMB, &uc_);
    uc_ctl_set_cpu_model(uc_, core_.model);
    // Not writable: the oracle sees a change of its own block late.
    uc_mem_map_ptr(uc_, code_base, code.size(), UC_PROT_READ | UC_PROT_EXEC, code.data());
    uc_mem_map_ptr(uc_, Bench::ram_base, sequence_ram_size, UC_PROT_ALL, uc_ram_.data());
    enable_fpu(uc_);
    uc_hook hook = 0;
    uc_hook_add(uc_, &hook, UC_HOOK_CODE, reinterpret_cast<void*>(&Sequence::record), this, 1, 0);
  }
  static bool foreign(uint32_t address) {
    return address >> 28 == 0xE || address >> 28 == 4 || address >> 24 == 0x22;
  }
  static const std::array<int, 17>& ids() {
    static const std::array<int, 17> all = {
        UC_ARM_REG_R0,  UC_ARM_REG_R1, UC_ARM_REG_R2, UC_ARM_REG_R3, UC_ARM_REG_R4,  UC_ARM_REG_R5,
        UC_ARM_REG_R6,  UC_ARM_REG_R7, UC_ARM_REG_R8, UC_ARM_REG_R9, UC_ARM_REG_R10, UC_ARM_REG_R11,
        UC_ARM_REG_R12, UC_ARM_REG_SP, UC_ARM_REG_LR, UC_ARM_REG_PC, UC_ARM_REG_XPSR};
    return all;
  }
  static void record(uc_engine* uc, uint64_t, uint32_t, void* self) {
    Registers now{};
    std::array<void*, 17> places{};
    for (unsigned n = 0; n < 17; ++n) places[n] = &now[n];
    uc_reg_read_batch(uc, const_cast<int*>(ids().data()), places.data(), 17);
    static_cast<Sequence*>(self)->trace_.push_back(now);
  }

  void write_program(uint32_t at) {
    uint32_t offset = at - code_base, end = offset + 2 * length;
    auto put = [&](uint32_t halfword) {
      const auto h = static_cast<uint16_t>(halfword);
      std::memcpy(&code[offset], &h, 2);
      offset += 2;
    };
    unsigned guarded = 0;  // instructions left of an IT block
    uint8_t it = 0;
    if (is_main_) {
      put(0xF3BF);  // CLREX: the oracle's monitor outlives a sequence
      put(0x8F2F);
    }
    while (offset < end) {
      if (is_main_ && guarded == 0 && offset + 12 < end && random_() % 10 == 0) {
        const uint32_t condition = random_() % 14, mask = 1 + random_() % 15;
        it = static_cast<uint8_t>(condition << 4 | mask);
        guarded = 4 - static_cast<unsigned>(__builtin_ctz(mask));
        put(0xBF00 | it);
        continue;
      }
      const Encoding& e = encodings()[random_() % encoding_count()];
      if ((e.set & core_.profile->instruction_sets) == 0 && random_() % 64 != 0) continue;
      uint32_t bits = with_should_be_bits(e, (random_() & ~e.mask) | e.value);
      if (offset + e.length / 8 > end) {
        put(0xBF00);
        continue;
      }
      const DecodedOp op = decode(0, static_cast<uint16_t>(e.length == 32 ? bits >> 16 : bits),
                                  static_cast<uint16_t>(bits), it, *core_.profile);
      if (outside_the_oracle(op) || unpredictable(op) || known_fault(op)) continue;
      const bool transfer = is(op, kind::transfer | kind::fp_transfer);
      // More of what continues than of what ends a sequence.
      if ((ends_block(op) && random_() % 4 != 0) || (transfer && random_() % 2 != 0)) continue;
      if (guarded > 0 && (leaves(op) || op.operation == Operation::it)) continue;
      if (op.operation == Operation::undefined && random_() % 16 != 0) continue;
      if (e.length == 32) put(bits >> 16);
      put(bits);
      if (guarded > 0) --guarded;
      it = guarded > 0 ? it_advance(it) : 0;
    }
  }

  /// The oracle's registers before each instruction against ours; the last one may have faulted.
  bool compare(uint32_t at, uint32_t seed) {
    for (const Registers& theirs : trace_) {
      // The oracle does not announce instructions whose condition fails.
      while (bench_.core.reg(15) != (theirs[15] & ~1u) && in_it_block(bench_.core.state().xpsr()))
        bench_.core.step_instruction();
      const uint32_t pc = bench_.core.reg(15);
      for (unsigned n = 0; n < 16; ++n) {
        const uint32_t mine = n == 15 ? pc : bench_.core.reg(n);
        if ((theirs[n] & (n == 15 ? ~1u : ~0u)) != mine)
          return differs("r" + std::to_string(n), theirs[n], mine, seed);
      }
      if (((theirs[16] ^ bench_.core.state().xpsr()) & apsr_bits(*core_.profile)) != 0)
        return differs("flags", theirs[16], bench_.core.state().xpsr(), seed);
      uint16_t first = 0, second = 0;
      std::memcpy(&first, &code[pc - code_base], 2);
      std::memcpy(&second, &code[pc - code_base + 2], 2);
      last_ = decode(pc, first, second, 0, *core_.profile);
      const Encoding* e = find_encoding(last_.encoding, last_.size);
      if (e != nullptr && (e->set & core_.profile->instruction_sets) != 0)
        ++reached[static_cast<std::size_t>(e - encodings())];
      // A branch may have led into the middle of an instruction.
      if (!comparable(last_, in_it_block(bench_.core.state().xpsr()))) return true;
      // Two registers may meet in the part of the address space that is ours alone.
      const uint32_t sum = bench_.core.reg(last_.rn & 15) +
                           (bench_.core.reg(last_.rm & 15) << (last_.shift.amount & 3));
      const bool transfer = is(last_, kind::transfer | kind::fp_transfer | kind::table_branch);
      if (transfer && (foreign(sum) || foreign(bench_.core.reg(last_.rn & 15) + last_.imm)))
        return true;
      if (!exclusives_are_comparable()) return true;
      const uint64_t before = bench_.core.fault_count();
      bench_.core.step_instruction();
      ++instructions;
      if (bench_.core.fault_count() != before) {
        ++faults;
        // The oracle must have failed, too. After a failed store it continues for a while.
        const bool unaligned = bench_.core.last_fault().cfsr == 1u << 24;
        const bool several =
            is(last_, kind::dual_load | kind::dual_store | kind::multiple | kind::fp_transfer);
        // LDRD, STRD, LDM and STM of the oracle take any address.
        if (error_ == UC_ERR_OK && trace_.size() < 2 * length && !(unaligned && several))
          return differs("fault", 0, 1, seed);
        return true;
      }
      if (bench_.core.reg(15) < at || bench_.core.reg(15) >= at + 2 * length) return true;
    }
    return true;
  }
  static bool in_it_block(uint32_t psr) { return (psr & 0x0600FC00u) != 0; }
  static bool comparable(const DecodedOp& op, bool guarded) {
    if (op.operation == Operation::it) {
      const unsigned condition = op.imm >> 4 & 15;
      const bool several = __builtin_popcount(op.imm & 15) != 1;
      return !guarded && condition != 15 && !(condition == 14 && several);
    }
    if (op.operation == Operation::clrex) return true;
    if (guarded && (leaves(op) || op.operation == Operation::undefined)) return false;
    return !outside_the_oracle(op) && !unpredictable(op) && !known_fault(op);
  }
  /// Bytes that a load-exclusive or store-exclusive accesses.
  static unsigned exclusive_size(Operation operation) {
    switch (operation) {
      case Operation::ldrexb:
      case Operation::strexb:
        return 1;
      case Operation::ldrexh:
      case Operation::strexh:
        return 2;
      default:
        return 4;
    }
  }
  /// Our monitor is a flag, the oracle's an address and a value (A3.4 leaves both free); and it
  /// lets an unaligned STREX pass.
  bool exclusives_are_comparable() {
    const Operation o = last_.operation;
    if (!is(o, kind::exclusive)) return true;
    const uint32_t address = bench_.core.reg(last_.rn) + last_.imm;
    const bool store = is(o, kind::exclusive_store);
    const unsigned size = exclusive_size(o);
    if (store && (exclusive_address_ != address || exclusive_size_ != size || (address & 3) != 0))
      return false;
    exclusive_address_ = store ? ~0u : address;
    exclusive_size_ = size;
    return true;
  }
  bool differs(const std::string& what, uint32_t theirs, uint32_t mine, uint32_t seed) {
    char text[200];
    std::snprintf(text, sizeof(text),
                  "%s: oracle %08x, core %08x behind %08x %s, psr %08x, seed %u", what.c_str(),
                  static_cast<unsigned>(theirs), static_cast<unsigned>(mine),
                  static_cast<unsigned>(last_.address), disassemble(last_).c_str(),
                  static_cast<unsigned>(bench_.core.state().xpsr()), static_cast<unsigned>(seed));
    difference = text;
    return false;
  }

  const OracleCore core_;
  const bool is_main_ = (core_.profile->instruction_sets & instruction_set::v7m) != 0;
  uc_engine* uc_ = nullptr;
  std::vector<uint8_t> uc_ram_ = std::vector<uint8_t>(sequence_ram_size),
                       initial_ = std::vector<uint8_t>(sequence_ram_size);
  uint32_t exclusive_address_ = ~0u;
  unsigned exclusive_size_ = 0;
  Bench bench_{0, *core_.profile};
  std::mt19937 random_;
  std::vector<Registers> trace_;
  DecodedOp last_;
  uc_err error_ = UC_ERR_OK;
};

class Sequences : public testing::TestWithParam<OracleCore> {};

TEST_P(Sequences, RandomSequencesAgreeWithUnicornInstructionByInstruction) {
  const unsigned long goal = repetitions("CAPSOC_FUZZ", 60000);
  Sequence fuzz(GetParam());
  unsigned differences = 0;
  for (uint32_t seed = 1; fuzz.instructions < goal && differences < 10; ++seed) {
    if (fuzz.run(seed)) continue;
    ++differences;
    ADD_FAILURE() << fuzz.difference;
  }
  unsigned lines = 0, known = 0;
  for (unsigned i = 0; i < encoding_count(); ++i) {
    const Encoding& e = encodings()[i];
    DecodedOp op;
    op.operation = e.operation;
    if (outside_the_oracle(op) || (e.set & GetParam().profile->instruction_sets) == 0) continue;
    ++known;
    if (fuzz.reached[i] != 0) {
      ++lines;
    } else {
      std::printf("not reached: %s\n", e.name);
    }
  }
  std::printf(
      "sequences: %llu of %llu instructions, %llu ended in a fault; %u of %u lines of "
      "isa.def that the oracle knows, %u lines in all\n",
      static_cast<unsigned long long>(fuzz.sequences),
      static_cast<unsigned long long>(fuzz.instructions),
      static_cast<unsigned long long>(fuzz.faults), lines, known, encoding_count());
  EXPECT_EQ(lines, known);
}

INSTANTIATE_TEST_SUITE_P(Cores, Sequences, testing::ValuesIn(oracle_cores),
                         [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace capsoc::armv7m::test
