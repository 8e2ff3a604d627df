#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <systemc>
#include <tlm>
#include <vector>

namespace capsoc::test {

/// Calls a target's transport functions directly, without a bus or an elaborated platform.
class BusAccess {
 public:
  template <typename Socket>
  explicit BusAccess(Socket& socket) : target_(*socket.get_base_export().operator->()) {}

  tlm::tlm_response_status transport(tlm::tlm_generic_payload& payload) {
    payload.set_response_status(tlm::TLM_INCOMPLETE_RESPONSE);
    sc_core::sc_time delay = ahead;
    target_.b_transport(payload, delay);
    EXPECT_EQ(delay, ahead) << "a register access takes no time of its own";
    EXPECT_NE(payload.get_response_status(), tlm::TLM_INCOMPLETE_RESPONSE)
        << "a payload must be answered";
    return payload.get_response_status();
  }

  tlm::tlm_response_status write(uint64_t offset, uint32_t value, unsigned length = 4) {
    std::array<unsigned char, 4> data = bytes(value);
    tlm::tlm_generic_payload payload;
    fill(payload, tlm::TLM_WRITE_COMMAND, offset, data.data(), length);
    return transport(payload);
  }

  tlm::tlm_response_status read(uint64_t offset, uint32_t& value, unsigned length = 4) {
    std::array<unsigned char, 4> data{};
    tlm::tlm_generic_payload payload;
    fill(payload, tlm::TLM_READ_COMMAND, offset, data.data(), length);
    const auto status = transport(payload);
    value = word(data);
    return status;
  }

  /// A read that must succeed.
  uint32_t value_at(uint64_t offset, unsigned length = 4) {
    uint32_t value = 0;
    EXPECT_EQ(read(offset, value, length), tlm::TLM_OK_RESPONSE) << "at offset " << offset;
    return value;
  }

  /// The bytes that a debugger reads.
  std::vector<unsigned char> debug_bytes(uint64_t offset, unsigned length) {
    std::vector<unsigned char> data(length);
    tlm::tlm_generic_payload payload;
    fill(payload, tlm::TLM_READ_COMMAND, offset, data.data(), length);
    data.resize(target_.transport_dbg(payload));
    return data;
  }

  uint32_t debug_value_at(uint64_t offset) {
    const auto data = debug_bytes(offset, 4);
    EXPECT_EQ(data.size(), 4u);
    return data.size() < 4 ? 0 : word({data[0], data[1], data[2], data[3]});
  }

  unsigned debug_write(uint64_t offset, uint32_t value) {
    std::array<unsigned char, 4> data = bytes(value);
    tlm::tlm_generic_payload payload;
    fill(payload, tlm::TLM_WRITE_COMMAND, offset, data.data(), 4);
    return target_.transport_dbg(payload);
  }

  static void fill(tlm::tlm_generic_payload& payload, tlm::tlm_command command, uint64_t offset,
                   unsigned char* data, unsigned length) {
    payload.set_command(command);
    payload.set_address(offset);
    payload.set_data_ptr(data);
    payload.set_data_length(length);
    payload.set_streaming_width(length);
  }

  static std::array<unsigned char, 4> bytes(uint32_t value) {
    return {static_cast<unsigned char>(value), static_cast<unsigned char>(value >> 8),
            static_cast<unsigned char>(value >> 16), static_cast<unsigned char>(value >> 24)};
  }

  static uint32_t word(const std::array<unsigned char, 4>& data) {
    return data[0] | data[1] << 8 | data[2] << 16 | uint32_t{data[3]} << 24;
  }

  /// The initiator's delay in every access.
  sc_core::sc_time ahead;

 private:
  tlm::tlm_fw_transport_if<>& target_;
};

}  // namespace capsoc::test

#define EXPECT_OK(access) EXPECT_EQ((access), tlm::TLM_OK_RESPONSE)
#define EXPECT_ADDRESS_ERROR(access) EXPECT_EQ((access), tlm::TLM_ADDRESS_ERROR_RESPONSE)
