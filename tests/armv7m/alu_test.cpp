#include "armv7m/isa/alu.h"

#include <gtest/gtest.h>

namespace capsoc::armv7m {

// A2.2.1
TEST(Alu, AddWithCarryReportsCarryAndOverflow) {
  AddResult r = add_with_carry(0x7FFFFFFF, 1, false);
  EXPECT_EQ(r.value, 0x80000000u);
  EXPECT_FALSE(r.carry);
  EXPECT_TRUE(r.overflow);
  r = add_with_carry(5, ~5u, true);  // 5 - 5: no borrow is a carry
  EXPECT_EQ(r.value, 0u);
  EXPECT_TRUE(r.carry);
  EXPECT_FALSE(r.overflow);
}

// A7.4.2
TEST(Alu, ShiftsByThirtyTwoAndMoreFollowTheManual) {
  EXPECT_TRUE(shift_c(1, ShiftType::lsl, 32, false).carry);
  EXPECT_FALSE(shift_c(1, ShiftType::lsl, 33, true).carry);
  EXPECT_TRUE(shift_c(0x80000000, ShiftType::lsr, 32, false).carry);
  EXPECT_EQ(shift_c(0x80000000, ShiftType::asr, 200, false).value, 0xFFFFFFFFu);
  EXPECT_EQ(shift_c(0x12345678, ShiftType::ror, 32, false).value, 0x12345678u);
  EXPECT_TRUE(shift_c(0x80000000, ShiftType::ror, 64, false).carry);
  EXPECT_EQ(shift_c(1, ShiftType::rrx, 1, true).value, 0x80000000u);
  EXPECT_TRUE(shift_c(7, ShiftType::lsl, 0, true).carry);
}

// A5.3.2
TEST(Alu, ModifiedImmediatesExpand) {
  EXPECT_EQ(thumb_expand_imm_c(0x1AB).value, 0x00AB00ABu);
  EXPECT_EQ(thumb_expand_imm_c(0x2AB).value, 0xAB00AB00u);
  EXPECT_EQ(thumb_expand_imm_c(0x3AB).value, 0xABABABABu);
  EXPECT_EQ(thumb_expand_imm_c(0x400).value, 0x80000000u);
  EXPECT_EQ(thumb_expand_imm_c(0xFFF).value, 0x000001FEu);
}

TEST(Alu, SaturationClampsAndTells) {
  EXPECT_EQ(signed_sat_q(200, 8).value, 127u);
  EXPECT_TRUE(signed_sat_q(-200, 8).saturated);
  EXPECT_EQ(unsigned_sat_q(-1, 8).value, 0u);
  EXPECT_FALSE(unsigned_sat_q(255, 8).saturated);
}

}  // namespace capsoc::armv7m
