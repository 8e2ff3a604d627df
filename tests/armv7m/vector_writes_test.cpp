// Stores next to and into watched memory: code, and the vector table while a listener is notified
// of writes there. Each executor must do and report the same.
#include <gtest/gtest.h>

#include <cstring>
#include <tuple>
#include <vector>

#include "bench.h"
#include "executors.h"
#include "translated.h"

namespace capsoc::armv7m::test {
namespace {

constexpr uint32_t vtor = 0xE000ED08, table_size = 4 * 48;

struct Told {
  uint32_t address, value, pc;
  unsigned size;
  uint64_t cycle;
  bool operator==(const Told& o) const {
    return std::tie(address, value, pc, size, cycle) ==
           std::tie(o.address, o.value, o.pc, o.size, o.cycle);
  }
};

void write(Bench& b, uint32_t address, uint32_t value) {
  b.core.debug_write(address, &value, 4);
}

void listen(Bench& b, std::vector<Told>& told, std::size_t most = ~std::size_t{0}) {
  b.core.listeners().vectors = [&b, &told, most](const VectorWrite& write) {
    told.push_back({write.address, write.value, b.core.reg(15), write.size, b.core.cycles()});
    return told.size() < most;
  };
}

/// The same vectors at another place.
void move_table(Bench& b, uint32_t table) {
  std::memcpy(&b.ram[table - Bench::ram_base], b.flash.data(), table_size);
  write(b, vtor, table);
}

struct Sweep {
  const char* name;
  std::vector<uint16_t> code;  // r0 moves, r1 counts
  uint32_t begins_before;      // the table
  unsigned told;               // writes into it
};

const Sweep sweeps[] = {
    {"words", {0x6001, 0x3004, 0x3101, 0xE7FB}, 128, 48},
    {"halfwords", {0x8001, 0x3002, 0x3101, 0xE7FB}, 128, 96},
    {"bytes", {0x7001, 0x3001, 0x3101, 0xE7FB}, 128, 192},
    {"words that are not aligned", {0x6001, 0x3005, 0x3101, 0xE7FB}, 128, 0},
    {"pairs", {0xE9C0, 0x1200, 0x3004, 0x3101, 0xE7FA}, 128, 96},
    {"eight by STM", {0xE880, 0x01FE, 0x3004, 0x3101, 0xE7FA}, 128, 8 * 48},
};

class VectorWrites : public testing::TestWithParam<uint32_t> {};

TEST_P(VectorWrites, AreToldAndThoseBesideThemAreNot) {
  const uint32_t table = Bench::ram_base + GetParam();
  for (const Sweep& sweep : sweeps) {
    SCOPED_TRACE(sweep.name);
    std::vector<Told> told[2];
    unsigned n = 0;
    const Outcome outcome = agreed(
        [&](Bench& b) {
          listen(b, told[n++]);
          b.start({});
          std::memcpy(&b.flash[Bench::program], sweep.code.data(), 2 * sweep.code.size());
          move_table(b, table);
          b.core.set_reg(0, table - sweep.begins_before);
        },
        6000);
    EXPECT_TRUE(told[0] == told[1]) << told[0].size() << " and " << told[1].size();
    if (sweep.told != 0) {
      EXPECT_EQ(told[0].size(), sweep.told);
    }
    for (const Told& each : told[0]) EXPECT_LT(each.address - table, table_size);
    EXPECT_EQ(outcome.faults, 0u);
    EXPECT_GT(outcome.registers[0], table + table_size);
  }
}

TEST_P(VectorWrites, AreToldOfBitBandAliases) {
  const uint32_t table = Bench::ram_base + GetParam();
  std::vector<Told> told[2];
  unsigned n = 0;
  agreed(
      [&](Bench& b) {
        listen(b, told[n++]);
        b.start({0x3101, 0x6001, 0x3040, 0xE7FB});
        move_table(b, table);
        b.core.set_reg(0, 0x22000000 + 32 * (GetParam() - 64));
      },
      3000);
  EXPECT_TRUE(told[0] == told[1]) << told[0].size() << " and " << told[1].size();
  EXPECT_EQ(told[0].size(), table_size / 2);
}

/// SVC whose frames come nearer to the table, and into it.
TEST_P(VectorWrites, AreToldOfFrames) {
  const uint32_t table = Bench::ram_base + GetParam();
  std::vector<Told> told[2];
  unsigned n = 0;
  const Outcome outcome = agreed(
      [&](Bench& b) {
        listen(b, told[n++]);
        b.start({0xDF00, 0xB082, 0xE7FC});  // svc; sub sp,#8; b
        move_table(b, table);
        b.core.set_reg(13, table + table_size + 96);
      },
      500);
  EXPECT_TRUE(told[0] == told[1]) << told[0].size() << " and " << told[1].size();
  EXPECT_GT(told[0].size(), 8u);
  EXPECT_EQ(outcome.faults, 0u);
}

/// The first words of an STM drop the code of the page, the others are in the table.
TEST_P(VectorWrites, AreToldBehindCodeThatTheSameStmChanges) {
  const uint32_t table = Bench::ram_base + GetParam();
  std::vector<Told> told[2];
  unsigned n = 0;
  agreed([&](Bench& b) {
    listen(b, told[n++]);
    b.start({0x47A8, 0xE880, 0x01FE, 0x3101, 0xE7FA});  // blx r5; stm.w r0,{r1-r8}; adds r1,#1; b
    put(b, table - 32, 0x47704770);                     // bx lr
    move_table(b, table);
    b.core.set_reg(0, table - 16);
    b.core.set_reg(5, (table - 32) | 1);
  });
  EXPECT_TRUE(told[0] == told[1]) << told[0].size() << " and " << told[1].size();
  ASSERT_GT(told[0].size(), 40u);
  EXPECT_EQ(told[0].front().address, table);
}

/// ... at the beginning, in the middle and over the end of a page.
INSTANTIATE_TEST_SUITE_P(Places, VectorWrites, testing::Values(0x3000u, 0x3480u, 0x3F80u));

TEST(VectorTable, IsWatchedWhereItWasMovedTo) {
  constexpr uint32_t first = Bench::ram_base + 0x3000, second = Bench::ram_base + 0x3100;
  std::vector<Told> told[2];
  unsigned n = 0;
  agreed([&](Bench& b) {
    std::vector<Told>& mine = told[n++];
    listen(b, mine);
    b.start({0x6001, 0x6011, 0x3101, 0xE7FB});  // str r1,[r0]; str r1,[r2]; adds r1,#1; b
    b.core.set_reg(0, first);
    b.core.set_reg(2, second);
    for (const uint32_t table : {first, second}) {
      move_table(b, table);
      b.core.run(b.core.cycles() + 500);
    }
    ASSERT_FALSE(mine.empty());
    EXPECT_EQ(mine.front().address, first);
    EXPECT_EQ(mine.back().address, second);
  });
  EXPECT_TRUE(told[0] == told[1]);
}

TEST(VectorTable, IsNoLongerWatchedWhenTheListenerHasEnough) {
  constexpr uint32_t table = Bench::ram_base + 0x3000;
  std::vector<Told> told[2];
  unsigned n = 0;
  const Outcome outcome = agreed([&](Bench& b) {
    listen(b, told[n++], 5);
    b.start({0x6001, 0x3101, 0xE7FC});  // str r1,[r0]; adds r1,#1; b
    move_table(b, table);
    b.core.set_reg(0, table + 64);
  });
  EXPECT_TRUE(told[0] == told[1]);
  EXPECT_EQ(told[0].size(), 5u);
  uint32_t last = 0;
  std::memcpy(&last, &outcome.ram[0x3040], 4);
  EXPECT_GT(last, 100u);
}

/// Code that a block stores next to, and then into.
TEST(BesideCode, StoresThatReachItChangeIt) {
  constexpr uint32_t start = Bench::ram_base + 0x1000, other = Bench::ram_base + 0x1800;
  for (const std::vector<uint16_t>& code :
       {std::vector<uint16_t>{0x47A8, 0x603A, 0x3704, 0xE7FB},  // blx r5; str r2,[r7]
        {0x47A8, 0xE887, 0x0006, 0x3704, 0xE7FA},               // ... stm.w r7,{r1,r2}
        {0x47A8, 0xE9C7, 0x1200, 0x3704, 0xE7FA}}) {            // ... strd r1,r2,[r7]
    const Outcome outcome = agreed([&](Bench& b) {
      b.start({});
      std::memcpy(&b.ram[start - Bench::ram_base], code.data(), 2 * code.size());
      put(b, other, 0x47703301);  // adds r3,#1; bx lr
      b.core.set_reg(15, start);
      b.core.set_reg(1, 0x47703304);
      b.core.set_reg(2, 0x47703302);
      b.core.set_reg(3, 0);
      b.core.set_reg(5, other | 1);
      b.core.set_reg(7, other - 256);
    });
    EXPECT_EQ(outcome.faults, 0u);
    EXPECT_GT(outcome.registers[3], 150u) << "by more than one in the end";
    EXPECT_GT(outcome.registers[7], other + 128);
  }
}

TEST(BesideCode, NothingIsWrittenWhereThePageIsReadOnly) {
  const Outcome outcome = agreed([](Bench& b) {
    b.start({0x6001, 0x3101, 0xE7FC});  // str r1,[r0]; adds r1,#1; b
    b.core.set_reg(0, Bench::program + 0x800);
    write(b, 0xE000ED24, 0);  // faults are HardFaults, which return
  });
  EXPECT_GT(outcome.faults, 0u);
}

TEST(BesideCode, NothingIsWrittenWhereTheMpuForbidsIt) {
  constexpr uint32_t start = Bench::ram_base + 0x1000;
  const Outcome outcome = agreed([](Bench& b) {
    b.start({});
    // HardFault steps over the store: ldr r0,[sp,#24]; adds r0,#2; str r0,[sp,#24]; bx lr
    b.code(0x4000 + 32 * 3, {0x9806, 0x3002, 0x9006, 0x4770});
    put(b, start, 0x31016001);  // str r1,[r0]; adds r1,#1; b
    put(b, start + 4, 0xE7FC);
    b.core.set_reg(15, start);
    b.core.set_reg(0, start + 0x800);
    b.core.run(500);  // hot before
    write(b, 0xE000ED98, 0);
    write(b, 0xE000ED9C, start);
    write(b, 0xE000EDA0, 0x06000000 | 11 << 1 | 1);
    write(b, 0xE000ED94, 5);
  });
  EXPECT_GT(outcome.faults, 10u);
}

/// A frame that is stacked over code.
TEST(BesideCode, AFrameOverItChangesIt) {
  constexpr uint32_t other = Bench::ram_base + 0x1800;
  const Outcome outcome = agreed([&](Bench& b) {
    b.start({0x47A8, 0xDF00, 0xE7FC});  // blx r5; svc; b
    put(b, other, 0x47703301);          // adds r3,#1; bx lr
    b.core.set_reg(12, 0x47703302);
    b.core.set_reg(3, 0);
    b.core.set_reg(5, other | 1);
    b.core.set_reg(13, other + 16);  // from another line
  });
  EXPECT_EQ(outcome.registers[3] % 2, 1u) << "one once, then two by two";
  EXPECT_GT(outcome.registers[3], 20u);
}

TEST(Frames, TakeTheWaitStatesOfTheStack) {
  const auto cycles_with = [](unsigned wait_states) {
    Bench b;
    b.core.unmap_memory(Bench::ram_base, 65536);
    b.core.map_memory(Bench::ram_base, 65536, b.ram.data(), true, wait_states);
    b.start({0xDF00, 0xBF00});
    while (b.core.reg(15) != Bench::program + 2) b.core.step_instruction();
    return b.core.cycles();
  };
  EXPECT_EQ(cycles_with(3) - cycles_with(0), 3u * 16);
}

TEST(Frames, AreHeldAgainstTheMpu) {
  Bench b;
  b.start({0xDF00, 0xBF00});
  write(b, 0xE000ED98, 0);
  write(b, 0xE000ED9C, Bench::ram_base);
  write(b, 0xE000EDA0, 0x06000000 | 14 << 1 | 1);  // read-only
  write(b, 0xE000ED94, 5);
  b.core.step_instruction();
  EXPECT_EQ(b.core.last_fault().cfsr, 1u << 4) << "MSTKERR";
  EXPECT_EQ(b.peek(Bench::stack - 4), 0u) << "xPSR";
}

/// What an indirect branch led to last must not be executed from then on.
TEST(JumpCache, ForgetsWhatTheMpuForbids) {
  constexpr uint32_t other = Bench::ram_base + 0x1800;
  const Outcome outcome = agreed([&](Bench& b) {
    b.start({0x47A8, 0x3401, 0xE7FC});  // blx r5; adds r4,#1; b
    put(b, other, 0x47703301);
    b.core.set_reg(5, other | 1);
    write(b, 0xE000ED94, 5);  // the default map at first
    b.core.run(500);
    write(b, 0xE000ED98, 0);
    write(b, 0xE000ED9C, other & ~0xFFFu);
    write(b, 0xE000EDA0, 0x13000000 | 11 << 1 | 1);  // execute never
  });
  EXPECT_GT(outcome.faults, 0u);
}

/// Targets that share a place in it, one of them even.
TEST(JumpCache, TellsAddressesApart) {
  const Outcome outcome = agreed([&](Bench& b) {
    b.start({0x47A8, 0x4075, 0x3401, 0xE7FB});  // blx r5; eors r5,r6; adds r4,#1; b
    b.code(0x2000, {0x3301, 0x4770});           // adds r3,#1; bx lr
    b.code(0x2200, {0x3210, 0x4770});           // adds r2,#16; bx lr
    b.core.set_reg(5, 0x2001);
    b.core.set_reg(6, 0x200);
    b.core.run(1500);
    b.core.set_reg(5, 0x2000);  // no Thumb state
    b.core.set_reg(6, 0);
  });
  EXPECT_GT(outcome.faults, 0u);
  EXPECT_GT(outcome.registers[2], 16u * 20);
}

/// MRS and MSR of PSP, ISB: in a handler, in Thread mode with either stack, and unprivileged.
TEST(ProcessStack, IsMovedAsByStepping) {
  for (const uint32_t control : {0u, 2u, 3u}) {
    SCOPED_TRACE(control);
    // mrs r4,psp; adds r4,#5; msr psp,r4; isb; mrs r5,psp; adds r6,r6,r5; bx lr
    const Outcome outcome = agreed([&](Bench& b) {
      const uint16_t first = control == 0 ? 0xDF00 : 0xBF00;  // svc where its frame is not moved
      b.start({first, 0xF3EF, 0x8709, 0x443E, 0xF385, 0x8809, 0xF3BF, 0x8F6F, 0x4446, 0xE7F5});
      b.code(0x4000 + 32 * 11, {0xF3EF, 0x8409, 0x3405, 0xF384, 0x8809, 0xF3BF, 0x8F6F, 0xF3EF,
                                0x8509, 0x1976, 0x4770});
      b.core.edit().set_psp(Bench::ram_base + 0x4000);
      b.core.edit().set_control(control);
    });
    EXPECT_EQ(outcome.registers[6] == 0, control == 3) << "it reads as zero for the unprivileged";
    EXPECT_EQ(outcome.faults, 0u);
  }
}

}  // namespace
}  // namespace capsoc::armv7m::test
