// What the peripherals have in common: identification, and how they take a wrong access.
#include <gtest/gtest.h>

#include "bench.h"

namespace capsoc::test {
namespace {

struct Device {
  const char* name;
  Initiator& initiator;
  uint32_t part_number;
};

class EveryPeripheral : public testing::Test {
 protected:
  EveryPeripheral() {
    b.uart.reset();
    b.timer.reset();
    b.gpio.reset();
    b.dual_timer.reset();
    b.watchdog.reset();
  }
  Bench& b = bench();
  Device devices[5] = {{"uart", b.to_uart, 0x21},
                       {"timer", b.to_timer, 0x22},
                       {"gpio", b.to_gpio, 0x20},
                       {"dual_timer", b.to_dual_timer, 0x23},
                       {"watchdog", b.to_watchdog, 0x24}};
};

TEST_F(EveryPeripheral, IdentifiesItself) {
  for (const Device& d : devices) {
    const uint32_t ids[12] = {0x04, 0, 0, 0, d.part_number, 0xb8, 0x1b, 0, 0x0d, 0xf0, 0x05, 0xb1};
    for (unsigned i = 0; i < 12; ++i) {
      EXPECT_EQ(d.initiator.read(0xfd0 + 4 * i).value, ids[i]) << d.name << " " << i;
      EXPECT_EQ(d.initiator.debug_read(0xfd0 + 4 * i), ids[i]) << d.name << " " << i;
    }
  }
}

TEST_F(EveryPeripheral, ReportsAndIgnoresAWriteToItsIdentification) {
  for (const Device& d : devices) {
    const uint64_t before = kit::guest_error_count(d.name);
    EXPECT_TRUE(d.initiator.write(0xfe0, 0xff).ok()) << d.name;
    EXPECT_EQ(d.initiator.read(0xfe0).value, d.part_number) << d.name;
    EXPECT_EQ(kit::guest_error_count(d.name), before + 1) << d.name;
  }
}

TEST_F(EveryPeripheral, ReportsAnOffsetWithoutARegisterAndReadsItAsZero) {
  for (const Device& d : devices) {
    const uint64_t before = kit::guest_error_count(d.name);
    const Answer answer = d.initiator.read(0xe00);
    EXPECT_TRUE(answer.ok()) << d.name;
    EXPECT_EQ(answer.value, 0u) << d.name;
    EXPECT_TRUE(d.initiator.write(0xe00, 1).ok()) << d.name;
    EXPECT_EQ(kit::guest_error_count(d.name), before + 2) << d.name;
  }
}

TEST_F(EveryPeripheral, AnswersEveryAbuseWithAnError) {
  for (const Device& d : devices) {
    for (unsigned length : {0u, 3u, 8u})
      EXPECT_FALSE(d.initiator.transfer(tlm::TLM_WRITE_COMMAND, 8, 1, length).ok()) << d.name;
    EXPECT_FALSE(d.initiator.read(0x1000).ok()) << d.name;
    EXPECT_FALSE(d.initiator.read(2).ok()) << d.name;
    EXPECT_FALSE(d.initiator.transfer(tlm::TLM_IGNORE_COMMAND, 8, 1, 4).ok()) << d.name;
  }
}

TEST_F(EveryPeripheral, TakesNoTimeOfItsOwnAndGrantsNoDirectMemory) {
  for (const Device& d : devices) {
    EXPECT_EQ(d.initiator.read(0).delay, sc_core::SC_ZERO_TIME) << d.name;
    tlm::tlm_dmi dmi;
    EXPECT_FALSE(d.initiator.direct_memory(0, dmi)) << d.name;
  }
}

}  // namespace
}  // namespace capsoc::test
