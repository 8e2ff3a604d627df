// A sister of the Cortex-M3: what a profile decides, in every executor.
#include "armv7m/profile.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <initializer_list>

#include "armv7m/system/registers.h"
#include "bench.h"
#include "executors.h"

namespace capsoc::armv7m::test {
namespace {

constexpr Profile make_sister() {
  Profile made = cortex_m3;
  made.name = "sister";
  made.instruction_sets = instruction_set::v6m;
  made.timing.cycles[static_cast<std::size_t>(CycleClass::special)] = 1;
  made.timing.exception_entry = 15;
  made.identity.cpuid = 0x410FC231;
  made.identity.features[8] = 0x01101110;  // ID_ISAR0 without division
  return made;
}
constexpr Profile sister = make_sister();

class Profiles : public testing::TestWithParam<Executor> {
 protected:
  /// The cycle of the first store to the device by a program with its address in r4.
  uint64_t cycle_of_store(const Profile& profile, std::initializer_list<uint16_t> program) const {
    Bench b(0, profile);
    uint64_t cycle = 0;
    b.on_write = [&](uint32_t) { cycle = cycle == 0 ? b.core.cycles() : cycle; };
    b.code(0x4000 + 32 * 11, {0x6020, 0xE7FE});  // SVCall: str r0,[r4]; b .
    choose(b.core, GetParam());
    b.start(program);
    b.core.set_reg(4, 0x40000000);
    b.core.run(100);
    EXPECT_NE(cycle, 0u);
    return cycle;
  }
};

INSTANTIATE_TEST_SUITE_P(Executors, Profiles, testing::ValuesIn(all_executors), executor_name);

TEST_P(Profiles, GiveTheIdentityThatSoftwareReads) {
  for (const Profile* profile : {&cortex_m3, &sister}) {
    Bench b(0, *profile);
    choose(b.core, GetParam());
    b.start({0x6823, 0x6E25, 0xE7FE});  // ldr r3,[r4]; ldr r5,[r4,#0x60]; b .
    b.core.set_reg(4, ppb::CPUID);
    b.core.run(50);
    EXPECT_EQ(b.core.reg(3), profile->identity.cpuid) << profile->name;
    EXPECT_EQ(b.core.reg(5), profile->identity.features[8]) << profile->name;
    EXPECT_EQ(b.peek(ppb::ID_PFR0), 0x30u) << profile->name;
  }
}

TEST_P(Profiles, AnInstructionThatTheProfileLacksIsUndefined) {
  for (const Profile* profile : {&cortex_m3, &sister}) {
    Bench b(0, *profile);
    choose(b.core, GetParam());
    b.start({0xFBB1, 0xF0F2, 0xE7FE});  // udiv r0,r1,r2; b .
    b.core.set_reg(1, 42);
    b.core.set_reg(2, 6);
    b.core.run(11);
    const bool divides = profile == &cortex_m3;
    EXPECT_EQ(b.core.reg(0), divides ? 7u : 0u) << profile->name;
    EXPECT_EQ(b.core.fault_count(), divides ? 0u : 1u) << profile->name;
    EXPECT_EQ(b.core.last_fault().cfsr, divides ? 0u : 1u << 16) << "UNDEFINSTR";
  }
}

TEST_P(Profiles, GiveTheTimesOfInstructionsAndExceptions) {
  const auto read_flags = {uint16_t{0xF3EF}, uint16_t{0x8000}, uint16_t{0x6020}, uint16_t{0xE7FE}};
  EXPECT_EQ(cycle_of_store(cortex_m3, read_flags), cycle_of_store(sister, read_flags) + 1);
  const auto call = {uint16_t{0xDF00}, uint16_t{0xE7FE}};  // svc
  EXPECT_EQ(cycle_of_store(cortex_m3, call) + 3, cycle_of_store(sister, call));
}

}  // namespace
}  // namespace capsoc::armv7m::test
