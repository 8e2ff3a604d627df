#include <gtest/gtest.h>

#include "bench.h"

namespace capsoc::test {
namespace {

class Ram : public testing::Test {
 protected:
  Ram() { b.forget(); }

  tlm::tlm_response_status send(tlm::tlm_generic_payload& payload) {
    return b.system.send(payload).status;
  }
  uint32_t word(uint64_t offset) { return b.system.read(at::ram + offset).value; }

  Bench& b = bench();
  unsigned char bytes[16] = {0x10, 0x11, 0x12, 0x13, 0x14, 0x15, 0x16, 0x17,
                             0x18, 0x19, 0x1a, 0x1b, 0x1c, 0x1d, 0x1e, 0x1f};
};

TEST_F(Ram, IsZeroAtPowerOn) {
  EXPECT_EQ(word(0x40), 0u);
}

TEST_F(Ram, KeepsItsContentsThroughAResetAndLosesThemWithThePower) {
  b.system.write(at::ram, 0x55);
  b.ram.reset();
  EXPECT_EQ(word(0), 0x55u);
  b.ram.clear();
  EXPECT_EQ(word(0), 0u);
}

TEST_F(Ram, TakesBytesHalfWordsAndWordsLittleEndian) {
  b.system.write(at::ram, 0x44332211);
  EXPECT_EQ(b.system.read(at::ram + 1, 1).value, 0x22u);
  EXPECT_EQ(b.system.read(at::ram + 2, 2).value, 0x4433u);
  b.system.write(at::ram + 3, 0xaa, 1);
  b.system.write(at::ram, 0xbbcc, 2);
  EXPECT_EQ(word(0), 0xaa33bbccu);
}

TEST_F(Ram, TakesAnyLength) {
  tlm::tlm_generic_payload payload;
  Initiator::describe(payload, tlm::TLM_WRITE_COMMAND, at::ram + 1, bytes, 3);
  EXPECT_EQ(send(payload), tlm::TLM_OK_RESPONSE);
  EXPECT_EQ(word(0), 0x12111000u);
  Initiator::describe(payload, tlm::TLM_WRITE_COMMAND, at::ram + 8, bytes, 8);
  EXPECT_EQ(send(payload), tlm::TLM_OK_RESPONSE);
  EXPECT_EQ(word(12), 0x17161514u);
}

TEST_F(Ram, WritesOnlyEnabledBytes) {
  b.system.write(at::ram, 0xffffffff);
  unsigned char enables[4] = {TLM_BYTE_ENABLED, 0, TLM_BYTE_ENABLED, 0};
  tlm::tlm_generic_payload payload;
  Initiator::describe(payload, tlm::TLM_WRITE_COMMAND, at::ram, bytes, 4);
  payload.set_byte_enable_ptr(enables);
  payload.set_byte_enable_length(4);
  EXPECT_EQ(send(payload), tlm::TLM_OK_RESPONSE);
  EXPECT_EQ(word(0), 0xff12ff10u);
}

TEST_F(Ram, ReadsOnlyEnabledBytesAndRepeatsAShortEnableArray) {
  b.system.write(at::ram, 0xffffffff);
  unsigned char enables[2] = {0, TLM_BYTE_ENABLED};
  tlm::tlm_generic_payload payload;
  Initiator::describe(payload, tlm::TLM_READ_COMMAND, at::ram, bytes, 4);
  payload.set_byte_enable_ptr(enables);
  payload.set_byte_enable_length(2);
  EXPECT_EQ(b.system.send(payload).value, 0xff12ff10u);
}

TEST_F(Ram, StreamsIntoOnePlaceWhenTheWidthIsShorterThanTheData) {
  tlm::tlm_generic_payload payload;
  Initiator::describe(payload, tlm::TLM_WRITE_COMMAND, at::ram, bytes, 8);
  payload.set_streaming_width(4);
  EXPECT_EQ(send(payload), tlm::TLM_OK_RESPONSE);
  EXPECT_EQ(word(0), 0x17161514u);
  EXPECT_EQ(word(4), 0u);
}

TEST_F(Ram, AnswersEveryAbuseWithoutTouchingItsBytes) {
  tlm::tlm_generic_payload payload;
  Initiator::describe(payload, tlm::TLM_WRITE_COMMAND, at::ram, bytes, 0);
  EXPECT_EQ(send(payload), tlm::TLM_BURST_ERROR_RESPONSE);
  Initiator::describe(payload, tlm::TLM_WRITE_COMMAND, at::ram, bytes, 4);
  payload.set_streaming_width(0);
  EXPECT_EQ(send(payload), tlm::TLM_BURST_ERROR_RESPONSE);
  Initiator::describe(payload, tlm::TLM_WRITE_COMMAND, at::ram, nullptr, 4);
  EXPECT_EQ(send(payload), tlm::TLM_GENERIC_ERROR_RESPONSE);
  Initiator::describe(payload, tlm::TLM_WRITE_COMMAND, at::ram, bytes, 4);
  payload.set_byte_enable_ptr(bytes);
  payload.set_byte_enable_length(0);
  EXPECT_EQ(send(payload), tlm::TLM_BYTE_ENABLE_ERROR_RESPONSE);
  EXPECT_EQ(word(0), 0u);
}

TEST_F(Ram, DoesNothingForTheIgnoreCommand) {
  b.system.write(at::ram, 0x77);
  EXPECT_TRUE(b.system.transfer(tlm::TLM_IGNORE_COMMAND, at::ram, 0x99, 4).ok());
  EXPECT_EQ(word(0), 0x77u);
  EXPECT_EQ(b.system.debug(tlm::TLM_IGNORE_COMMAND, at::ram, bytes, 4), 0u);
}

TEST_F(Ram, SaysThatDirectMemoryIsWorthAsking) {
  tlm::tlm_generic_payload payload;
  Initiator::describe(payload, tlm::TLM_READ_COMMAND, at::ram, bytes, 4);
  b.system.send(payload);
  EXPECT_TRUE(payload.is_dmi_allowed());
}

TEST_F(Ram, DebugReadsAndWritesWithoutTime) {
  uint32_t value = 0x12345678;
  EXPECT_EQ(b.load.debug(tlm::TLM_WRITE_COMMAND, at::slow_ram + 2, &value, 4), 4u);
  EXPECT_EQ(b.load.debug_read(at::slow_ram + 2), 0x12345678u);
}

}  // namespace
}  // namespace capsoc::test
