// How many bits a priority has (B1.5.4): what the registers read back, which exceptions preempt one
// another, and that a program which writes bits that do not exist is notified of. Both executors,
// every width that the architecture allows.
#include <gtest/gtest.h>

#include <string>
#include <tuple>
#include <vector>

#include "bench.h"
#include "executors.h"

namespace capsoc::armv7m::test {
namespace {

constexpr uint32_t ipr0 = 0xE000E400, ipr7 = 0xE000E41C, shpr1 = 0xE000ED18, aircr = 0xE000ED0C,
                   ispr0 = 0xE000E200, iser0 = 0xE000E100, aircr_key = 0x05FA0000;

class Priorities : public ::testing::TestWithParam<std::tuple<Executor, unsigned>> {
 protected:
  Bench b;
  struct Told {
    DroppedPriority what;
    uint32_t pc;
  };
  std::vector<Told> told;

  void SetUp() override {
    choose(b.core, std::get<0>(GetParam()));
    b.core.set_priority_bits(bits());
    b.core.listeners().priority = [this](const DroppedPriority& d) {
      told.push_back({d, b.core.reg(15)});
    };
  }
  static unsigned bits() { return std::get<1>(GetParam()); }
  /// The implemented bits of one field, of each of four.
  static uint32_t mask() { return 0xFF & ~((1U << (8 - bits())) - 1); }
  static uint32_t masks() { return mask() * 0x01010101U; }

  /// Executes `code` with r0 and r1 set and an instruction before and after it in the same block.
  void run(std::initializer_list<uint16_t> code, uint32_t r0, uint32_t r1) {
    std::vector<uint16_t> all = {0xBF00};  // nop
    all.insert(all.end(), code);
    all.insert(all.end(), {0xBF00, 0xE7FE});
    b.core.invalidate_code(Bench::program, 256);
    std::memcpy(&b.flash[Bench::program], all.data(), 2 * all.size());
    b.core.set_reg(15, Bench::program);
    b.core.set_reg(0, r0);
    b.core.set_reg(1, r1);
    b.core.run(b.core.cycles() + 100);
  }
  void store(uint32_t address, uint32_t value) { run({0x6001}, address, value); }  // str r1,[r0]
  void store_byte(uint32_t address, uint32_t value) { run({0x7001}, address, value); }
  void start() { b.start({0xE7FE}); }
};

TEST_P(Priorities, InterruptFieldsReadBackTheImplementedBits) {
  start();
  store(ipr0, 0xFFFFFFFF);
  store(ipr7, 0x12345678);
  EXPECT_EQ(b.peek(ipr0), masks());
  EXPECT_EQ(b.peek(ipr7), 0x12345678 & masks());
}
TEST_P(Priorities, AByteIsWrittenAlone) {
  start();
  store_byte(ipr0 + 2, 0xFF);
  EXPECT_EQ(b.peek(ipr0), mask() << 16);
  run({0x6001, 0x7882}, ipr0, 0xA55A5AA5);  // str r1,[r0]; ldrb r2,[r0,#2]
  EXPECT_EQ(b.core.reg(2), 0x5A & mask());
}
// B3.2.10 to B3.2.12: SHPR2 has SVCall alone, SHPR3 not exception 13.
TEST_P(Priorities, SystemHandlersReadBackTheImplementedBits) {
  start();
  for (uint32_t i = 0; i < 3; ++i) store(shpr1 + 4 * i, 0xFFFFFFFF);
  EXPECT_EQ(b.peek(shpr1), masks() & 0x00FFFFFF);
  EXPECT_EQ(b.peek(shpr1 + 4), masks() & 0xFF000000);
  EXPECT_EQ(b.peek(shpr1 + 8), masks() & 0xFFFF00FF);
}
// B1.4.3
TEST_P(Priorities, BasepriReadsBackTheImplementedBits) {
  start();
  run({0xF381, 0x8811, 0xF3EF, 0x8211}, 0, 0x1FF);  // msr basepri,r1; mrs r2,basepri
  EXPECT_EQ(b.core.reg(2), mask());
  EXPECT_EQ(b.core.state().basepri, mask());
  b.core.edit().set_basepri(0xA5);  // a debugger's
  EXPECT_EQ(b.core.state().basepri, 0xA5 & mask());
}
TEST_P(Priorities, BasepriMaxOnlyRaises) {
  start();
  // msr basepri_max: 0xA0, 0xC0 (lower), 0x60 (higher), 0
  for (const auto& [value, expected] :
       {std::pair{0xA0U, 0xA0U}, {0xC0U, 0xA0U}, {0x60U, 0x60U}, {0U, 0x60U}}) {
    run({0xF381, 0x8812}, 0, value);
    EXPECT_EQ(b.core.state().basepri, expected);
  }
  EXPECT_TRUE(told.empty());
}
// B1.5.4: bits PRIGROUP to 0 are the subpriority, which never preempts.
TEST_P(Priorities, TheGroupPreemptsAndTheSubpriorityDoesNot) {
  // The handler of interrupt 0, at the lower priority, pends 1 and counts in r4; 1's is r5 := r4.
  b.code(0x4000 + 32 * 16, {0x6032, 0xBF00, 0x3401, 0x4770});  // str r2,[r6]; nop; adds r4; bx lr
  b.code(0x4000 + 32 * 17, {0x0025, 0x3501, 0x4770});          // movs r5,r4; adds r5,#1; bx lr
  for (uint32_t group = 0; group < 8; ++group)
    for (uint32_t bit = 0x80; bit != 0; bit >>= 1) {
      start();
      store(iser0, 3);
      store(aircr, aircr_key | group << 8);
      EXPECT_EQ(b.peek(aircr) >> 8 & 7, group);
      store(ipr0, bit);  // interrupt 1 has priority 0
      b.core.set_reg(2, 2);
      b.core.set_reg(4, 0);
      b.core.set_reg(5, 0);
      b.core.set_reg(6, ispr0);
      store(ispr0, 1);
      const bool preempts = (bit & mask()) != 0 && bit > (1U << group);
      EXPECT_EQ(b.core.reg(5), preempts ? 1U : 2U) << "PRIGROUP " << group << " bit " << bit;
    }
}
// Where the groups are the same the subpriority decides who goes first (B1.5.4).
TEST_P(Priorities, TheSubpriorityDecidesWhoIsTakenFirst) {
  b.code(0x4000 + 32 * 16, {0x00A4, 0x3401, 0x4770});  // lsls r4,#2; adds r4,#1; bx lr
  b.code(0x4000 + 32 * 17, {0x00A4, 0x3402, 0x4770});
  const uint32_t lowest_bit = 1U << (8 - bits());
  for (const uint32_t first : {0U, lowest_bit}) {
    start();
    store(iser0, 3);
    store(aircr, aircr_key | 7 << 8);
    store(ipr0, first | (lowest_bit - first) << 8);
    b.core.set_reg(4, 0);
    store(ispr0, 3);
    EXPECT_EQ(b.core.reg(4), first == 0 ? 4U + 2 : 8U + 1);
  }
}
// ExecutionPriority(): BASEPRI counts by its group, too.
TEST_P(Priorities, BasepriMasksItsGroup) {
  b.code(0x4000 + 32 * 16, {0x2401, 0x4770});  // movs r4,#1; bx lr
  const uint32_t unit = 1U << (8 - bits());
  for (uint32_t group = 0; group < 8; ++group) {
    start();
    store(iser0, 1);
    store(aircr, aircr_key | group << 8);
    store(ipr0, 0x80);
    run({0xF381, 0x8811}, 0, 0x80 + unit);
    b.core.set_reg(4, 0);
    store(ispr0, 1);
    // The same group unless the lowest implemented bit is in it.
    EXPECT_EQ(b.core.reg(4), unit > (1U << group) ? 1U : 0U) << "PRIGROUP " << group;
    run({0xF381, 0x8811}, 0, 0);
    EXPECT_EQ(b.core.reg(4), 1U);
  }
}

// What a program is notified of.
TEST_P(Priorities, DroppedBitsAreToldOnceWithTheInstruction) {
  start();
  store(ipr0, 0x11000000);
  store_byte(ipr7 + 1, 0x11);
  ASSERT_EQ(told.size(), bits() == 8 ? 0U : 1U);
  if (told.empty()) return;
  EXPECT_EQ(told[0].what.address, ipr0);
  EXPECT_EQ(told[0].what.value, 0x11000000U);
  EXPECT_EQ(told[0].what.all_ones, bits() == 7);  // bit 0 is all that is dropped
  EXPECT_EQ(told[0].pc, Bench::program + 2);
}
TEST_P(Priorities, BitsThatAreAllOnesAreToldApart) {
  start();
  store_byte(ipr0 + 1, 0xFF);
  store(shpr1 + 8, 0x00FF0000);
  ASSERT_EQ(told.size(), bits() == 8 ? 0U : 1U);
  if (told.empty()) return;
  EXPECT_EQ(told[0].what.address, ipr0);
  EXPECT_EQ(told[0].what.value, 0xFF00U);
  EXPECT_TRUE(told[0].what.all_ones);
  run({0xF381, 0x8811}, 0, 0xFF);
  EXPECT_EQ(told.size(), 1U);
  run({0xF381, 0x8811}, 0, 0xBF);  // FreeRTOS: 191, "equivalent to 0xa0"
  store(ipr7, 0xBFFFDFFF);
  EXPECT_EQ(told.size(), 1U);
  if (bits() == 7) return;
  run({0xF381, 0x8811}, 0, 1);
  ASSERT_EQ(told.size(), 2U);
  EXPECT_EQ(told[1].what.address, 0U);
  EXPECT_EQ(told[1].what.value, 1U);
  EXPECT_FALSE(told[1].what.all_ones);
  EXPECT_EQ(told[1].pc, Bench::program + 2);
}
TEST_P(Priorities, WhatLosesNothingIsNotToldOf) {
  start();
  store(ipr0, masks());
  store(shpr1 + 4, 0x00FFFFFF);  // reserved fields
  run({0xF381, 0x8811}, 0, 0xF00 | mask());
  const uint32_t ones = 0x01010101;
  b.core.debug_write(ipr7, &ones, 4);
  EXPECT_TRUE(told.empty());
  run({0x6001, 0x6801}, ipr0, masks());  // the program continues
  EXPECT_EQ(b.core.reg(1), masks());
}

INSTANTIATE_TEST_SUITE_P(Both, Priorities,
                         ::testing::Combine(::testing::ValuesIn(all_executors),
                                            ::testing::Range(3U, 9U)),
                         [](const auto& p) {
                           const testing::TestParamInfo<Executor> executor(std::get<0>(p.param), 0);
                           return executor_name(executor) + std::to_string(std::get<1>(p.param));
                         });

TEST(PriorityBits, OtherNumbersCountAsTheNearest) {
  for (const auto& [bits, mask] : {std::pair{0U, 0xE0U}, {2U, 0xE0U}, {9U, 0xFFU}, {99U, 0xFFU}}) {
    Bench b;
    b.core.set_priority_bits(bits);
    b.core.edit().set_basepri(0xFF);
    EXPECT_EQ(b.core.state().basepri, mask);
  }
}

}  // namespace
}  // namespace capsoc::armv7m::test
