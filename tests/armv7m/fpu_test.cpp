// Every encoding of the floating-point extension with random registers, numbers and modes, against
// Unicorn's Cortex-M4, in every executor.
#include <gtest/gtest.h>
#include <unicorn/unicorn.h>

#include <array>
#include <cstdio>
#include <map>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "armv7m/isa/decoder.h"
#include "armv7m/system/registers.h"
#include "bench.h"
#include "executors.h"
#include "oracle_policy.h"

namespace capsoc::armv7m::test {
namespace {

constexpr unsigned variants_a_line = 24, trials = 60;

/// Numbers at their borders, others of about the same size, or any bits; half-precision ones are
/// among the latter two.
uint32_t some_number(std::mt19937& random) {
  constexpr uint32_t numbers[] = {
      0,          1,          0x007FFFFF, 0x00800000, 0x00FFFFFF, 0x33000000, 0x33800001,
      0x387FC000, 0x38800000, 0x3F000000, 0x3F7FFFFF, 0x3F800000, 0x3FC00000, 0x3F800001,
      0x40200000, 0x42FE8000, 0x477FEFFF, 0x477FF000, 0x47FFE000, 0x4EFFFFFF, 0x4F000000,
      0x4F800000, 0x7F7FFFFF, 0x7F800000, 0x7F800001, 0x7FA00000, 0x7FC00000, 0x7FFFFFFF,
      0x7C007C01, 0x7E00FE01, 0x03FF0400, 0x80018001};
  const auto any = static_cast<uint32_t>(random());
  switch (random() % 4) {
    case 0:
    case 1:
      return numbers[any % std::size(numbers)] ^ (any & 0x80000000);
    case 2:
      return (any & 0x80FFFFFF) + 0x3F000000;
    default:
      return any;
  }
}

class FpuOracle : public testing::TestWithParam<Executor> {
 protected:
  static constexpr uint32_t middle = Bench::ram_base + 0x4000;
  Bench b{0, cortex_m4f};
  uc_engine* uc = nullptr;
  std::vector<uint8_t> uc_ram = std::vector<uint8_t>(65536);
  std::mt19937 random{1};
  std::map<std::string, unsigned> compared;
  std::map<std::string, std::string> differ;
  uint32_t raised = 0, modes = 0;

  void SetUp() override {
    choose(b.core, GetParam());
    ASSERT_EQ(uc_open(UC_ARCH_ARM, UC_MODE_THUMB, &uc), UC_ERR_OK);
    ASSERT_EQ(uc_ctl_set_cpu_model(uc, UC_CPU_ARM_CORTEX_M4), UC_ERR_OK);
    uc_mem_map_ptr(uc, 0, b.flash.size(), UC_PROT_ALL, b.flash.data());
    uc_mem_map_ptr(uc, Bench::ram_base, uc_ram.size(), UC_PROT_ALL, uc_ram.data());
    enable_fpu(uc);
    for (uint8_t& byte : b.ram) byte = static_cast<uint8_t>(random());
    uc_ram = b.ram;
  }
  void TearDown() override { uc_close(uc); }

  /// Any bits through the pattern that mean this line and are allowed.
  uint32_t draw(const Encoding& line, uint32_t address) {
    while (true) {
      const auto bits =
          with_should_be_bits(line, (static_cast<uint32_t>(random()) & ~line.mask) | line.value);
      const DecodedOp op = decode(address, static_cast<uint16_t>(bits >> 16),
                                  static_cast<uint16_t>(bits), 0, cortex_m4f);
      if (&line_of(op) == &line && !unpredictable(op)) return bits;
    }
  }

  DecodedOp decode_at(uint32_t address) {
    uint16_t halfwords[2];
    std::memcpy(halfwords, &b.flash[address], 4);
    return decode(address, halfwords[0], halfwords[1], 0, cortex_m4f);
  }

  void compare(const Encoding& line, uint32_t address, bool stores) {
    for (int r = 0; r < 15; ++r) {
      const uint32_t value = middle + (random() & 0x7FC);
      b.core.set_reg(static_cast<unsigned>(r), value);
      uc_reg_write(uc, UC_ARM_REG_R0 + r, &value);
      if (r < 13) continue;
      uc_reg_write(uc, r == 13 ? UC_ARM_REG_SP : UC_ARM_REG_LR, &value);
    }
    State& state = b.core.edit();
    state.set_control(State::control_fpca);
    for (unsigned n = 0; n < Fpu::registers; ++n) {
      const uint32_t value = some_number(random);
      state.fpu.set_s(n, value);
      uc_reg_write(uc, UC_ARM_REG_S0 + static_cast<int>(n), &value);
    }
    Fpscr fpscr(static_cast<uint32_t>(random()) & ~Fpscr::exceptions);
    // Half of the operations in the only mode in which translated code lets the host compute.
    if (random() % 2 == 0) fpscr = Fpscr((fpscr.bits() & Fpscr::nzcv) | Fpscr::inexact);
    state.fpu.status() = fpscr;
    constexpr uint32_t rmode = 3u << 22;
    if (rounds_otherwise(decode_at(address), b.core)) fpscr = Fpscr(fpscr.bits() & ~rmode);
    state.fpu.status() = fpscr;
    uint32_t word = fpscr.bits();
    uc_reg_write(uc, UC_ARM_REG_FPSCR, &word);
    const uint32_t psr = (static_cast<uint32_t>(random()) & apsr_bits(cortex_m4f)) | 1u << 24;
    state.set_xpsr(psr);
    b.core.set_reg(15, address);
    write_flags(uc, psr);
    ASSERT_EQ(uc_emu_start(uc, address | 1, 0, 0, 1), UC_ERR_OK) << line.name;
    b.core.run(b.core.cycles() + 100);
    ASSERT_EQ(b.core.fault_count(), 0u) << line.name;
    ASSERT_EQ(b.core.reg(15), address + 4) << line.name;
    for (unsigned r = 0; r < 15; ++r) {
      uint32_t theirs = 0;
      uc_reg_read(uc,
                  r == 13   ? static_cast<int>(UC_ARM_REG_SP)
                  : r == 14 ? static_cast<int>(UC_ARM_REG_LR)
                            : UC_ARM_REG_R0 + static_cast<int>(r),
                  &theirs);
      expect_same(line, "r" + std::to_string(r), b.core.reg(r), theirs);
    }
    const Fpu& fpu = b.core.state().fpu;
    for (unsigned n = 0; n < Fpu::registers; ++n) {
      uint32_t theirs = 0;
      uc_reg_read(uc, UC_ARM_REG_S0 + static_cast<int>(n), &theirs);
      expect_same(line, "s" + std::to_string(n), fpu.s(n), theirs);
    }
    uint32_t status = 0, flags = 0;
    uc_reg_read(uc, UC_ARM_REG_FPSCR, &status);
    expect_same(line, "fpscr", fpu.status().bits(), status);
    uc_reg_read(uc, UC_ARM_REG_XPSR, &flags);
    expect_same(line, "xpsr", b.core.state().xpsr() & apsr_bits(cortex_m4f),
                flags & apsr_bits(cortex_m4f));
    if (stores && uc_ram != b.ram) differ.emplace(line.name, "memory");
    ++compared[line.name];
    raised |= status & Fpscr::exceptions & ~fpscr.bits();
    modes |= 1u << (fpscr.bits() >> 22 & 31);
  }
  void expect_same(const Encoding& line, const std::string& what, uint32_t mine, uint32_t theirs) {
    if (mine == theirs) return;
    char text[160];
    std::snprintf(text, sizeof text, "%s is %08x, %08x to Unicorn: %s", what.c_str(),
                  static_cast<unsigned>(mine), static_cast<unsigned>(theirs), now_.c_str());
    differ.emplace(line.name, text);
  }
  std::string now_;  ///< the text of the instruction that is compared
};

INSTANTIATE_TEST_SUITE_P(Executors, FpuOracle, testing::ValuesIn(all_executors), executor_name);

TEST_P(FpuOracle, EveryEncodingAgreesWithUnicorn) {
  std::map<std::string, unsigned> expected;
  struct Placed {
    const Encoding* line;
    uint32_t bits, address;
  };
  std::vector<Placed> variants;
  uint32_t address = Bench::program;
  for (unsigned i = 0; i < encoding_count(); ++i) {
    const Encoding& line = encodings()[i];
    if (line.set != instruction_set::fpv4 || line.operation == Operation::fp_undefined) continue;
    for (unsigned n = 0; n < variants_a_line; ++n, address += 8) {
      const uint32_t bits = draw(line, address);
      variants.push_back({&line, bits, address});
      b.code(address, {static_cast<uint16_t>(bits >> 16), static_cast<uint16_t>(bits), 0xE7FE});
    }
    expected[line.name] = variants_a_line * trials;
  }
  b.core.reset();
  enable_fpu(b.core);
  for (unsigned n = 0; n < trials; ++n) {
    for (const Placed& each : variants) {
      const DecodedOp op = decode_at(each.address);
      now_ = disassemble(op);
      ASSERT_NO_FATAL_FAILURE(
          compare(*each.line, each.address, is(op, kind::fp_store | kind::fp_store_multiple)));
    }
  }
  EXPECT_EQ(differ, (std::map<std::string, std::string>{}));
  EXPECT_EQ(compared, expected);
  EXPECT_EQ(compared.size(), 54u) << "lines";
  if (GetParam() == Executor::translator && has_translator()) {
    EXPECT_GT(b.core.translation().value_or(TranslationCounts{}).instructions, 2 * trials);
  }
  EXPECT_EQ(raised, Fpscr::exceptions) << "every flag was raised";
  EXPECT_EQ(modes, 0xFFFFFFFFu) << "RMode, FZ, DN and AHP in every combination";
  std::printf("floating-point extension: %zu lines, %zu variants, %zu operations compared\n",
              compared.size(), variants.size(), variants.size() * trials);
}

}  // namespace
}  // namespace capsoc::armv7m::test
