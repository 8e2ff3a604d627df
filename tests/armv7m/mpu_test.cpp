// The memory protection unit, sentence by sentence of ARM DDI 0403, B3.5, with both executors: the
// fast one keeps what the regions decided by the page.
#include <gtest/gtest.h>

#include <utility>

#include "bench.h"
#include "executors.h"

namespace capsoc::armv7m::test {
namespace {

constexpr uint32_t full_access = 3u << 24, read_only = 6u << 24, privileged_only = 1u << 24,
                   execute_never = 1u << 28;
constexpr uint32_t ram = Bench::ram_base;
constexpr uint32_t size_of(unsigned bits) {
  return (bits - 1) << 1 | 1;
}

class Mpu : public ::testing::TestWithParam<Executor> {
 protected:
  Bench b;
  void SetUp() override { choose(b.core, GetParam()); }

  /// Executes a store of a word by a program: str r1,[r0].
  void write(uint32_t address, uint32_t value) {
    b.code(0x2000, {0x6001, 0xE7FE});
    b.core.set_reg(0, address);
    b.core.set_reg(1, value);
    b.core.set_reg(15, 0x2000);
    b.core.run(b.core.cycles() + 3);
  }
  void region(unsigned number, uint32_t base, uint32_t rasr) {
    write(0xE000ED98, number);
    write(0xE000ED9C, base);
    write(0xE000EDA0, rasr);
  }
  /// Code memory for everyone, PRIVDEFENA, MemManage enabled.
  void start(bool user) {
    b.start({0xE7FE});
    b.core.run(2);
    region(0, 0, read_only | size_of(16));
    write(0xE000ED24, 1u << 16);
    user_ = user;
  }
  void enable(uint32_t ctrl = 5) {
    write(0xE000ED94, ctrl);
    if (user_) b.core.edit().set_control(1);
  }
  /// Loads repeatedly from an address: true when all were allowed.
  bool allows_load(uint32_t address, uint16_t instruction = 0x6802) {
    b.code(0x2100, {instruction, instruction, 0xE7FC});
    b.core.set_reg(0, address);
    b.core.set_reg(1, 0);
    b.core.set_reg(15, 0x2100);
    const uint64_t faults = b.core.fault_count();
    b.core.run(b.core.cycles() + 40);
    return b.core.fault_count() == faults;
  }
  bool allows_store(uint32_t address) { return allows_load(address, 0x6001); }
  bool user_ = false;
};

TEST_P(Mpu, TheHighestNumberedRegionThatMatchesDecides) {
  start(true);
  region(1, ram, full_access | size_of(16));
  region(2, ram + 0x1000, read_only | size_of(12));
  enable();
  EXPECT_TRUE(allows_store(ram + 0x800));
  EXPECT_TRUE(allows_load(ram + 0x1800));
  EXPECT_FALSE(allows_store(ram + 0x1800));
  EXPECT_EQ(b.core.last_fault().mmfar, ram + 0x1800);
}
TEST_P(Mpu, AnAddressOutsideEveryRegionFaultsWithoutPrivilege) {
  start(true);
  region(1, ram, full_access | size_of(12));
  enable();
  EXPECT_TRUE(allows_load(ram + 0xFFC));
  EXPECT_FALSE(allows_load(ram + 0x1000));
}
TEST_P(Mpu, PrivdefenaLetsThePrivilegedUseTheDefaultMap) {
  start(false);
  enable();
  EXPECT_TRUE(allows_store(ram + 0x1000));
}
TEST_P(Mpu, ADisabledSubregionDoesNotMatch) {
  start(true);
  region(1, ram, full_access | size_of(12) | 1u << 9);  // 4 KiB, the second 512 bytes left out
  enable();
  EXPECT_TRUE(allows_load(ram + 0x1FC));
  EXPECT_FALSE(allows_load(ram + 0x200));
}
TEST_P(Mpu, ARegionOfThirtyTwoBytesGuardsThem) {
  start(true);
  region(1, ram, full_access | size_of(16));
  region(2, ram + 0x40, privileged_only | size_of(5));
  enable();
  EXPECT_TRUE(allows_store(ram + 0x3C));
  EXPECT_TRUE(allows_store(ram + 0x60));
  EXPECT_FALSE(allows_store(ram + 0x5C));
}
// MMFAR (Cortex-M3 Devices Generic User Guide): the part that the region forbids, not the address
// that was asked for.
TEST_P(Mpu, MmfarHasTheAddressOfThePartOfAnUnalignedAccessThatFaulted) {
  for (uint32_t region_base : {ram + 0x100, ram + 0x1000}) {
    for (uint16_t instruction : {0x6802, 0x6001}) {  // ldr r2,[r0]; str r1,[r0]
      for (uint32_t before : {1u, 2u, 3u}) {
        start(true);
        region(1, ram, full_access | size_of(16));
        region(2, region_base, privileged_only | size_of(8));
        enable();
        EXPECT_FALSE(allows_load(region_base - before, instruction));
        EXPECT_EQ(b.core.last_fault().mmfar, region_base) << before;
        EXPECT_EQ(b.core.last_fault().address, region_base);
      }
    }
  }
}
TEST_P(Mpu, MmfarHasTheAddressThatWasAskedForIfItsFirstPartFaults) {
  start(true);
  region(1, ram, full_access | size_of(16));
  region(2, ram + 0x100, privileged_only | size_of(8));
  enable();
  EXPECT_FALSE(allows_load(ram + 0x1FE));
  EXPECT_EQ(b.core.last_fault().mmfar, ram + 0x1FE);
}
TEST_P(Mpu, RegionsThatShareAPageAreToldApartAtEachAccess) {
  constexpr uint16_t load = 0x6802, store = 0x6001;
  // 0x880 falls on the same line as 0x80 among the decisions that are kept.
  const std::pair<uint32_t, uint16_t> forbidden[] = {{0x80, store}, {0xA0, load}, {0x880, load}};
  for (const auto& [offset, instruction] : forbidden) {
    start(true);
    region(1, ram, full_access | size_of(7));
    region(2, ram + 0x80, read_only | size_of(5));
    enable();
    for (unsigned i = 0; i < 3; ++i) {
      EXPECT_TRUE(allows_store(ram + 0x7C));
      EXPECT_TRUE(allows_load(ram + 0x9C));
    }
    EXPECT_FALSE(allows_load(ram + offset, instruction)) << offset;
  }
}
TEST_P(Mpu, AChangeOfARegionCountsFromTheNextAccess) {
  start(false);
  enable();
  EXPECT_TRUE(allows_store(ram + 0x3000));
  region(3, ram + 0x3000, read_only | size_of(12));
  EXPECT_FALSE(allows_store(ram + 0x3000));
  region(3, 0, 0);
  EXPECT_TRUE(allows_store(ram + 0x3000));
}
TEST_P(Mpu, AChangeOfARegionCountsWhereRegionsShareAPage) {
  constexpr uint32_t address =
      ram + 0x3740;  // apart from the code's lines among those that are kept
  start(true);
  region(1, ram, full_access | size_of(16));
  region(3, address, full_access | size_of(5));
  enable();
  EXPECT_TRUE(allows_store(address));
  b.core.edit().set_control(0);
  region(3, address, read_only | size_of(5));
  b.core.edit().set_control(1);
  EXPECT_FALSE(allows_store(address));
}
TEST_P(Mpu, CodeInAnExecuteNeverRegionIsNotExecuted) {
  start(false);
  const uint16_t loop[] = {0xBF00, 0xE7FD};
  std::memcpy(&b.ram[0x4000], loop, sizeof(loop));
  b.core.set_reg(15, ram + 0x4000);
  b.core.run(b.core.cycles() + 30);  // decoded and running
  EXPECT_EQ(b.core.fault_count(), 0u);
  region(3, ram + 0x4000, full_access | execute_never | size_of(12));
  enable();
  b.core.set_reg(15, ram + 0x4000);
  b.core.run(b.core.cycles() + 3);
  EXPECT_EQ(b.core.last_fault().cfsr & 0xFF, 1u);
}
TEST_P(Mpu, WithoutHfnmienaTheMpuIsOffWhileFaultmaskIsSet) {
  start(false);
  region(3, ram + 0x3000, read_only | size_of(12));
  enable();
  b.code(0x2200, {0xB671, 0x6001, 0x6001, 0xB661, 0x6001, 0xE7FE});  // cpsid f; str; cpsie f; str
  b.core.set_reg(0, ram + 0x3000);
  b.core.set_reg(15, 0x2200);
  b.core.run(b.core.cycles() + 60);
  EXPECT_EQ(b.core.last_fault().frame[6], 0x2208u);
}

INSTANTIATE_TEST_SUITE_P(Both, Mpu, ::testing::ValuesIn(all_executors), executor_name);

}  // namespace
}  // namespace capsoc::armv7m::test
