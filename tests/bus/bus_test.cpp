// The matrix: decoding, wait states, direct memory, debug, and what does not exist.
#include <gtest/gtest.h>

#include "bench.h"
#include "kit/guest_error.h"

namespace capsoc::test {
namespace {

class Matrix : public testing::Test {
 protected:
  Matrix() { b.forget(); }
  Bench& b = bench();
};

TEST_F(Matrix, CarriesAWordFromEveryBusToEveryOther) {
  EXPECT_TRUE(b.fetch.write(at::ram, 0x11223344).ok());
  EXPECT_EQ(b.load.read(at::ram).value, 0x11223344u);
  EXPECT_EQ(b.system.read(at::ram).value, 0x11223344u);
}

TEST_F(Matrix, ShowsAnAliasAtItsOffset) {
  b.system.write(at::ram + 0x804, 0xcafe);
  EXPECT_EQ(b.system.read(at::ram_alias + 4).value, 0xcafeu);
  b.system.write(at::ram_alias + 8, 0xbeef);
  EXPECT_EQ(b.system.read(at::ram + 0x808).value, 0xbeefu);
}

TEST_F(Matrix, RepeatsAWrappedRange) {
  b.system.write(at::small_ram + 0x10, 7);
  EXPECT_EQ(b.system.read(at::small_ram + 0xc10).value, 7u);
}

TEST_F(Matrix, LeavesThePayloadAsItWas) {
  EXPECT_TRUE(b.system.write(at::ram_alias, 1).payload_intact);
  EXPECT_TRUE(b.system.read(at::small_ram + 0x400).payload_intact);
  EXPECT_TRUE(b.system.read(at::probe).payload_intact);
  EXPECT_TRUE(b.system.read(at::nothing).payload_intact);
  uint32_t word = 0;
  b.system.debug(tlm::TLM_READ_COMMAND, at::ram_alias, &word, 4);
  EXPECT_TRUE(b.system.debug_payload_intact);
}

TEST_F(Matrix, AddsNoTimeForSramAndTheMapsWaitStatesForSlowMemory) {
  EXPECT_EQ(b.system.read(at::ram).delay, sc_core::SC_ZERO_TIME);
  EXPECT_EQ(b.system.read(at::slow_ram).delay, b.cycles(3));
  EXPECT_EQ(b.system.write(at::slow_ram, 1, 1).delay, b.cycles(3));
}

TEST_F(Matrix, WaitsForEveryWordOfABurst) {
  EXPECT_EQ(b.system.transfer(tlm::TLM_READ_COMMAND, at::slow_ram, 0, 16).delay, b.cycles(12));
}

TEST_F(Matrix, AddsToADelayThatIsAlreadyThere) {
  unsigned char bytes[4] = {};
  tlm::tlm_generic_payload payload;
  Initiator::describe(payload, tlm::TLM_READ_COMMAND, at::slow_ram, bytes, 4);
  EXPECT_EQ(b.system.send(payload, b.cycles(2)).delay, b.cycles(5));
}

TEST_F(Matrix, KeepsWaitStatesOnEdgesWhenThePeriodIsNotAWholePicosecond) {
  b.clock.set_frequency(30'000'000);  // 33,333 1/3 ps
  const uint64_t before = b.clock.cycles_at(sc_core::sc_time_stamp());
  const sc_core::sc_time delay =
      b.system.transfer(tlm::TLM_READ_COMMAND, at::slow_ram, 0, 12).delay;
  EXPECT_EQ(delay, b.clock.time_of(before + 9) - sc_core::sc_time_stamp());
  EXPECT_EQ(delay.value(), 300'000u);
  b.clock.set_frequency(25'000'000);
}

TEST_F(Matrix, AnswersAnUnmappedAddressWithATwoCycleAddressError) {
  for (Initiator* each : {&b.fetch, &b.load, &b.system}) {
    const Answer answer = each->read(at::nothing);
    EXPECT_EQ(answer.status, tlm::TLM_ADDRESS_ERROR_RESPONSE);
    EXPECT_EQ(answer.delay, b.cycles(1));
  }
  EXPECT_EQ(b.system.write(0xfffffffc, 1).status, tlm::TLM_ADDRESS_ERROR_RESPONSE);
  EXPECT_EQ(b.system.read(~uint64_t{0}).status, tlm::TLM_ADDRESS_ERROR_RESPONSE);
}

TEST_F(Matrix, RefusesATransferThatLeavesItsRange) {
  EXPECT_TRUE(b.system.read(at::slow_ram + 0xffc).ok());
  EXPECT_EQ(b.system.read(at::slow_ram + 0xffe).status, tlm::TLM_ADDRESS_ERROR_RESPONSE);
  EXPECT_EQ(b.system.read(at::small_ram + 0x3fe).status, tlm::TLM_ADDRESS_ERROR_RESPONSE);
}

TEST_F(Matrix, JudgesAStreamAtTheEndOfARangeByItsWidth) {
  unsigned char bytes[8] = {1, 2, 3, 4, 5, 6, 7, 8};
  tlm::tlm_generic_payload payload;
  Initiator::describe(payload, tlm::TLM_WRITE_COMMAND, at::slow_ram + 0xffc, bytes, 8);
  EXPECT_EQ(b.system.send(payload).status, tlm::TLM_ADDRESS_ERROR_RESPONSE);
  payload.set_streaming_width(4);
  payload.set_response_status(tlm::TLM_INCOMPLETE_RESPONSE);
  EXPECT_TRUE(b.system.send(payload).ok());
  EXPECT_EQ(b.system.read(at::slow_ram + 0xffc).value, 0x08070605u);
}

TEST_F(Matrix, ServesAFurtherMasterWithoutDirectMemory) {
  EXPECT_TRUE(b.dma.write(at::ram, 0x11223344).ok());
  EXPECT_EQ(b.system.read(at::ram).value, 0x11223344u);
  EXPECT_EQ(b.dma.read(at::slow_ram).delay, b.cycles(3));
  tlm::tlm_dmi dmi;
  EXPECT_FALSE(b.dma.direct_memory(at::ram, dmi));
}

TEST_F(Matrix, InvalidatesWhatAFurtherMasterWrites) {
  b.dma.read(at::ram + 0x900);
  b.system.write(at::ram + 0x900, 0);
  EXPECT_TRUE(b.system.invalidated.empty());
  b.dma.write(at::ram + 0x900, 1);
  const std::vector<Initiator::Range> both = {{at::ram + 0x900, at::ram + 0x903},
                                              {at::ram_alias + 0x100, at::ram_alias + 0x103}};
  for (const Initiator* each : {&b.fetch, &b.load, &b.system}) EXPECT_EQ(each->invalidated, both);
  EXPECT_TRUE(b.dma.invalidated.empty());
}

TEST_F(Matrix, NotifiesAListenerOfWhatAFurtherMasterWrites) {
  std::vector<Initiator::Range> replaced;
  const kit::Listening listening = b.matrix.replaced.listen([&](uint64_t first, uint64_t last) {
    replaced.push_back({first, last});
  });
  b.dma.write(at::slow_ram + 4, 1, 2);
  b.dma.write(at::probe, 1);
  b.dma.write(at::nothing, 1);
  unsigned char bytes[8] = {};
  EXPECT_EQ(b.dma.debug(tlm::TLM_WRITE_COMMAND, at::slow_ram + 8, bytes, 8), 8u);
  const std::vector<Initiator::Range> expected = {{at::slow_ram + 4, at::slow_ram + 5},
                                                  {at::slow_ram + 8, at::slow_ram + 15}};
  EXPECT_EQ(replaced, expected);
  EXPECT_TRUE(b.system.invalidated.empty());
}

TEST_F(Matrix, GrantsDirectMemoryClippedToTheRange) {
  tlm::tlm_dmi dmi;
  ASSERT_TRUE(b.fetch.direct_memory(at::ram + 0x100, dmi));
  EXPECT_EQ(dmi.get_start_address(), at::ram);
  EXPECT_EQ(dmi.get_end_address(), at::ram + 0xfff);
  EXPECT_EQ(dmi.get_dmi_ptr(), b.ram.data());
  EXPECT_TRUE(dmi.is_read_write_allowed());
}

TEST_F(Matrix, GrantsDirectMemoryOfAnAliasFromItsOffset) {
  tlm::tlm_dmi dmi;
  ASSERT_TRUE(b.system.direct_memory(at::ram_alias + 0x10, dmi));
  EXPECT_EQ(dmi.get_start_address(), at::ram_alias);
  EXPECT_EQ(dmi.get_end_address(), at::ram_alias + 0x7ff);
  EXPECT_EQ(dmi.get_dmi_ptr(), b.ram.data() + 0x800);
}

TEST_F(Matrix, GrantsDirectMemoryOfOneWindowOfARepeatedRange) {
  tlm::tlm_dmi dmi;
  ASSERT_TRUE(b.system.direct_memory(at::small_ram + 0x804, dmi));
  EXPECT_EQ(dmi.get_start_address(), at::small_ram + 0x800);
  EXPECT_EQ(dmi.get_end_address(), at::small_ram + 0xbff);
  EXPECT_EQ(dmi.get_dmi_ptr(), b.small_ram.data());
}

TEST_F(Matrix, TellsTheWaitStatesOfDirectMemory) {
  tlm::tlm_dmi dmi;
  ASSERT_TRUE(b.system.direct_memory(at::slow_ram, dmi));
  EXPECT_EQ(dmi.get_read_latency(), b.cycles(3));
  EXPECT_EQ(dmi.get_write_latency(), b.cycles(3));
}

TEST_F(Matrix, DeniesDirectMemoryOfDevicesAndHolesWithTheExtentOfTheDenial) {
  tlm::tlm_dmi dmi;
  EXPECT_FALSE(b.system.direct_memory(at::probe + 4, dmi));
  EXPECT_TRUE(dmi.is_none_allowed());
  EXPECT_EQ(dmi.get_start_address(), at::probe);
  EXPECT_EQ(dmi.get_end_address(), at::probe + 0xfff);
  EXPECT_FALSE(b.system.direct_memory(at::absent, dmi));
  EXPECT_FALSE(b.system.direct_memory(at::nothing, dmi));
  EXPECT_EQ(dmi.get_start_address(), at::absent + 0x1000);
}

TEST_F(Matrix, InvalidatesEveryAliasOnEveryBus) {
  b.ram.socket->invalidate_direct_mem_ptr(0x900, 0x9ff);
  const std::vector<Initiator::Range> both = {{at::ram + 0x900, at::ram + 0x9ff},
                                              {at::ram_alias + 0x100, at::ram_alias + 0x1ff}};
  EXPECT_EQ(b.fetch.invalidated, both);
  EXPECT_EQ(b.load.invalidated, both);
  EXPECT_EQ(b.system.invalidated, both);
}

TEST_F(Matrix, InvalidatesOnlyAliasesThatShowTheRange) {
  b.ram.socket->invalidate_direct_mem_ptr(0, 3);
  EXPECT_EQ(b.system.invalidated.size(), 1u);
  b.small_ram.socket->invalidate_direct_mem_ptr(0, ~uint64_t{0});
  ASSERT_EQ(b.system.invalidated.size(), 5u);
  EXPECT_EQ(b.system.invalidated[4],
            (Initiator::Range{at::small_ram + 0xc00, at::small_ram + 0xfff}));
}

TEST_F(Matrix, DebugsAcrossTheSeamOfTwoRanges) {
  // ram ends where its alias begins, so these 8 bytes are ram's last word and its middle one.
  const uint32_t written[2] = {0x01020304, 0x05060708};
  ASSERT_EQ(
      b.load.debug(tlm::TLM_WRITE_COMMAND, at::ram + 0xffc, const_cast<uint32_t*>(written), 8), 8u);
  EXPECT_EQ(b.system.read(at::ram + 0xffc).value, 0x01020304u);
  EXPECT_EQ(b.system.read(at::ram + 0x800).value, 0x05060708u);
}

TEST_F(Matrix, DebugStopsAtAHoleAndSaysHowFarItCame) {
  unsigned char bytes[32];
  EXPECT_EQ(b.load.debug(tlm::TLM_READ_COMMAND, at::slow_ram + 0xff0, bytes, 32), 16u);
  EXPECT_EQ(b.load.debug(tlm::TLM_READ_COMMAND, at::nothing, bytes, 4), 0u);
}

TEST_F(Matrix, KnowsItsTargetsByName) {
  EXPECT_EQ(b.matrix.error(), "");
  EXPECT_EQ(b.matrix.targets(),
            (std::vector<std::string>{"ram", "slow_ram", "small_ram", "apb_bridge", "absent"}));
  EXPECT_EQ(b.matrix.port("probe"), nullptr);
}

TEST_F(Matrix, UnimplementedDevicesReadZeroDropWritesAndAreReportedOnceWithThePc) {
  const uint64_t before = b.absent.accesses();
  EXPECT_EQ(b.system.transfer(tlm::TLM_READ_COMMAND, at::absent + 0x24, 0xffffffff, 4).value, 0u);
  EXPECT_TRUE(b.system.write(at::absent + 0x28, 5, 1).ok());
  EXPECT_EQ(b.system.read(at::absent + 0x28).value, 0u);
  EXPECT_EQ(b.absent.accesses(), before + 3);
  EXPECT_EQ(kit::guest_error_count("absent"), 1u);
  EXPECT_NE(b.absent.report().find("0x50000024"), std::string::npos) << b.absent.report();
  EXPECT_NE(b.absent.report().find("pc 0x00001234"), std::string::npos) << b.absent.report();
}

TEST_F(Matrix, DebugOfAnUnimplementedDeviceReadsZeroUnnoticed) {
  const uint64_t before = b.absent.accesses();
  EXPECT_EQ(b.system.debug_read(at::absent), 0u);
  EXPECT_EQ(b.absent.accesses(), before);
}

}  // namespace
}  // namespace capsoc::test
