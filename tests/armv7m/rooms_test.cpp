// The rooms of the processor by themselves, and the list of their registers.
#include <gtest/gtest.h>

#include <set>
#include <vector>

#include "armv7m/profile.h"
#include "armv7m/system/registers.h"
#include "bench.h"
#include "executors.h"

namespace capsoc::armv7m::test {
namespace {

struct Row {
  const char* name;
  uint32_t address;
  unsigned words;
};
#define SYSTEM_REGISTER(name, address, words, room, access, parts, reset, writable, ones) \
  {#name, address, words},
const std::vector<Row> armv7m_rows = {
#include "armv7m/system/registers.def"
};
const std::vector<Row> armv6m_rows = {
#include "armv7m/system/registers_armv6m.def"
};
#undef SYSTEM_REGISTER

struct Architecture {
  const char* name;
  const Profile* profile;
  const std::vector<Row>* rows;
};
std::ostream& operator<<(std::ostream& out, const Architecture& architecture) {
  return out << architecture.name;
}
class RegisterTables : public testing::TestWithParam<Architecture> {
 protected:
  const Profile& profile = *GetParam().profile;
  const SystemRegisters& registers = *profile.registers;
  const std::vector<Row>& rows = *GetParam().rows;
};
INSTANTIATE_TEST_SUITE_P(Architectures, RegisterTables,
                         testing::Values(Architecture{"Armv7M", &cortex_m3, &armv7m_rows},
                                         Architecture{"Armv6M", &cortex_m0plus, &armv6m_rows}),
                         [](const auto& tested) { return tested.param.name; });

TEST_P(RegisterTables, EachWordIsOfTheRowThatNamesIt) {
  std::set<uint32_t> taken;
  for (const Row& row : rows) {
    for (unsigned word = 0; word < row.words; ++word) {
      const uint32_t address = row.address + 4 * word;
      EXPECT_TRUE(taken.insert(address).second) << row.name << " lies over another";
      for (const uint32_t byte : {0u, 3u}) {
        const SystemRegister* found = registers.find(address + byte);
        ASSERT_NE(found, nullptr) << row.name;
        EXPECT_STREQ(found->description.name, row.name);
      }
    }
  }
  for (const uint32_t page : {0xE0000000u, 0xE0001000u, 0xE000E000u, 0xE0002000u, 0xE0042000u})
    for (uint32_t address = page; address < page + 4096; address += 4)
      EXPECT_EQ(registers.has(address), taken.count(address) != 0) << address;
}

TEST_P(RegisterTables, ReadAsTheirResetValuesAfterAReset) {
  Bench b(0, profile);
  b.start({0xE7FE});
  for (const Row& row : rows) {
    const SystemRegister& about = registers.at(row.address);
    const uint32_t expected = about.description.access == capsoc::registers::Access::write_only
                                  ? 0
                                  : about.description.reset;
    EXPECT_EQ(b.peek(row.address), expected) << row.name;
  }
}

TEST_P(RegisterTables, KeepWhatIsWritableOfAllOnes) {
  Bench b(0, profile);
  b.start({0xE7FE});
  const uint32_t ones = 0xFFFFFFFF;
  for (const ppb::Address name : {ppb::ACTLR, ppb::SYST_RVR, ppb::VTOR, ppb::SCR, ppb::CCR,
                                  ppb::MMFAR, ppb::BFAR, ppb::MPU_CTRL, ppb::MPU_RNR}) {
    const SystemRegister* about = registers.find(name);
    ASSERT_TRUE(b.core.debug_write(name, &ones, 4));
    if (about == nullptr) {
      EXPECT_EQ(b.peek(name), 0u) << name;
    } else if (about->description.access == capsoc::registers::Access::read_only) {
      EXPECT_EQ(b.peek(name), about->description.reset) << about->description.name;
    } else {
      EXPECT_EQ(b.peek(name), about->description.writable_mask) << about->description.name;
    }
  }
}

TEST(Rooms, SystickCountsWithoutAProcessor) {
  Systick systick;
  systick.reset(100);
  systick.write(armv7m_registers.at(ppb::SYST_RVR), {9, 0xFFFFFFFF}, 100);
  systick.write(armv7m_registers.at(ppb::SYST_CSR), {7, 0xFFFFFFFF},
                100);  // core clock, exception, on
  EXPECT_EQ(systick.event(), 110u);
  EXPECT_EQ(systick.read(ppb::SYST_CVR, 103), 7u);
  systick.expire();
  EXPECT_EQ(systick.event(), 120u);
  EXPECT_EQ(systick.read(ppb::SYST_CSR, 110), 0x10007u) << "COUNTFLAG";
}

TEST(Rooms, AnExceptionNumberBeyondTheLastIsNoException) {
  Nvic nvic;
  for (const unsigned number : {48u, 63u, 64u, 300u, 511u}) {
    nvic.set_pending(number, true);
    nvic.set_active(number, true);
    EXPECT_FALSE(nvic.is_active(number)) << number;
    EXPECT_FALSE(nvic.line_is_high(number)) << number;
  }
  EXPECT_EQ(nvic.pending() | nvic.active(), 0u);
}

TEST(Rooms, AStackedExceptionNumberThatIsNoneIsAFaultOfTheReturn) {
  for (const Executor executor : all_executors) {
    Bench b;
    choose(b.core, executor);
    constexpr uint32_t svcall = 0x4000 + 32 * exception::svcall;
    // ldr r0, =ICSR; movs r1, #1; lsls r1, r1, #31; str r1, [r0]: NMI comes; bx lr
    b.code(svcall, {0x4802, 0x2101, 0x07C9, 0x6001, 0x4770});
    b.word(svcall + 12, ppb::ICSR);
    // ldr r2, [sp, #28]; movs r3, #64; orrs r2, r3: exception 75; str r2, [sp, #28]; bx lr
    b.code(0x4000 + 32 * exception::nmi, {0x9A07, 0x2340, 0x431A, 0x9207, 0x4770});
    b.code(0x4000 + 32 * exception::hard_fault, {0xE7FE});
    b.start({0xDF00, 0xE7FE});
    b.core.run(2000);
    constexpr uint32_t invpc = 1u << 18;
    EXPECT_EQ(b.core.last_fault().kind, FaultReport::Kind::hard_fault);
    EXPECT_EQ(b.core.last_fault().cfsr, invpc);
    EXPECT_EQ(b.core.state().ipsr, exception::hard_fault);
  }
}

}  // namespace
}  // namespace capsoc::armv7m::test
