#include "kit/register_bank.h"

#include <gtest/gtest.h>

#include <array>
#include <random>
#include <stdexcept>

#include "bus_access.h"
#include "kit/guest_error.h"

namespace {

using capsoc::kit::AccessRule;
using capsoc::kit::guest_error_count;
using capsoc::kit::Holes;
using capsoc::kit::Register;
using capsoc::kit::RegisterBank;
using capsoc::registers::Access;
using capsoc::registers::RegisterDescription;
using capsoc::test::BusAccess;

constexpr RegisterDescription data_description{"DATA",     0x0, Access::read_write, 0x11223344,
                                               0xFFFFFFFF, 0,   0xFFFFFFFF};
constexpr RegisterDescription flags_description{"FLAGS", 0x4,   Access::read_write, 0x0, 0x000F,
                                                0x0F00,  0x0F0F};
constexpr RegisterDescription id_description{"ID", 0x8, Access::read_only, 0xCAFE,
                                             0,    0,   0xFFFFFFFF};
constexpr RegisterDescription fifo_description{"FIFO", 0xC, Access::read_write, 0, 0xFF, 0, 0xFF};
constexpr RegisterDescription command_description{
    "COMMAND", 0x10, Access::write_only, 0, 0xFFFFFFFF, 0, 0};

struct Device : RegisterBank {
  explicit Device(AccessRule rule = AccessRule::any_width, Holes holes = Holes::bus_error)
      : RegisterBank("device", 0x20, rule, holes) {
    fifo.on_read([this] { return ++pops; });
    command.on_write([this](uint32_t value) { commands.push_back(value); });
  }

  Register data{*this, data_description};
  Register flags{*this, flags_description};
  Register id{*this, id_description};
  Register fifo{*this, fifo_description};
  Register command{*this, command_description};
  uint32_t pops = 0;
  std::vector<uint32_t> commands;
};

/// A read of the word at 0, for a test to spoil.
struct WordRead : tlm::tlm_generic_payload {
  explicit WordRead(unsigned char* into) {
    BusAccess::fill(*this, tlm::TLM_READ_COMMAND, 0, into, 4);
  }
};

class RegisterBankTest : public testing::Test {
 protected:
  void SetUp() override { capsoc::kit::clear_guest_errors(); }

  uint64_t errors() { return guest_error_count("device"); }
  Device device;
  BusAccess bus{device.socket};
  std::array<unsigned char, 16> buffer{};
};

TEST_F(RegisterBankTest, WordsHalfwordsAndBytesAreLittleEndian) {
  EXPECT_EQ(bus.value_at(0x0), 0x11223344u);
  EXPECT_EQ(bus.value_at(0x2, 2), 0x1122u);
  EXPECT_EQ(bus.value_at(0x1, 1), 0x33u);
  EXPECT_OK(bus.write(0x3, 0xAA, 1));
  EXPECT_OK(bus.write(0x0, 0xBEEF, 2));
  EXPECT_EQ(bus.value_at(0x0), 0xAA22BEEFu);
}

TEST_F(RegisterBankTest, WritesKeepBitsThatCannotBeWritten) {
  EXPECT_OK(bus.write(0x4, 0xFFFFFFFF));
  EXPECT_EQ(bus.value_at(0x4), 0x000Fu);
  EXPECT_EQ(errors(), 1u) << "reserved bits are reported";
}

TEST_F(RegisterBankTest, AOneClearsAFlagAndAZeroKeepsIt) {
  device.flags.raise(0x0F00);
  EXPECT_OK(bus.write(0x4, 0x0100));
  EXPECT_EQ(bus.value_at(0x4), 0x0E00u);
  EXPECT_OK(bus.write(0x4, 0x03, 1));
  EXPECT_EQ(bus.value_at(0x4), 0x0E03u) << "a byte that takes no part clears nothing";
}

TEST_F(RegisterBankTest, AWriteToReadOnlyIsIgnoredAndReported) {
  EXPECT_OK(bus.write(0x8, 1));
  EXPECT_EQ(bus.value_at(0x8), 0xCAFEu);
  EXPECT_EQ(errors(), 1u);
}

TEST_F(RegisterBankTest, AReadOfWriteOnlyYieldsZeroAndIsReported) {
  EXPECT_OK(bus.write(0x10, 77));
  EXPECT_EQ(device.commands, std::vector<uint32_t>{77});
  EXPECT_EQ(bus.value_at(0x10), 0u);
  EXPECT_EQ(errors(), 1u);
}

TEST_F(RegisterBankTest, AHoleIsABusErrorAndReported) {
  uint32_t value = 0;
  EXPECT_ADDRESS_ERROR(bus.read(0x14, value));
  EXPECT_ADDRESS_ERROR(bus.write(0x1C, 0));
  EXPECT_EQ(errors(), 2u);
}

TEST_F(RegisterBankTest, ReportsBeyondTheLimitAreCountedAsWell) {
  for (int i = 0; i < 25; ++i) bus.write(0x8, 1);
  EXPECT_EQ(errors(), 25u);
}

TEST_F(RegisterBankTest, BeyondTheDeviceIsABusError) {
  uint32_t value = 0;
  EXPECT_ADDRESS_ERROR(bus.read(0x20, value));
  EXPECT_ADDRESS_ERROR(bus.read(0xFFFFFFFFFFFFFFFC, value));
  EXPECT_ADDRESS_ERROR(bus.write(0x1'0000'0000, 0));
}

TEST_F(RegisterBankTest, UnalignedAccessesAreRefused) {
  uint32_t value = 0;
  EXPECT_ADDRESS_ERROR(bus.read(0x1, value, 2));
  EXPECT_ADDRESS_ERROR(bus.write(0x2, 0, 4));
  EXPECT_EQ(bus.value_at(0x0), 0x11223344u);
}

TEST_F(RegisterBankTest, OddLengthsAreRefused) {
  for (const unsigned length : {0u, 3u, 8u, 16u, 4096u}) {
    WordRead payload(buffer.data());
    payload.set_data_length(length);
    payload.set_streaming_width(length);
    EXPECT_EQ(bus.transport(payload), tlm::TLM_BURST_ERROR_RESPONSE) << length;
  }
}

TEST_F(RegisterBankTest, StreamingIsRefused) {
  for (const unsigned width : {0u, 1u, 3u}) {
    WordRead payload(buffer.data());
    payload.set_streaming_width(width);
    EXPECT_EQ(bus.transport(payload), tlm::TLM_BURST_ERROR_RESPONSE) << width;
  }
}

TEST_F(RegisterBankTest, AWrongCommandIsRefused) {
  for (const int command : {int{tlm::TLM_IGNORE_COMMAND}, 3}) {
    WordRead payload(buffer.data());
    payload.set_command(static_cast<tlm::tlm_command>(command));
    EXPECT_EQ(bus.transport(payload), tlm::TLM_COMMAND_ERROR_RESPONSE);
  }
}

TEST_F(RegisterBankTest, APayloadWithoutDataIsRefused) {
  WordRead payload(nullptr);
  EXPECT_EQ(bus.transport(payload), tlm::TLM_GENERIC_ERROR_RESPONSE);
}

TEST_F(RegisterBankTest, ByteEnablesSelectTheBytesOfAWrite) {
  auto data = BusAccess::bytes(0xAABBCCDD);
  std::array<unsigned char, 4> enables{0xFF, 0x00, 0x00, 0xFF};
  tlm::tlm_generic_payload payload;
  BusAccess::fill(payload, tlm::TLM_WRITE_COMMAND, 0, data.data(), 4);
  payload.set_byte_enable_ptr(enables.data());
  payload.set_byte_enable_length(4);
  EXPECT_OK(bus.transport(payload));
  EXPECT_EQ(bus.value_at(0x0), 0xAA2233DDu);
}

TEST_F(RegisterBankTest, ByteEnablesSelectTheBytesOfARead) {
  buffer.fill(0x77);
  std::array<unsigned char, 2> enables{0x00, 0xFF};  // repeats
  WordRead payload(buffer.data());
  payload.set_byte_enable_ptr(enables.data());
  payload.set_byte_enable_length(2);
  EXPECT_OK(bus.transport(payload));
  EXPECT_EQ(BusAccess::word({buffer[0], buffer[1], buffer[2], buffer[3]}), 0x11773377u);
}

TEST_F(RegisterBankTest, AnAccessWithoutBytesTouchesNothing) {
  std::array<unsigned char, 1> none{0x00};
  WordRead payload(buffer.data());
  payload.set_address(0xC);
  payload.set_byte_enable_ptr(none.data());
  payload.set_byte_enable_length(1);
  EXPECT_OK(bus.transport(payload));
  EXPECT_EQ(device.pops, 0u);
}

TEST_F(RegisterBankTest, IllegalByteEnablesAreRefused) {
  std::array<unsigned char, 4> enables{0xFF, 0x01, 0xFF, 0xFF};
  WordRead payload(buffer.data());
  payload.set_byte_enable_ptr(enables.data());
  payload.set_byte_enable_length(4);
  EXPECT_EQ(bus.transport(payload), tlm::TLM_BYTE_ENABLE_ERROR_RESPONSE);
  payload.set_byte_enable_length(0);
  EXPECT_EQ(bus.transport(payload), tlm::TLM_BYTE_ENABLE_ERROR_RESPONSE);
}

TEST_F(RegisterBankTest, DebugReadsHaveNoSideEffect) {
  EXPECT_EQ(bus.debug_value_at(0xC), 0u);
  EXPECT_EQ(device.pops, 0u);
  EXPECT_EQ(bus.value_at(0xC), 1u);
  EXPECT_EQ(bus.debug_bytes(0x10, 4).size(), 4u) << "write-only reads 0";
  EXPECT_EQ(bus.debug_bytes(0x14, 4).size(), 0u);
  EXPECT_EQ(errors(), 0u) << "the debugger is no guest";
}

TEST_F(RegisterBankTest, DebugReadsTakeAnyLengthUpToTheFirstHole) {
  const auto data = bus.debug_bytes(0x1, 64);
  ASSERT_EQ(data.size(), 0x13u);
  EXPECT_EQ(data[0], 0x33);
  EXPECT_EQ(data[7], 0xFE);
}

TEST_F(RegisterBankTest, DebugWritesAreRefused) {
  EXPECT_EQ(bus.debug_write(0x0, 5), 0u);
  EXPECT_EQ(bus.debug_write(0x10, 5), 0u);
  EXPECT_EQ(bus.value_at(0x0), 0x11223344u);
  EXPECT_TRUE(device.commands.empty());
}

TEST_F(RegisterBankTest, ResetRestoresEveryRegister) {
  EXPECT_OK(bus.write(0x0, 1));
  device.flags.raise(0x0F0F);
  device.reset_registers();
  EXPECT_EQ(bus.value_at(0x0), 0x11223344u);
  EXPECT_EQ(bus.value_at(0x4), 0u);
}

TEST_F(RegisterBankTest, AnyPayloadIsAnswered) {
  const unsigned seed = 20240607;
  std::mt19937 random(seed);
  const auto below = [&random](uint32_t limit) { return random() % limit; };
  for (int i = 0; i < 20000; ++i) {
    std::array<unsigned char, 4> enables;
    for (auto& each : enables)
      each = static_cast<unsigned char>(below(4) == 0 ? random() : 0xFF * below(2));
    tlm::tlm_generic_payload payload;
    BusAccess::fill(payload, static_cast<tlm::tlm_command>(below(4)), random(), buffer.data(),
                    below(17));
    if (below(2) != 0) payload.set_address(below(0x24));
    if (below(4) == 0) payload.set_streaming_width(below(9));
    if (below(4) == 0) payload.set_data_ptr(nullptr);
    if (below(2) != 0) payload.set_byte_enable_ptr(enables.data());
    payload.set_byte_enable_length(below(5));
    bus.transport(payload);
  }
  SUCCEED() << "seed " << seed;
}

TEST(RegisterBankRules, WordOnlyRefusesBytesHalfwordsAndPartialWrites) {
  Device device(AccessRule::word_only);
  BusAccess bus(device.socket);
  uint32_t value = 0;
  EXPECT_ADDRESS_ERROR(bus.read(0x0, value, 1));
  EXPECT_ADDRESS_ERROR(bus.read(0x2, value, 2));
  EXPECT_ADDRESS_ERROR(bus.write(0x0, 0, 2));
  std::array<unsigned char, 4> data{}, enables{0xFF, 0xFF, 0xFF, 0x00};
  tlm::tlm_generic_payload payload;
  BusAccess::fill(payload, tlm::TLM_WRITE_COMMAND, 0, data.data(), 4);
  payload.set_byte_enable_ptr(enables.data());
  payload.set_byte_enable_length(4);
  EXPECT_ADDRESS_ERROR(bus.transport(payload));
  EXPECT_OK(bus.write(0x0, 9));
  EXPECT_EQ(bus.value_at(0x0), 9u);
}

TEST(RegisterBankRules, HolesCanReadZero) {
  Device device(AccessRule::any_width, Holes::reads_zero);
  BusAccess bus(device.socket);
  EXPECT_OK(bus.write(0x14, 5));
  EXPECT_EQ(bus.value_at(0x14), 0u);
}

TEST(RegisterBankRules, OverlapsAndStrayRegistersAreFoundAtConstruction) {
  Device device;
  EXPECT_THROW(Register(device, data_description), std::logic_error);
  EXPECT_THROW(Register(device, {"ODD", 0x15, Access::read_write, 0, 0, 0, 0}), std::logic_error);
  EXPECT_THROW(Register(device, {"FAR", 0x20, Access::read_write, 0, 0, 0, 0}), std::logic_error);
}

}  // namespace
