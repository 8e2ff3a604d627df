// Where one block runs into another without a branch: at the border of a page, and where a block is
// cut because it could take too long. What the first operation after it costs may depend on the
// last one before it. Against stepping.
#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "translated.h"

namespace capsoc::armv7m::test {
namespace {

/// Instructions that belong together, as halfwords.
struct Unit {
  const char* name;
  std::vector<uint16_t> code;
};

/// r2 and r4 hold the address of a word that holds that address.
const std::vector<Unit> units = {
    {"adds r1, #1", {0x3101}},
    {"add.w r1, r1, #1", {0xF101, 0x0101}},
    {"adds r4, #0", {0x3400}},
    {"ldr r3, [r4]", {0x6823}},
    {"ldr.w r3, [r4]", {0xF8D4, 0x3000}},
    {"ldr r2, [r2]", {0x6812}},
    {"ldr r3, [r4], #0", {0xF854, 0x3B00}},
    {"str r4, [r2]", {0x6014}},
    {"ldrd r3, r5, [r4]", {0xE9D4, 0x3500}},
    {"ldm r4, {r3, r5}", {0xE894, 0x0028}},
    {"umull r5, r6, r1, r4", {0xFBA1, 0x5604}},
    {"nop", {0xBF00}},
    {"nop.w", {0xF3AF, 0x8000}},
    {"it eq; addeq r1, #1", {0xBF08, 0x3101}},
    {"it ne; ldrne r3, [r4]", {0xBF18, 0x6823}},
};

void append(std::vector<uint16_t>& code, const Unit& unit) {
  code.insert(code.end(), unit.code.begin(), unit.code.end());
}

/// Both executors run a loop whose code is at an address; what the translator did.
TranslationCounts loop_agrees(const std::vector<uint16_t>& code, uint32_t address,
                              unsigned wait_states, uint64_t cycles) {
  return translation_agrees([&](Bench& b) {
    const auto size = static_cast<uint32_t>(b.ram.size());
    b.core.unmap_memory(Bench::ram_base, size);
    b.core.map_memory(Bench::ram_base, size, b.ram.data(), true, wait_states);
    put(b, Bench::ram_base, Bench::ram_base);
    b.start({});
    uint32_t at = address;
    for (const uint16_t halfword : code) b.code(at, {halfword}), at += 2;
    const uint32_t back = (address - (at + 4)) / 2 & 0x7FF;
    b.code(at, {static_cast<uint16_t>(0xE000u | back)});
    b.core.set_reg(15, address);
    b.core.set_reg(2, Bench::ram_base);
    b.core.set_reg(4, Bench::ram_base);
    // Limits at many places: where they stop in a block, a trail is left as well.
    for (uint64_t limit = cycles / 10; limit <= cycles; limit += cycles / 10) b.core.run(limit);
  });
}

}  // namespace

TEST(Borders, OfAPageCostWhatNeighboursCost) {
  constexpr uint32_t border = 0x3000;
  for (const Unit& last : units)
    for (const Unit& first : units) {
      SCOPED_TRACE(std::string(last.name) + " | " + first.name);
      const auto before = static_cast<uint32_t>(2 * last.code.size());
      std::vector<uint16_t> code = {0xBF00};
      append(code, last);
      append(code, first);
      // At first twenty turns from the border on, which leave translated code there.
      append(code, {"adds r7, #1; cmp r7, #20; blt border", {0x3701, 0x2F14}});
      const auto turn = static_cast<uint32_t>(2 * (code.size() - 1)) - before;
      code.push_back(static_cast<uint16_t>(0xDB00u | (((0u - turn - 4) >> 1) & 0xFF)));
      const TranslationCounts counts = loop_agrees(code, border - before - 2, 0, 4000);
      if (!has_translator()) continue;
      // All of it, or all but what may depend on its neighbour.
      EXPECT_GT(counts.instructions, counts.executed / 4);
    }
}

/// What does not depend on its neighbour never leaves translated code there.
TEST(Borders, OfAPageAreCrossedInTranslatedCode) {
  if (!has_translator()) GTEST_SKIP();
  for (const Unit& last : units) {
    SCOPED_TRACE(last.name);
    const auto before = static_cast<uint32_t>(2 * last.code.size());
    std::vector<uint16_t> code = last.code;
    append(code, units[1]);
    const TranslationCounts counts = loop_agrees(code, 0x3000 - before, 0, 100000);
    EXPECT_GT(counts.instructions, counts.executed * 98 / 100);
  }
}

/// The code after the border goes without the code before it.
TEST(Borders, OfAPageLeadToWhatIsThereNow) {
  for (const Unit& last : units) {
    SCOPED_TRACE(last.name);
    const uint32_t start = 0x3000 - static_cast<uint32_t>(2 * last.code.size());
    translation_agrees([&](Bench& b) {
      put(b, Bench::ram_base, Bench::ram_base);
      b.start({});
      uint32_t at = start;
      for (const uint16_t halfword : last.code) b.code(at, {halfword}), at += 2;
      const uint32_t back = (start - (at + 2 + 4)) / 2 & 0x7FF;
      b.core.set_reg(2, Bench::ram_base);
      b.core.set_reg(4, Bench::ram_base);
      b.core.set_reg(15, start);
      for (const uint16_t add : {0x3001, 0x3005, 0x3600}) {  // adds r0, #1; r0, #5; r6, #0
        b.code(at, {add, static_cast<uint16_t>(0xE000u | back)});
        b.core.run(b.core.cycles() + 2000);
      }
    });
  }
}

TEST(Borders, OfABlockThatIsCutCostWhatNeighboursCost) {
  uint64_t instructions = 0, executed = 0;
  for (unsigned seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    std::vector<uint16_t> code;
    for (unsigned n = 0; n < 60; ++n) append(code, units[random() % units.size()]);
    const TranslationCounts counts = loop_agrees(code, Bench::program, seed % 8, 100000);
    instructions += counts.instructions;
    executed += counts.executed;
    if (HasFailure()) return;
  }
  if (has_translator()) {
    EXPECT_GT(instructions, executed * 98 / 100);
  }
}

/// A block that got flags uncomputed sets N and Z, is cut, and a fault after that stacks C.
TEST(Borders, OfABlockThatIsCutKeepTheFlagsThatWereLeftToIt) {
  const Outcome outcome = agreed([](Bench& b) {
    shorten_ram(b);
    b.core.unmap_memory(Bench::ram_base, end_of_ram - Bench::ram_base);
    b.core.map_memory(Bench::ram_base, end_of_ram - Bench::ram_base, b.ram.data(), true, 7);
    // sub.w r0,r0,#1; cmp r0,r1; b .+2;  movs r2,#1; add.w r6,r6,#4
    std::vector<uint16_t> code = {0xF1A0, 0x0001, 0x4288, 0xE7FF, 0x2201, 0xF106, 0x0604};
    for (unsigned n = 0; n < 20; ++n) append(code, {"ldr r3,[r5]; nop", {0x682B, 0xBF00}});
    append(code, {"ldr r4,[r6]; cmp r2,r1", {0x6834, 0x428A}});
    code.push_back(static_cast<uint16_t>(0xE7FEu - code.size()));  // b to the start
    b.start({});
    for (std::size_t i = 0; i < code.size(); ++i)
      b.code(Bench::program + 2 * static_cast<uint32_t>(i), {code[i]});
    b.core.set_reg(0, 12);  // carries in the turns that link the blocks, not in the tenth
    b.core.set_reg(1, 5);
    b.core.set_reg(5, Bench::ram_base);
    b.core.set_reg(6, end_of_ram - 40);
    b.core.set_reg(13, stack_in_short_ram);
  });
  ASSERT_GT(outcome.faults, 0u);
  EXPECT_EQ(stacked_flags(outcome), 0u) << "C of the comparison before the branch";
}

}  // namespace capsoc::armv7m::test
