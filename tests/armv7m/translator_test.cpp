// What only translated code can get wrong: the ends of its memory windows, literals that became
// constants, the two bits of SP that are always zero. Against stepping.
#include <gtest/gtest.h>

#include <ostream>
#include <string>
#include <vector>

#include "translated.h"

namespace capsoc::armv7m::test {

/// A transfer to or from r0, which moves by a stride each time.
struct Walk {
  const char* name;
  std::vector<uint16_t> transfer;
  int stride;
};

std::ostream& operator<<(std::ostream& out, const Walk& walk) {
  return out << walk.name;
}

/// A transfer of several words that walks over the end of the memory.
class OverTheEnd : public testing::TestWithParam<Walk> {};

TEST_P(OverTheEnd, IsAFaultAndTouchesNothingBehindIt) {
  const Walk& walk = GetParam();
  for (const uint32_t distance : {4u, 8u, 12u, 16u}) {
    SCOPED_TRACE(distance);
    const Outcome outcome = agreed([&](Bench& b) {
      shorten_ram(b);
      uint32_t at = Bench::program;
      b.start({});
      for (const uint16_t halfword : walk.transfer) b.code(at, {halfword}), at += 2;
      const uint32_t add = (walk.stride < 0 ? 0x3800u : 0x3000u) |
                           static_cast<uint32_t>(walk.stride < 0 ? -walk.stride : walk.stride);
      const uint32_t back = (Bench::program - (at + 2 + 4)) / 2 & 0x7FF;
      b.code(at, {static_cast<uint16_t>(add), static_cast<uint16_t>(0xE000u | back)});
      // From 10 transfers before the end, so that the code is there when it comes.
      const uint32_t border = walk.stride < 0 ? Bench::ram_base : end_of_ram;
      const uint32_t before = border - static_cast<uint32_t>(10 * walk.stride);
      b.core.set_reg(0, walk.stride < 0 ? before + distance : before - distance);
      b.core.set_reg(1, 0x11111111);
      b.core.set_reg(2, 0x22222222);
    });
    EXPECT_GT(outcome.faults, 0u);
    for (std::size_t i = 0x8000; i < outcome.ram.size(); ++i)
      ASSERT_EQ(outcome.ram[i], static_cast<uint8_t>(i * 7)) << "behind the end: " << i;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Translator, OverTheEnd,
    testing::Values(Walk{"Stm", {0xE880, 0x0006}, 8}, Walk{"Ldm", {0xE890, 0x0006}, 8},
                    Walk{"StmOfThree", {0xE880, 0x000E}, 4}, Walk{"Strd", {0xE9C0, 0x1200}, 8},
                    Walk{"Ldrd", {0xE9D0, 0x1200}, 8}, Walk{"StmdbDown", {0xE900, 0x0006}, -8},
                    Walk{"LdmdbDown", {0xE910, 0x0006}, -8}, Walk{"Str", {0x6001}, 8},
                    Walk{"Ldrh", {0x8801}, 2}, Walk{"StrUnaligned", {0x6001}, 3},
                    Walk{"LdrUnaligned", {0x6801}, 3}, Walk{"StrhUnaligned", {0x8001}, 3},
                    Walk{"LdrshUnaligned", {0xF9B0, 0x1000}, 3},
                    Walk{"StrUnalignedDown", {0x6001}, -3}),
    [](const auto& walk) { return walk.param.name; });

TEST(Unaligned, AccessesTakeACycleMoreForEachPart) {
  // ldr r1,[r0]; strh r1,[r0,#8]; adds r0,#1; b .-6
  const Outcome outcome = agreed([](Bench& b) {
    b.start({0x6801, 0x8101, 0x3001, 0xE7FB});
    b.core.set_reg(0, Bench::ram_base);
  });
  EXPECT_EQ(outcome.faults, 0u);
}
TEST(Unaligned, AccessesAreFaultsAsSoonAsTheyAreTrapped) {
  const Outcome outcome = agreed([](Bench& b) {
    b.start({0x6801, 0x8101, 0x3001, 0xE7FB});
    b.core.set_reg(0, Bench::ram_base);
    b.core.run(500);  // hot
    const uint32_t ccr = 1u << 9 | 1u << 3;
    b.core.debug_write(0xE000ED14, &ccr, 4);
  });
  EXPECT_GT(outcome.faults, 0u);
}

/// The same where SP is the base, whose bits the code does not look at.
TEST(OverTheEndBySp, APushBelowTheMemoryIsAFault) {
  const Outcome outcome = agreed([](Bench& b) {
    shorten_ram(b);
    b.start({0xB406, 0xE7FD});  // push {r1,r2}; b
    b.core.set_reg(13, Bench::ram_base + 0x84);
  });
  EXPECT_GT(outcome.faults, 0u);
}

TEST(OverTheEndBySp, AReturnThatTakesThePcFromBehindTheMemoryIsAFault) {
  const Outcome outcome = agreed([](Bench& b) {
    shorten_ram(b);
    b.start({0x4685, 0xBD02, 0xBF00, 0xBF00, 0x3008, 0xE7F9});  // mov sp,r0; pop {r1,pc}; ...
    const uint32_t behind = Bench::program + 8;                 // adds r0,#8; b
    for (uint32_t at = end_of_ram - 128; at < end_of_ram + 64; at += 4) put(b, at, behind | 1);
    b.core.set_reg(0, end_of_ram - 84);
  });
  EXPECT_GT(outcome.faults, 0u);
}

/// A literal that its block has as a constant is code: who writes it drops the block.
TEST(Literals, ALiteralThatIsWrittenIsReadAnew) {
  for (const unsigned distance : {16u, 64u, 256u, 1000u}) {  // in and after the code's own line
    SCOPED_TRACE(distance);
    constexpr uint32_t start = Bench::ram_base + 0x1000;
    const Outcome outcome = agreed([&](Bench& b) {
      // ldr r0,[pc,...]; adds r3,r0,#1; str r3,[r2]; b
      const uint16_t code[] = {static_cast<uint16_t>(0x4800 | (distance - 4) / 4), 0x1C43, 0x6013,
                               0xE7FB};
      std::memcpy(&b.ram[start - Bench::ram_base], code, sizeof code);
      put(b, start + distance, 1);
      b.start({});
      b.core.set_reg(15, start);
      b.core.set_reg(2, start + distance);
      b.core.set_reg(3, 0);
    });
    EXPECT_GT(outcome.registers[3], 100u) << "one more each time";
  }
}

/// A store that runs from a page without code into one with code, next to the window.
TEST(OverTheEndOfAPage, AnStmThatWritesTheCodeOfTheNextPageIsSeen) {
  constexpr uint32_t start = Bench::ram_base + 0x3000;
  const Outcome outcome = agreed([&](Bench& b) {
    // adds r3,#1, to be adds r3,#2; nop; stm.w r0,{r1,r2}; b
    const uint16_t code[] = {0x3301, 0xBF00, 0xE880, 0x0006, 0xE7FA};
    b.start({});
    std::memcpy(&b.ram[start - Bench::ram_base], code, sizeof code);
    b.core.set_reg(15, start);
    b.core.set_reg(0, start - 4);
    b.core.set_reg(2, 0xBF003302);
    b.core.set_reg(3, 0);
    b.core.run(20);
  });
  EXPECT_EQ(outcome.registers[3] % 2, 1u) << "one by one, then two by two";
}

/// ... and a load from memory with wait states over its end.
TEST(OverTheEndOfAPage, AnLdmBehindTheEndOfSlowMemoryIsAFault) {
  const Outcome outcome = agreed([](Bench& b) {
    b.core.unmap_memory(Bench::ram_base, 65536);
    b.core.map_memory(Bench::ram_base, 0x8000, b.ram.data(), true, 2);
    b.start({0xE890, 0x0006, 0x3004, 0xE7FB});  // ldm.w r0,{r1,r2}; adds r0,#4; b
    b.core.set_reg(0, end_of_ram - 40);
  });
  EXPECT_GT(outcome.faults, 0u);
}

/// The window for stores is older than the code that a store changes.
TEST(Windows, CodeThatIsDecodedLaterIsNotWrittenThroughAnOlderWindow) {
  constexpr uint32_t start = Bench::ram_base + 0x1000, other = Bench::ram_base + 0x5000;
  agreed([&](Bench& b) {
    // adds r4,#1; blx r5; strh r6,[r7]; eors r6,r2; b   and   adds r3,#1 or #2; bx lr
    const uint16_t code[] = {0x3401, 0x47A8, 0x803E, 0x4056, 0xE7FA};
    const uint16_t called[] = {0x3301, 0x4770};
    b.start({});
    std::memcpy(&b.ram[start - Bench::ram_base], code, sizeof code);
    std::memcpy(&b.ram[other - Bench::ram_base], called, sizeof called);
    b.core.set_reg(15, start);
    b.core.set_reg(2, 3);
    b.core.set_reg(3, 0);
    b.core.set_reg(5, other | 1);
    b.core.set_reg(6, 0x3302);
    b.core.set_reg(7, other);
  });
}

TEST(Windows, AScaledIndexBelowZeroReachesWhatIsBelowItsBase) {
  const Outcome outcome = agreed([](Bench& b) {
    // ldr.w r1,[r0,r2,lsl #2]; str.w r1,[r3,r2,lsl #2]; adds r2,#1; b
    b.start({0xF850, 0x1022, 0xF843, 0x1022, 0x3201, 0xE7F9});
    for (uint32_t at = 0; at < 0x400; at += 4) put(b, Bench::ram_base + at, at);
    b.core.set_reg(0, Bench::ram_base + 0x200);
    b.core.set_reg(2, 0u - 100);
    b.core.set_reg(3, Bench::ram_base + 0x1200);
  });
  EXPECT_EQ(outcome.faults, 0u);
  EXPECT_NE(outcome.ram[0x1200 - 4], 0u);
}

TEST(Windows, AnAddressThatWrapsIsThatOfItsLower32Bits) {
  const Outcome outcome = agreed([](Bench& b) {
    b.start({0x6881, 0x1852, 0xE7FC});  // ldr r1,[r0,#8]; adds r2,r2,r1; b
    b.core.set_reg(0, Bench::program);
    b.core.run(200);  // hot, from the memory that begins at 0
    b.core.set_reg(0, 0u - 4);
  });
  EXPECT_EQ(outcome.registers[1], Bench::program | 1) << "the reset vector";
}

/// The longest row of pages without code begins after some, and then after others.
TEST(Windows, TheLongestRowForStoresMayMove) {
  constexpr uint32_t moved_over = Bench::ram_base + 0x3000;
  agreed([](Bench& b) {
    // blx r5; str r1,[r0]; ldr r2,[r0]; adds r3,r3,r2; adds r1,#1; b
    b.start({0x47A8, 0x6001, 0x6802, 0x189B, 0x3101, 0xE7F9});
    b.core.set_reg(0, Bench::ram_base + 0x6000);
    for (const uint32_t place : {0x1000u, 0xE000u, 0x9000u, 0x3000u}) {
      put(b, Bench::ram_base + place, 0x47703601);  // adds r6,#1; bx lr
      b.core.set_reg(5, (Bench::ram_base + place) | 1);
      b.core.run(b.core.cycles() + 500);
    }
    b.core.set_reg(0, moved_over);
    b.core.set_reg(1, 0x47703602);  // to add more each time
  });
}

TEST(Limits, AreKeptByBlocksThatWaitForSlowMemory) {
  constexpr unsigned wait_states = 5;
  Bench stepping(wait_states), translated(wait_states);
  stepping.core.set_executor(Executor::stepping);
  choose(translated.core, Executor::translator);
  for (Bench* b : {&stepping, &translated}) {
    // ldmia r0,{r1-r4} three times; b .-12: the code waits, and so do the words that it loads
    b->start({0xE890, 0x001E, 0xE890, 0x001E, 0xE890, 0x001E, 0xE7F8});
    b->core.set_reg(0, 0x2000);
  }
  for (uint64_t until = 1; until < 100'000; until += 613) {
    for (Bench* b : {&stepping, &translated}) b->core.run(until);
    ASSERT_EQ(outcome_of(stepping), outcome_of(translated)) << until;
  }
}
/// Every kind of access to memory with wait states, and one that is not aligned.
TEST(Windows, OfSlowMemoryTakeItsWaitStates) {
  constexpr uint64_t cycles = 20'000;
  const auto instructions_with = [](unsigned wait_states) {
    return agreed(
               [wait_states](Bench& b) {
                 b.core.unmap_memory(Bench::ram_base, 65536);
                 b.core.map_memory(Bench::ram_base, 65536, b.ram.data(), true, wait_states);
                 // str r1,[r0]; ldr r2,[r0,#1]; ldrd r4,r5,[r0]; stm r0,{r1,r2}; ldrb r3,[r0];
                 // bl f; b .-24;  f: push {r4,lr}; adds r1,#1; pop {r4,pc}
                 b.start({0x6001, 0xF8D0, 0x2001, 0xE9D0, 0x4500, 0xE880, 0x0006, 0x7803, 0xF000,
                          0xF801, 0xE7F4, 0xB510, 0x3101, 0xBD10});
                 b.core.set_reg(0, Bench::ram_base + 0x100);
               },
               cycles)
        .instructions;
  };
  EXPECT_GT(instructions_with(0), 2 * instructions_with(3));
}

TEST(Branches, BxToAnEvenAddressIsAFaultThoughItsCodeIsTranslated) {
  const Outcome outcome = agreed([](Bench& b) {
    b.start({0x4051, 0x4708});  // eors r1,r2; bx r1: odd, and even in the end
    b.core.set_reg(1, Bench::program);
    b.core.set_reg(2, 1);
    b.core.run(3);
    b.core.set_reg(1, Bench::program | 1);
    b.core.set_reg(2, 0);
    b.core.run(100);
    b.core.set_reg(2, 1);
  });
  EXPECT_GT(outcome.faults, 0u);
}

/// A state may be set, or restored, with bits in SP that no instruction can put there.
TEST(StackPointer, AStateWithOddBitsInItGoesOnAsInterpreted) {
  agreed([](Bench& b) {
    b.start({0x9101, 0x9A01, 0x3101, 0xE7FB});  // str r1,[sp,#4]; ldr r2,[sp,#4]; adds r1,#1; b
    b.core.run(100);
    b.core.edit().r[13] += 2;
  });
}

/// Operands that random ones hardly ever are.
TEST(Operands, AtTheirBordersGiveTheSameResultsFlagsAndCycles) {
  const std::vector<uint16_t> operations[] = {
      {0xFBA0, 0x2301},                                  // umull r2,r3,r0,r1
      {0xFB80, 0x2301},                                  // smull
      {0xFBE0, 0x2301},                                  // umlal
      {0xFBC0, 0x2301},                                  // smlal
      {0xFBB0, 0xF2F1},                                  // udiv r2,r0,r1
      {0xFB90, 0xF2F1},                                  // sdiv
      {0xFAB0, 0xF280},                                  // clz r2,r0
      {0xFA10, 0xF201},                                  // lsls r2,r0,r1
      {0xFA30, 0xF201},                                  // lsrs
      {0xFA50, 0xF201},                                  // asrs
      {0xFA70, 0xF201},                                  // rors
      {0xFA00, 0xF201},                                  // lsl
      {0xFA20, 0xF201},                                  // lsr
      {0xFA40, 0xF201},                                  // asr
      {0xFA60, 0xF201},                                  // ror
      {0x4602, 0x1892},                                  // mov r2,r0; adds r2,r2,r2
      {0x4602, 0x1A92},                                  // mov r2,r0; subs r2,r2,r2
      {0x1843, 0xEB50, 0x0201, 0xEB42, 0x0401, 0x4162},  // adds, adcs, adc, adcs
      {0x1A43, 0xEB70, 0x0201, 0xEB62, 0x0401, 0x41A2},  // subs, sbcs, sbc, sbcs
      {0xF05F, 0x4200},                                  // movs r2,#0x80000000
      {0xEA5F, 0x0230},                                  // movs r2,r0,rrx
      {0x0042, 0x4164},                                  // lsls r2,r0,#1; adcs r4,r4
      {0x0802, 0x4164},                                  // lsrs r2,r0,#32; adcs r4,r4
      {0x1002, 0x4164},                                  // asrs r2,r0,#32; adcs r4,r4
      {0x0842, 0xEA4F, 0x0331, 0x1892},  // lsrs r2,r0,#1; mov r3,r1,rrx; adds r2,r2,r2
      {0x1042, 0xEA4F, 0x0331, 0x1892},  // asrs, likewise
      // add.w r8,r8,r0; eor.w r9,r8,r1; sub.w r9,r9,r1; subs.w r8,r8,#1; mov r3,r9
      {0xEB08, 0x0800, 0xEA88, 0x0901, 0xEBA9, 0x0901, 0xF1B8, 0x0801, 0x464B},
  };
  constexpr uint32_t values[] = {
      0,      1,      31,      32,      33,         63,         64,         256,        0x7FFF,
      0x8000, 0xFFFF, 0x10000, 0x1FFFF, 0x7FFFFFFF, 0x80000000, 0xFFFF0000, 0xFFFF8000, 0xFFFFFFFF};
  for (const std::vector<uint16_t>& operation : operations) {
    Bench stepping, translated;
    stepping.core.set_executor(Executor::stepping);
    choose(translated.core, Executor::translator);
    for (Bench* b : {&stepping, &translated}) {
      b->start({0x4288});  // cmp r0,r1
      uint32_t at = Bench::program + 2;
      for (const uint16_t halfword : operation) b->code(at, {halfword}), at += 2;
      // adc.w r6,r6,r2; mrs r7,apsr; adds r5,r5,r7; adds r5,r5,r3; b
      b->code(at, {0xEB46, 0x0602, 0xF3EF, 0x8700, 0x19ED, 0x18ED});
      at += 12;
      b->code(at, {static_cast<uint16_t>(0xE000u | ((Bench::program - (at + 4)) / 2 & 0x7FF))});
    }
    for (const uint32_t x : values) {
      for (const uint32_t y : values) {
        for (Bench* b : {&stepping, &translated}) {
          b->core.set_reg(0, x);
          b->core.set_reg(1, y);
          b->core.run(b->core.cycles() + 400);
        }
        ASSERT_EQ(outcome_of(stepping), outcome_of(translated))
            << testing::PrintToString(operation) << " of " << x << " and " << y;
      }
    }
    if (has_translator()) {
      EXPECT_GT(translated.core.translation().value_or(TranslationCounts{}).instructions, 1000u);
    }
  }
}

/// SP<1:0> read as zero (B1.4.1), whatever writes SP.
TEST(StackPointer, ItsTwoLowestBitsAreZeroWhateverIsWritten) {
  const std::vector<uint16_t> writes[] = {
      {0x4685},                  // mov sp,r0
      {0xEA4F, 0x0D00},          // mov.w sp,r0
      {0x4685, 0x448D},          // mov sp,r0; add sp,r1
      {0x4685, 0xF10D, 0x0D03},  // mov sp,r0; add.w sp,sp,#3
      {0x4685, 0xF1AD, 0x0D05},  // mov sp,r0; sub.w sp,sp,#5
      {0x4685, 0xEB0D, 0x0D01},  // mov sp,r0; add.w sp,sp,r1
      {0x4685, 0xEBAD, 0x0D01},  // mov sp,r0; sub.w sp,sp,r1
      {0x4685, 0xEBAD, 0x0D41},  // mov sp,r0; sub.w sp,sp,r1,lsl #1
  };
  for (const std::vector<uint16_t>& write : writes) {
    SCOPED_TRACE(testing::PrintToString(write));
    agreed([&](Bench& b) {
      b.start({});
      uint32_t at = Bench::program;
      for (const uint16_t halfword : write) b.code(at, {halfword}), at += 2;
      // mov r3,sp; adds r4,r4,r3; adds r0,#1; push and pop, which rely on it; b
      b.code(at, {0x466B, 0x18E4, 0x3001, 0xB402, 0xBC20});
      at += 10;
      b.code(at, {static_cast<uint16_t>(0xE000u | ((Bench::program - (at + 4)) / 2 & 0x7FF))});
      b.core.set_reg(0, Bench::ram_base + 0x4000);
      b.core.set_reg(1, 7);
      b.core.set_reg(4, 0);
    });
  }
}

}  // namespace capsoc::armv7m::test
