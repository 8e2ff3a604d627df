// Which flags are live, and what each row of operations.def says of them.
#include "armv7m/isa/flag_liveness.h"

#include <gtest/gtest.h>

#include <initializer_list>

#include "armv7m/isa/decoder.h"

namespace capsoc::armv7m::test {
namespace {

constexpr uint8_t cv = flag::c | flag::v;

constexpr uint16_t movs_r0_1 = 0x2001, adds_r1_1 = 0x3101, adcs_r1_r0 = 0x4141, lsls_r0_r1 = 0x4088,
                   muls_r0_r1 = 0x4348, cmp_r0_r8 = 0x4540, cmp_r0_pc = 0x4578, mov_r8_r0 = 0x4680,
                   mov_pc_r0 = 0x4687, mov_sp_r0 = 0x4685, ldr_r2_r3 = 0x681A, str_r2_r3 = 0x601A,
                   nop = 0xBF00, it_eq = 0xBF08, it_hi = 0xBF88, beq = 0xD001;

std::vector<DecodedOp> decoded(std::initializer_list<uint16_t> halfwords) {
  std::vector<DecodedOp> ops;
  uint32_t address = 0x1000;
  uint8_t it = 0;
  for (const uint16_t* at = halfwords.begin(); at != halfwords.end();) {
    const bool wide = is_wide(*at);
    ops.push_back(decode(address, at[0], wide ? at[1] : uint16_t{0}, it));
    it = ops.back().it_after;
    address += ops.back().size;
    at += wide ? 2 : 1;
  }
  return ops;
}

/// The flags that are live after the first of some operations.
unsigned behind_first(std::initializer_list<uint16_t> halfwords) {
  const std::vector<DecodedOp> ops = decoded(halfwords);
  return live_flags(
      ops.size(), [&](std::size_t i) -> const DecodedOp& { return ops[i]; },
      [](std::size_t) { return false; })[0];
}

}  // namespace

TEST(FlagLiveness, AllFlagsAreLiveAtTheEndOfABlock) {
  EXPECT_EQ(behind_first({movs_r0_1}), flag::all);
  EXPECT_EQ(behind_first({movs_r0_1, nop}), flag::all);
}

TEST(FlagLiveness, FlagsDieWhereTheyAreSetAgainUnread) {
  EXPECT_EQ(behind_first({movs_r0_1, adds_r1_1}), 0u);
  EXPECT_EQ(behind_first({movs_r0_1, nop, adds_r1_1}), 0u);
  EXPECT_EQ(behind_first({movs_r0_1, cmp_r0_r8}), 0u);
  EXPECT_EQ(behind_first({movs_r0_1, cmp_r0_pc}), 0u);
  EXPECT_EQ(behind_first({movs_r0_1, mov_r8_r0, adds_r1_1}), 0u);
  EXPECT_EQ(behind_first({adds_r1_1, movs_r0_1}), cv) << "MOVS keeps C and V";
  EXPECT_EQ(behind_first({adds_r1_1, muls_r0_r1}), cv) << "MULS keeps C and V";
}

TEST(FlagLiveness, WhatReadsAFlagKeepsItAlive) {
  EXPECT_EQ(behind_first({movs_r0_1, adcs_r1_r0}), flag::c);
  EXPECT_EQ(behind_first({movs_r0_1, lsls_r0_r1, adds_r1_1}), flag::c) << "a shift by zero keeps C";
  EXPECT_EQ(behind_first({movs_r0_1, beq, adds_r1_1}), flag::all) << "the block may end";
}

TEST(FlagLiveness, AConditionReadsItsFlagsAndKillsNone) {
  EXPECT_EQ(behind_first({movs_r0_1, it_eq, mov_r8_r0, adds_r1_1}), flag::nz);
  EXPECT_EQ(behind_first({movs_r0_1, it_hi, mov_r8_r0, adds_r1_1}), flag::nz | flag::c);
  EXPECT_EQ(behind_first({movs_r0_1, it_eq, cmp_r0_r8, adds_r1_1}), flag::nz);
  EXPECT_EQ(behind_first({movs_r0_1, it_eq, cmp_r0_r8}), flag::all);
}

TEST(FlagLiveness, AllFlagsAreLiveWhereTheBlockMayBeLeft) {
  for (const uint16_t leaves : {ldr_r2_r3, str_r2_r3, mov_pc_r0, mov_sp_r0})
    EXPECT_EQ(behind_first({movs_r0_1, leaves, adds_r1_1}), flag::all) << leaves;
  EXPECT_EQ(behind_first({movs_r0_1, 0xFBB1, 0xF0F2, adds_r1_1}), flag::all) << "UDIV";
  const std::vector<DecodedOp> ops = decoded({movs_r0_1, nop, adds_r1_1});
  const auto live = live_flags(
      ops.size(), [&](std::size_t i) -> const DecodedOp& { return ops[i]; },
      [](std::size_t i) { return i == 1; });
  EXPECT_EQ(live[0], flag::all) << "the executor has an exit of its own at the second";
}

TEST(FlagLiveness, OnlyWhatHasAnSBitHasAFormWithout) {
  for (const uint16_t has : {movs_r0_1, adds_r1_1, adcs_r1_r0, lsls_r0_r1})
    EXPECT_TRUE(has_form_without_flags(decoded({has})[0])) << has;
  for (const uint16_t has_not : {muls_r0_r1, cmp_r0_pc, mov_r8_r0, ldr_r2_r3, nop})
    EXPECT_FALSE(has_form_without_flags(decoded({has_not})[0])) << has_not;
}

// Every row of the table, with the S bit and without, under a condition and without.
TEST(FlagLiveness, WhatIsKilledIsSetAndACopyUnderAConditionKillsNothing) {
  for (unsigned n = 0; n < static_cast<unsigned>(Operation::count); ++n) {
    for (const bool set_flags : {false, true}) {
      DecodedOp op;
      op.operation = static_cast<Operation>(n);
      op.set_flags = set_flags;
      const FlagUse use = flag_use(op);
      EXPECT_EQ(use.kills & ~use.sets, 0) << n;
      EXPECT_TRUE(set_flags || use.sets == 0 || traits(op.operation).flags == FlagEffect::compares);
      if (traits(op.operation).flags == FlagEffect::unknown) {
        EXPECT_EQ(use.reads, flag::all) << n;
        EXPECT_TRUE(use.exits) << n;
      }
      for (uint8_t condition = 0; condition < condition_always; ++condition) {
        op.condition = condition;
        const FlagUse conditional = flag_use(op);
        EXPECT_EQ(conditional.kills, 0) << n;
        EXPECT_EQ(conditional.sets, use.sets) << n;
        EXPECT_EQ(conditional.reads, use.reads | flags_of_condition(condition)) << n;
        EXPECT_EQ(conditional.exits, use.exits) << n;
      }
    }
  }
}

}  // namespace capsoc::armv7m::test
