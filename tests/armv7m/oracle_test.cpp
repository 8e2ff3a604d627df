// The core against Unicorn 2: every 16-bit encoding and random 32-bit ones from isa.def.
#include <gtest/gtest.h>
#include <unicorn/unicorn.h>

#include <array>
#include <cstdio>
#include <map>
#include <random>
#include <string>

#include "armv7m/isa/decoder.h"
#include "bench.h"
#include "oracle_policy.h"

namespace capsoc::armv7m::test {
namespace {

constexpr uint32_t slots = 0x100000, ram_size = 0x4000;
constexpr std::array<int, 16> uc_registers = {
    UC_ARM_REG_R0,  UC_ARM_REG_R1, UC_ARM_REG_R2, UC_ARM_REG_R3, UC_ARM_REG_R4,  UC_ARM_REG_R5,
    UC_ARM_REG_R6,  UC_ARM_REG_R7, UC_ARM_REG_R8, UC_ARM_REG_R9, UC_ARM_REG_R10, UC_ARM_REG_R11,
    UC_ARM_REG_R12, UC_ARM_REG_SP, UC_ARM_REG_LR, UC_ARM_REG_PC};

class Oracle : public ::testing::TestWithParam<OracleCore> {
 protected:
  const Profile& profile = *GetParam().profile;
  uc_engine* uc = nullptr;
  std::vector<uint8_t> uc_ram = std::vector<uint8_t>(ram_size),
                       initial = std::vector<uint8_t>(ram_size);
  std::vector<uint8_t> code = std::vector<uint8_t>(0x100000);
  Bench bench{0, profile};
  std::mt19937 random{20240601};
  unsigned compared = 0, skipped = 0, faulted = 0;
  std::map<std::string, std::string> mismatches;

  void SetUp() override {
    ASSERT_EQ(uc_open(UC_ARCH_ARM, UC_MODE_THUMB, &uc), UC_ERR_OK);
    ASSERT_EQ(uc_ctl_set_cpu_model(uc, GetParam().model), UC_ERR_OK);
    uc_mem_map_ptr(uc, slots, code.size(), UC_PROT_ALL, code.data());
    uc_mem_map_ptr(uc, Bench::ram_base, ram_size, UC_PROT_ALL, uc_ram.data());
    bench.core.unmap_memory(Bench::ram_base, 65536);
    bench.core.map_memory(Bench::ram_base, ram_size, bench.ram.data(), true, 0);
    bench.core.map_memory(slots, static_cast<uint32_t>(code.size()), code.data(), true, 0);
    bench.core.unmap_memory(0, 65536);
    enable_fpu(uc);
    bench.core.set_executor(Executor::stepping);
    for (uint8_t& byte : initial) byte = static_cast<uint8_t>(random());
  }
  void TearDown() override { uc_close(uc); }

  /// The oracle's exclusive monitor outlives an instruction; our reset closes ours.
  void close_oracle_monitor() {
    constexpr uint32_t clrex = 0x8F2FF3BF, at = 0xFFF00;  // halfwords in memory order
    std::memcpy(&code[at], &clrex, 4);
    uc_emu_start(uc, (slots + at) | 1, 0, 0, 1);
  }

  /// One instruction on both; the address is a slot of `code`.
  void compare(uint32_t address, const DecodedOp& op) {
    if (outside_the_oracle(op) || unpredictable(op) || known_fault(op)) {
      ++skipped;
      return;
    }
    bench.core.reset();
    std::memcpy(bench.ram.data(), initial.data(), ram_size);
    std::memcpy(uc_ram.data(), initial.data(), ram_size);
    bench.core.map_memory(0, 65536, bench.flash.data(), false, 0);
    bench.core.reset();
    for (unsigned n = 0; n < 15; ++n) {
      uint32_t value =
          random() % 3 == 0 ? random() : Bench::ram_base + 0x1000 + (random() & 0x1FFC);
      if (random() % 8 == 0) value = random() % 40;
      // The private peripheral bus and the bit-band aliases are ours alone.
      if (value >> 28 == 0xE || value >> 28 == 4 || value >> 24 == 0x22) value ^= 0x10000000;
      if (n == 13) value = Bench::ram_base + 0x1000 + (random() & 0x1FF8);
      bench.core.set_reg(n, value);
      uc_reg_write(uc, uc_registers[n], &value);
    }
    // Two registers may still meet in our own address space.
    uint32_t sum = bench.core.reg(op.rn) + (bench.core.reg(op.rm) << (op.shift.amount & 3));
    bool table_branch = op.operation == Operation::tbb || op.operation == Operation::tbh;
    if (op.operation == Operation::tbh) sum += bench.core.reg(op.rm);
    bool indexed = table_branch || op.addressing == Addressing::reg;
    if (indexed && (sum >> 28 == 0xE || sum >> 28 == 4 || sum >> 24 == 0x22)) return;
    uint32_t flags = (random() & apsr_bits(profile)) | 1u << 24;
    bench.core.edit().set_xpsr(flags);
    bench.core.set_reg(15, address);
    write_flags(uc, flags);
    bench.core.unmap_memory(0, 65536);
    fill_fpu(bench.core, uc, random);
    if (rounds_otherwise(op, bench.core)) {
      ++skipped;
      return;
    }
    const uint32_t disdefwbuf = 2;  // the oracle's bus faults are precise
    bench.core.debug_write(0xE000E008, &disdefwbuf, 4);
    uint64_t faults = bench.core.fault_count();
    bench.core.step_instruction();
    const bool store_exclusive = is(op, kind::exclusive_store);
    if (store_exclusive) close_oracle_monitor();
    uc_err error = uc_emu_start(uc, address | 1, 0, 0, 1);
    bool our_fault = bench.core.fault_count() != faults;
    // STREX to an unaligned address does nothing instead of faulting while the monitor is open.
    if (store_exclusive && our_fault && bench.core.last_fault().cfsr == 1u << 24) {
      ++skipped;
      return;
    }
    // LDRD, STRD, LDM and STM of the oracle take any address; A3.2.1 has them aligned.
    const bool several =
        is(op, kind::dual_load | kind::dual_store | kind::multiple | kind::fp_transfer);
    if (several && our_fault && bench.core.last_fault().cfsr == 1u << 24) {
      ++skipped;
      return;
    }
    // Unicorn fetches the target of a branch within the same call.
    bool fetch_error =
        error == UC_ERR_FETCH_UNMAPPED || error == UC_ERR_EXCEPTION || error == UC_ERR_INSN_INVALID;
    bool table = is(op, kind::table_branch | kind::exclusive);
    // A table branch or exclusive before something it cannot translate is rolled back whole.
    if (!our_fault && fetch_error && table) {
      ++skipped;
      return;
    }
    if (!our_fault && fetch_error && leaves(op)) error = UC_ERR_OK;
    if (our_fault || error != UC_ERR_OK) {
      ++faulted;
      if (our_fault != (error != UC_ERR_OK))
        note(op, our_fault ? "only we fault" : uc_strerror(error));
      return;
    }
    ++compared;
    for (unsigned n = 0; n < 16; ++n) {
      uint32_t value = 0;
      uc_reg_read(uc, uc_registers[n], &value);
      if ((value & (n == 15 ? ~1u : ~0u)) != bench.core.reg(n))
        return note(op, "r" + std::to_string(n) + " " + std::to_string(value) + " not " +
                            std::to_string(bench.core.reg(n)) + " at " + std::to_string(address));
    }
    if (const std::string fp = fpu_difference(bench.core, uc); !fp.empty()) return note(op, fp);
    uint32_t psr = 0;
    uc_reg_read(uc, UC_ARM_REG_XPSR, &psr);
    if ((psr ^ bench.core.state().xpsr()) & apsr_bits(profile)) return note(op, "flags");
    if (std::memcmp(uc_ram.data(), bench.ram.data(), ram_size) != 0) note(op, "memory");
  }

  void note(const DecodedOp& op, const std::string& what) {
    const Encoding* e = find_encoding(op.encoding, op.size);
    mismatches.emplace((e ? e->name : "none") +
                           std::string(e && op.operation != Operation::undefined
                                           ? " "
                                           : std::to_string(op.encoding) + " ") +
                           what,
                       disassemble(op) + " " + std::to_string(op.encoding));
  }

  void report(const char* name) {
    std::printf("%s: %u compared, %u faults agreed, %u left out\n", name, compared, faulted,
                skipped);
    for (const auto& m : mismatches) ADD_FAILURE() << m.first << ": " << m.second;
  }
};

TEST_P(Oracle, AllSixteenBitEncodingsAgree) {
  // A branch ends what libunicorn translates: once for each of the 65,536.
  const uint16_t branch_to_itself = 0xE7FE;
  for (uint32_t h = 0; h < 65536; ++h) {
    uint16_t bits = static_cast<uint16_t>(h);
    std::memcpy(&code[4 * h], &bits, 2);
    std::memcpy(&code[4 * h + 2], &branch_to_itself, 2);
  }
  for (uint32_t h = 0; h < 65536; ++h) {
    if (is_wide(h)) continue;
    compare(slots + 4 * h, decode(slots + 4 * h, static_cast<uint16_t>(h), 0, 0, profile));
  }
  report("16-bit");
  EXPECT_GT(compared, 30000u);
}

TEST_P(Oracle, RandomThirtyTwoBitEncodingsAgree) {
  constexpr uint32_t count = 200000;
  std::vector<uint32_t> words;
  while (words.size() < count) {
    const Encoding& e = encodings()[random() % encoding_count()];
    if (e.length != 32) continue;
    if ((e.set & profile.instruction_sets) == 0 && random() % 24 != 0) continue;
    words.push_back(with_should_be_bits(e, (random() & ~e.mask) | e.value));
    uint32_t w = words.back() << 16 | words.back() >> 16;
    std::memcpy(&code[4 * (words.size() - 1)], &w, 4);
  }
  for (uint32_t k = 0; k < count; ++k) {
    uint32_t at = slots + 4 * k, w = words[k];
    compare(at, decode(at, static_cast<uint16_t>(w >> 16), static_cast<uint16_t>(w), 0, profile));
  }
  report("32-bit");
  EXPECT_GT(compared, 10000u);
}

// A5.3: an encoding without a line in isa.def is undefined to both, except for the oracle's known
// faults.
TEST_P(Oracle, WhatTheTableDoesNotHaveIsUndefined) {
  constexpr uint32_t count = 200000;
  for (uint32_t k = 0; k < count;) {
    const uint32_t bits = random(), w = bits << 16 | bits >> 16;
    if (!is_wide(bits >> 16)) continue;
    const DecodedOp op = decode(slots + 4 * k, static_cast<uint16_t>(bits >> 16),
                                static_cast<uint16_t>(bits), 0, profile);
    if (op.operation != Operation::undefined) continue;
    std::memcpy(&code[4 * k++], &w, 4);
    compare(op.address, op);
  }
  report("undefined");
  EXPECT_EQ(compared, 0u);
  EXPECT_GT(faulted, 100000u);
}

INSTANTIATE_TEST_SUITE_P(Cores, Oracle, testing::ValuesIn(oracle_cores),
                         [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace capsoc::armv7m::test
