// Every encoding of the DSP extension with operands at their borders, against Unicorn's Cortex-M4,
// in every executor.
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
#include "bench.h"
#include "executors.h"
#include "oracle_policy.h"

namespace capsoc::armv7m::test {
namespace {

constexpr uint32_t borders[] = {
    0x00000000, 0x00000001, 0x00007FFF, 0x00008000, 0x0000FFFF, 0x7FFF7FFF, 0x80008000, 0x7FFF8000,
    0x80007FFF, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 0x80FF7F01, 0x7F80807F, 0x40004000, 0xC0018001};
constexpr unsigned pairs = 16 * 16;
constexpr uint32_t q_flag = 1u << 27, ge_flags = 0xF0000;

/// A line of isa.def with one value of its numbers.
struct Variant {
  const Encoding* line;
  uint32_t bits;
  uint32_t address;
};

/// Spreads the low bits of `values` over the bits of `mask`.
uint32_t spread(uint32_t values, uint32_t mask) {
  uint32_t bits = 0;
  for (; mask != 0; mask &= mask - 1, values >>= 1)
    if ((values & 1) != 0) bits |= mask & (0u - mask);
  return bits;
}

/// The bits of a pattern that have this letter.
uint32_t bits_of(const Encoding& line, char letter) {
  uint32_t bits = 0;
  for (const char* p = line.pattern; *p != 0; ++p) bits = bits << 1 | (*p == letter ? 1u : 0u);
  return bits;
}

/// Rd or RdLo, Rn, Rm, Ra or RdHi: some of them in host registers, some not.
constexpr unsigned places[][4] = {{0, 1, 2, 3}, {8, 9, 10, 11}, {6, 12, 7, 8}, {4, 5, 9, 6}};

/// The row of `places` that a variant has.
const unsigned* places_of(std::size_t number) {
  return places[number % std::size(places)];
}

std::vector<Variant> all_variants() {
  std::vector<Variant> variants;
  uint32_t address = Bench::program;
  for (unsigned i = 0; i < encoding_count(); ++i) {
    const Encoding& line = encodings()[i];
    if (line.set != instruction_set::v7em) continue;
    const uint32_t numbers = bits_of(line, 'i') | bits_of(line, 'b');
    for (uint32_t value = 0; value < 1u << __builtin_popcount(numbers); ++value, address += 8) {
      const unsigned* registers = places_of(variants.size());
      uint32_t bits = line.value | spread(value, numbers);
      for (const char letter : {'d', 'n', 'm', 'a'}) {
        const unsigned which = letter == 'd' ? 0 : letter == 'n' ? 1 : letter == 'm' ? 2 : 3;
        bits |= spread(registers[which], bits_of(line, letter));
      }
      variants.push_back({&line, bits, address});
    }
  }
  return variants;
}

class Dsp : public testing::TestWithParam<Executor> {
 protected:
  Bench b{0, cortex_m4};
  uc_engine* uc = nullptr;
  std::vector<Variant> variants = all_variants();
  std::mt19937 random{1};
  std::map<std::string, unsigned> compared;
  std::map<std::string, std::set<uint32_t>> ge_seen;
  std::set<std::string> set_q, differ;

  void SetUp() override {
    choose(b.core, GetParam());
    for (const Variant& each : variants)
      b.code(each.address,
             {static_cast<uint16_t>(each.bits >> 16), static_cast<uint16_t>(each.bits), 0xE7FE});
    b.core.reset();
    ASSERT_EQ(uc_open(UC_ARCH_ARM, UC_MODE_THUMB, &uc), UC_ERR_OK);
    ASSERT_EQ(uc_ctl_set_cpu_model(uc, UC_CPU_ARM_CORTEX_M4), UC_ERR_OK);
    uc_mem_map_ptr(uc, 0, b.flash.size(), UC_PROT_ALL, b.flash.data());
  }
  void TearDown() override { uc_close(uc); }

  void compare(const Variant& variant, const unsigned* where, uint32_t n, uint32_t m) {
    std::array<uint32_t, 13> values{};
    for (uint32_t& value : values) value = random();
    values[where[0]] = borders[random() % std::size(borders)];
    values[where[3]] = borders[random() % std::size(borders)];
    values[where[1]] = n;
    values[where[2]] = m;
    const uint32_t psr = (random() & apsr_bits(cortex_m4)) | 1u << 24;
    for (unsigned r = 0; r < values.size(); ++r) {
      b.core.set_reg(r, values[r]);
      uc_reg_write(uc, UC_ARM_REG_R0 + static_cast<int>(r), &values[r]);
    }
    b.core.edit().set_xpsr(psr);
    b.core.set_reg(15, variant.address);
    write_flags(uc, psr);
    ASSERT_EQ(uc_emu_start(uc, variant.address | 1, 0, 0, 1), UC_ERR_OK) << variant.line->name;
    b.core.run(b.core.cycles() + 60);
    ASSERT_EQ(b.core.fault_count(), 0u) << variant.line->name;
    ASSERT_EQ(b.core.reg(15), variant.address + 4);
    bool same = true;
    for (unsigned r = 0; r < values.size(); ++r) {
      uint32_t theirs = 0;
      uc_reg_read(uc, UC_ARM_REG_R0 + static_cast<int>(r), &theirs);
      same = same && theirs == b.core.reg(r);
    }
    uint32_t flags = 0;
    uc_reg_read(uc, UC_ARM_REG_XPSR, &flags);
    same = same && ((flags ^ b.core.state().xpsr()) & apsr_bits(cortex_m4)) == 0;
    const char* name = variant.line->name;
    if (!same) differ.insert(name);
    ++compared[name];
    if ((flags & ~psr & q_flag) != 0) set_q.insert(name);
    if (((flags ^ psr) & ge_flags) != 0) ge_seen[name];
    if (const auto found = ge_seen.find(name); found != ge_seen.end())
      found->second.insert(flags & ge_flags);
  }
};

INSTANTIATE_TEST_SUITE_P(Executors, Dsp, testing::ValuesIn(all_executors), executor_name);

TEST_P(Dsp, EveryEncodingAgreesWithUnicornAtTheBordersOfItsOperands) {
  std::map<std::string, unsigned> expected;
  for (std::size_t i = 0; i < variants.size(); ++i) {
    expected[variants[i].line->name] += pairs;
    for (const uint32_t n : borders)
      for (const uint32_t m : borders)
        ASSERT_NO_FATAL_FAILURE(compare(variants[i], places_of(i), n, m));
  }
  EXPECT_EQ(differ, std::set<std::string>{});
  EXPECT_EQ(compared, expected);
  EXPECT_EQ(compared.size(), 70u) << "lines";
  std::printf("DSP extension: %zu lines, %zu variants, %zu operations compared\n", compared.size(),
              variants.size(), variants.size() * pairs);
  // A7.7, "if ... APSR.Q = '1'"
  EXPECT_EQ(set_q, (std::set<std::string>{"qadd_t1", "qdadd_t1", "qsub_t1", "qdsub_t1", "ssat16_t1",
                                          "usat16_t1", "smlaxy_t1", "smlaw_t1", "smuad_t1",
                                          "smlad_t1", "smlsd_t1"}));
  // A7.7, "APSR.GE"
  std::map<std::string, std::size_t> values;
  for (const auto& [name, seen] : ge_seen) values[name] = seen.size();
  EXPECT_EQ(values, (std::map<std::string, std::size_t>{{"sadd16_t1", 4},
                                                        {"sasx_t1", 4},
                                                        {"ssax_t1", 4},
                                                        {"ssub16_t1", 4},
                                                        {"sadd8_t1", 16},
                                                        {"ssub8_t1", 16},
                                                        {"uadd16_t1", 4},
                                                        {"uasx_t1", 4},
                                                        {"usax_t1", 4},
                                                        {"usub16_t1", 4},
                                                        {"uadd8_t1", 16},
                                                        {"usub8_t1", 16}}));
  if (GetParam() == Executor::translator && has_translator()) {
    EXPECT_GE(b.core.translation()->instructions, variants.size() * pairs);
  }
}

}  // namespace
}  // namespace capsoc::armv7m::test
