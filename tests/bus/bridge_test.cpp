// The AHB-to-APB bridge, seen by the processor through the matrix and by a device on the bridge.
#include <gtest/gtest.h>

#include "bench.h"
#include "kit/early_write.h"

namespace capsoc::test {
namespace {

class Bridge : public testing::Test {
 protected:
  Bridge() { b.forget(); }
  Bench& b = bench();
  unsigned char bytes[8] = {1, 2, 3, 4, 5, 6, 7, 8};
};

TEST_F(Bridge, TakesASetupAndAnAccessCycle) {
  EXPECT_EQ(b.system.read(at::probe).delay, b.cycles(2));
  EXPECT_EQ(b.system.write(at::probe, 1).delay, b.cycles(2));
}

TEST_F(Bridge, AddsTheDevicesPreadyAndTheMapsWaitStates) {
  b.probe.ready_after = b.cycles(7);
  EXPECT_EQ(b.system.read(at::probe).delay, b.cycles(9));
  EXPECT_EQ(b.system.read(at::sluggish).delay, b.cycles(7));
}

TEST_F(Bridge, GivesTheDeviceItsOwnAddresses) {
  b.system.write(at::sluggish + 0x24, 9);
  ASSERT_EQ(b.sluggish.transfers.size(), 1u);
  EXPECT_EQ(b.sluggish.transfers[0].address, 0x24u);
  EXPECT_TRUE(b.probe.transfers.empty());
}

TEST_F(Bridge, WritesAByteAsAWordWithOneStrobe) {
  b.system.write(at::probe + 6, 0xab, 1);
  ASSERT_EQ(b.probe.transfers.size(), 1u);
  EXPECT_EQ(b.probe.transfers[0].address, 4u);
  EXPECT_EQ(b.probe.transfers[0].length, 4u);
  EXPECT_EQ(b.probe.transfers[0].strobes, 0x4u);
  EXPECT_EQ(b.probe.transfers[0].data, 0x00ab0000u);
}

TEST_F(Bridge, WritesAHalfWordWithTwoStrobesAndAWordWithAll) {
  b.system.write(at::probe + 2, 0xabcd, 2);
  b.system.write(at::probe, 0x12345678);
  ASSERT_EQ(b.probe.transfers.size(), 2u);
  EXPECT_EQ(b.probe.transfers[0].strobes, 0xcu);
  EXPECT_EQ(b.probe.transfers[0].data, 0xabcd0000u);
  EXPECT_EQ(b.probe.transfers[1].strobes, 0xfu);
  EXPECT_EQ(b.probe.transfers[1].data, 0x12345678u);
}

TEST_F(Bridge, ReadsAWholeWordAndPicksTheLane) {
  b.probe.read_value = 0x44332211;
  EXPECT_EQ(b.system.read(at::probe + 3, 1).value, 0x44u);
  EXPECT_EQ(b.system.read(at::probe + 2, 2).value, 0x4433u);
  ASSERT_EQ(b.probe.transfers.size(), 2u);
  EXPECT_EQ(b.probe.transfers[0].address, 0u);
  EXPECT_EQ(b.probe.transfers[0].length, 4u);
}

TEST_F(Bridge, SplitsADoubleWordIntoTwoTransfers) {
  tlm::tlm_generic_payload payload;
  Initiator::describe(payload, tlm::TLM_WRITE_COMMAND, at::probe + 8, bytes, 8);
  const Answer answer = b.system.send(payload);
  EXPECT_TRUE(answer.ok() && answer.payload_intact);
  EXPECT_EQ(answer.delay, b.cycles(4));
  ASSERT_EQ(b.probe.transfers.size(), 2u);
  EXPECT_EQ(b.probe.transfers[0].data, 0x04030201u);
  EXPECT_EQ(b.probe.transfers[1].address, 12u);
  EXPECT_EQ(b.probe.transfers[1].data, 0x08070605u);
}

TEST_F(Bridge, TurnsByteEnablesIntoStrobesAndLeavesDisabledBytesOfAReadAlone) {
  unsigned char enables[4] = {0, TLM_BYTE_ENABLED, TLM_BYTE_ENABLED, 0};
  tlm::tlm_generic_payload payload;
  Initiator::describe(payload, tlm::TLM_WRITE_COMMAND, at::probe, bytes, 4);
  payload.set_byte_enable_ptr(enables);
  payload.set_byte_enable_length(4);
  EXPECT_TRUE(b.system.send(payload).ok());
  EXPECT_EQ(b.probe.transfers.back().strobes, 0x6u);
  b.probe.read_value = 0xffffffff;
  payload.set_command(tlm::TLM_READ_COMMAND);
  EXPECT_EQ(b.system.send(payload).value, 0x04ffff01u);
}

TEST_F(Bridge, RefusesLengthsThatNoAhbTransferHas) {
  for (unsigned length : {0u, 3u, 5u, 7u})
    EXPECT_EQ(b.system.transfer(tlm::TLM_WRITE_COMMAND, at::probe, 0, length).status,
              tlm::TLM_BURST_ERROR_RESPONSE)
        << length;
  EXPECT_TRUE(b.probe.transfers.empty());
}

TEST_F(Bridge, RefusesMisalignedTransfers) {
  EXPECT_EQ(b.system.read(at::probe + 1, 2).status, tlm::TLM_ADDRESS_ERROR_RESPONSE);
  EXPECT_EQ(b.system.read(at::probe + 2, 4).status, tlm::TLM_ADDRESS_ERROR_RESPONSE);
  EXPECT_TRUE(b.probe.transfers.empty());
}

TEST_F(Bridge, RefusesStreamingAndBadByteEnables) {
  tlm::tlm_generic_payload payload;
  Initiator::describe(payload, tlm::TLM_WRITE_COMMAND, at::probe, bytes, 8);
  payload.set_streaming_width(4);
  EXPECT_EQ(b.system.send(payload).status, tlm::TLM_BURST_ERROR_RESPONSE);
  Initiator::describe(payload, tlm::TLM_WRITE_COMMAND, at::probe, bytes, 4);
  payload.set_byte_enable_ptr(bytes);
  payload.set_byte_enable_length(0);
  EXPECT_EQ(b.system.send(payload).status, tlm::TLM_BYTE_ENABLE_ERROR_RESPONSE);
  EXPECT_TRUE(b.probe.transfers.empty());
}

TEST_F(Bridge, MakesNoTransferForTheIgnoreCommand) {
  EXPECT_TRUE(b.system.transfer(tlm::TLM_IGNORE_COMMAND, at::probe, 0, 4).ok());
  EXPECT_TRUE(b.probe.transfers.empty());
}

TEST_F(Bridge, PassesPslverrOnAsABusErrorOneCycleLater) {
  b.probe.response = tlm::TLM_COMMAND_ERROR_RESPONSE;
  const Answer answer = b.system.write(at::probe, 1);
  EXPECT_EQ(answer.status, tlm::TLM_GENERIC_ERROR_RESPONSE);
  EXPECT_EQ(answer.delay, b.cycles(3));
  b.probe.response = tlm::TLM_ADDRESS_ERROR_RESPONSE;
  EXPECT_EQ(b.system.read(at::probe).status, tlm::TLM_ADDRESS_ERROR_RESPONSE);
}

TEST_F(Bridge, StopsABurstAtItsFirstError) {
  b.probe.response = tlm::TLM_GENERIC_ERROR_RESPONSE;
  EXPECT_FALSE(b.system.transfer(tlm::TLM_READ_COMMAND, at::probe, 0, 16).ok());
  EXPECT_EQ(b.probe.transfers.size(), 1u);
}

TEST_F(Bridge, DoesNotDeliverTheDataOfAFailedRead) {
  b.probe.read_value = 0xffffffff;
  b.probe.response = tlm::TLM_GENERIC_ERROR_RESPONSE;
  EXPECT_EQ(b.system.read(at::probe).value, 0u);
}

TEST_F(Bridge, SelectsNobodyInAHole) {
  EXPECT_EQ(b.system.read(at::apb_hole).status, tlm::TLM_ADDRESS_ERROR_RESPONSE);
}

TEST_F(Bridge, DebugsWithoutATransfer) {
  b.probe.debug_value = 0x44332211;
  EXPECT_EQ(b.load.debug_read(at::probe), 0x44332211u);
  unsigned char middle[2] = {};
  EXPECT_EQ(b.load.debug(tlm::TLM_READ_COMMAND, at::probe + 1, middle, 2), 2u);
  EXPECT_EQ(middle[0], 0x22);
  EXPECT_EQ(middle[1], 0x33);
  unsigned char patch = 0xee;
  EXPECT_EQ(b.load.debug(tlm::TLM_WRITE_COMMAND, at::probe + 2, &patch, 1), 1u);
  EXPECT_EQ(b.probe.debug_value, 0x44ee2211u);
  EXPECT_TRUE(b.probe.transfers.empty());
}

TEST_F(Bridge, KnowsItsTargetsByName) {
  EXPECT_EQ(b.bridge.error(), "");
  EXPECT_EQ(b.bridge.targets(), (std::vector<std::string>{"probe", "sluggish"}));
  EXPECT_EQ(b.bridge.port("ram"), nullptr);
}

/// What the device says of a write ahead of the kernel.
class EarlyWrites : public Bridge {
 protected:
  /// Whether one was taken.
  bool write(unsigned length, bool early) {
    told.early = early;
    told.taken = false;
    tlm::tlm_generic_payload payload;
    Initiator::describe(payload, tlm::TLM_WRITE_COMMAND, at::probe, bytes, length);
    payload.set_extension(&told);
    EXPECT_TRUE(b.system.send(payload).ok());
    payload.clear_extension<kit::EarlyWrite>();
    return told.taken;
  }
  kit::EarlyWrite told;
};

TEST_F(EarlyWrites, AreTheDevicesToTake) {
  for (const bool takes : {false, true}) {
    b.probe.takes_early = takes;
    EXPECT_EQ(write(4, true), takes);
    EXPECT_EQ(write(1, true), takes) << "a byte is a word with a strobe";
    EXPECT_EQ(write(4, false), takes) << "said beforehand";
  }
}

TEST_F(EarlyWrites, AreNoBursts) {
  b.probe.takes_early = true;
  EXPECT_FALSE(write(8, false));
}

TEST_F(EarlyWrites, AreNotMadeWhileSomebodySeesTheTransfers) {
  b.probe.takes_early = true;
  unsigned seen = 0;
  const kit::Listening listening =
      b.matrix.transfers.listen([&](const tlm::tlm_generic_payload&, const sc_core::sc_time&,
                                    const sc_core::sc_time&) { ++seen; });
  EXPECT_FALSE(write(4, true));
  EXPECT_TRUE(b.probe.transfers.empty());
  EXPECT_EQ(seen, 0u);
  EXPECT_FALSE(write(4, false));
  EXPECT_EQ(b.probe.transfers.size(), 1u);
  EXPECT_EQ(seen, 1u);
}

}  // namespace
}  // namespace capsoc::test
