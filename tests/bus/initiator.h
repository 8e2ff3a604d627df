// An initiator for tests: one call, one transaction, everything that came back.
#pragma once

#include <gtest/gtest.h>
#include <tlm_utils/simple_initiator_socket.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <systemc>
#include <tlm>
#include <vector>

namespace capsoc::test {

struct Answer {
  tlm::tlm_response_status status;
  uint32_t value;          // what was read, 0 in the bytes that were not
  sc_core::sc_time delay;  // annotated
  bool payload_intact;     // every attribute that only the initiator may set is as it was

  bool ok() const { return status == tlm::TLM_OK_RESPONSE; }
};

class Initiator : public sc_core::sc_module {
 public:
  tlm_utils::simple_initiator_socket<Initiator> socket{"socket"};

  explicit Initiator(sc_core::sc_module_name name) : sc_module(name) {
    socket.register_invalidate_direct_mem_ptr(this, &Initiator::invalidate);
  }

  Answer read(uint64_t address, unsigned length = 4) {
    return transfer(tlm::TLM_READ_COMMAND, address, 0, length);
  }
  Answer write(uint64_t address, uint32_t value, unsigned length = 4) {
    return transfer(tlm::TLM_WRITE_COMMAND, address, value, length);
  }

  Answer transfer(tlm::tlm_command command, uint64_t address, uint32_t value, unsigned length) {
    unsigned char bytes[16] = {};
    std::memcpy(bytes, &value, 4);
    tlm::tlm_generic_payload payload;
    describe(payload, command, address, bytes, length);
    return send(payload);
  }

  static void describe(tlm::tlm_generic_payload& payload, tlm::tlm_command command,
                       uint64_t address, unsigned char* bytes, unsigned length) {
    payload.set_command(command);
    payload.set_address(address);
    payload.set_data_ptr(bytes);
    payload.set_data_length(length);
    payload.set_streaming_width(length);
    payload.set_response_status(tlm::TLM_INCOMPLETE_RESPONSE);
  }

  Answer send(tlm::tlm_generic_payload& payload, sc_core::sc_time delay = sc_core::SC_ZERO_TIME) {
    const Attributes before(payload);
    socket->b_transport(payload, delay);
    Answer answer{payload.get_response_status(), 0, delay, before == Attributes(payload)};
    if (payload.is_read() && payload.get_data_ptr() != nullptr)
      std::memcpy(&answer.value, payload.get_data_ptr(), std::min(4u, payload.get_data_length()));
    return answer;
  }

  unsigned debug(tlm::tlm_command command, uint64_t address, void* bytes, unsigned length) {
    tlm::tlm_generic_payload payload;
    describe(payload, command, address, static_cast<unsigned char*>(bytes), length);
    const Attributes before(payload);
    const unsigned done = socket->transport_dbg(payload);
    debug_payload_intact = before == Attributes(payload);
    return done;
  }

  uint32_t debug_read(uint64_t address) {
    uint32_t value = 0xdeaddead;
    return debug(tlm::TLM_READ_COMMAND, address, &value, 4) == 4 ? value : 0xdeaddead;
  }

  bool direct_memory(uint64_t address, tlm::tlm_dmi& dmi) {
    tlm::tlm_generic_payload payload;
    describe(payload, tlm::TLM_READ_COMMAND, address, nullptr, 4);
    return socket->get_direct_mem_ptr(payload, dmi);
  }

  struct Range {
    uint64_t first, last;
    bool operator==(const Range& o) const { return first == o.first && last == o.last; }
  };
  std::vector<Range> invalidated;
  bool debug_payload_intact = true;

 private:
  struct Attributes {
    explicit Attributes(const tlm::tlm_generic_payload& p)
        : command(p.get_command()),
          data(p.get_data_ptr()),
          enables(p.get_byte_enable_ptr()),
          length(p.get_data_length()),
          enable_length(p.get_byte_enable_length()),
          width(p.get_streaming_width()) {}
    bool operator==(const Attributes& o) const {
      return command == o.command && data == o.data && enables == o.enables && length == o.length &&
             enable_length == o.enable_length && width == o.width;
    }
    tlm::tlm_command command;
    const unsigned char* data;
    const unsigned char* enables;
    unsigned length, enable_length, width;
  };

  void invalidate(sc_dt::uint64 first, sc_dt::uint64 last) { invalidated.push_back({first, last}); }
};

}  // namespace capsoc::test
