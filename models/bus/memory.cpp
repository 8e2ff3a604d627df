#include "bus/memory.h"

#include <algorithm>
#include <cstring>

#include "bus/payload.h"

namespace capsoc::bus {

Memory::Memory(const sc_core::sc_module_name& name, uint64_t size)
    : sc_module(name),
      socket("socket"),
      size_(size),
      bytes_(static_cast<uint8_t*>(std::calloc(size, 1))) {
  if (bytes_ == nullptr) size_ = 0;  // then every access is an address error
  socket.bind(*this);
}

void Memory::clear() {
  std::fill_n(bytes_.get(), size_, uint8_t{0});
}

void Memory::b_transport(tlm::tlm_generic_payload& payload, sc_core::sc_time&) {
  const tlm::tlm_response_status status = access(payload);
  payload.set_response_status(status);
  payload.set_dmi_allowed(status == tlm::TLM_OK_RESPONSE);
}

/// At once: a memory has no phases.
tlm::tlm_sync_enum Memory::nb_transport_fw(tlm::tlm_generic_payload& payload, tlm::tlm_phase& phase,
                                           sc_core::sc_time& delay) {
  if (phase != tlm::BEGIN_REQ) return tlm::TLM_ACCEPTED;
  b_transport(payload, delay);
  return tlm::TLM_COMPLETED;
}

tlm::tlm_response_status Memory::access(tlm::tlm_generic_payload& payload) {
  const tlm::tlm_response_status attributes = check_attributes(payload);
  if (attributes != tlm::TLM_OK_RESPONSE) return attributes;
  const uint64_t span = std::min(payload.get_data_length(), payload.get_streaming_width());
  if (span > size_ || payload.get_address() > size_ - span) return tlm::TLM_ADDRESS_ERROR_RESPONSE;
  if (payload.get_command() != tlm::TLM_IGNORE_COMMAND) copy(payload);
  return tlm::TLM_OK_RESPONSE;
}

void Memory::copy(tlm::tlm_generic_payload& payload) {
  uint8_t* const memory = bytes_.get() + payload.get_address();
  unsigned char* const data = payload.get_data_ptr();
  const unsigned length = payload.get_data_length();
  const unsigned width = payload.get_streaming_width();
  if (payload.get_byte_enable_ptr() == nullptr && width >= length) {
    if (payload.is_read())
      std::memcpy(data, memory, length);
    else
      std::memcpy(memory, data, length);
    return;
  }
  for (unsigned i = 0; i < length; ++i) {
    if (!byte_enabled(payload, i)) continue;
    if (payload.is_read())
      data[i] = memory[i % width];
    else
      memory[i % width] = data[i];
  }
}

unsigned Memory::transport_dbg(tlm::tlm_generic_payload& payload) {
  const uint64_t address = payload.get_address();
  if (address >= size_ || payload.get_data_ptr() == nullptr) return 0;
  const auto length =
      static_cast<unsigned>(std::min<uint64_t>(payload.get_data_length(), size_ - address));
  if (payload.is_read())
    std::memcpy(payload.get_data_ptr(), bytes_.get() + address, length);
  else if (payload.is_write())
    std::memcpy(bytes_.get() + address, payload.get_data_ptr(), length);
  else
    return 0;
  return length;
}

bool Memory::get_direct_mem_ptr(tlm::tlm_generic_payload& payload, tlm::tlm_dmi& dmi) {
  if (payload.get_address() >= size_) return false;
  dmi.allow_read_write();
  dmi.set_dmi_ptr(bytes_.get());
  dmi.set_start_address(0);
  dmi.set_end_address(size_ - 1);
  return true;
}

}  // namespace capsoc::bus
