// Checks of a generic payload that all bus components share.
#pragma once

#include <algorithm>
#include <cstdint>
#include <tlm>

namespace capsoc::bus {

/// True if the transfer stays at or below `last`. Its addresses span its length, or its streaming
/// width if that is less. A length or a width of 0 fits: the target rejects it.
inline bool fits(const tlm::tlm_generic_payload& payload, uint64_t address, uint64_t last) {
  const uint64_t length = std::min(payload.get_data_length(), payload.get_streaming_width());
  return length == 0 || length - 1 <= last - address;
}

/// Number of beats of a 32-bit bus that the payload represents.
inline uint64_t word_count(const tlm::tlm_generic_payload& payload) {
  return (uint64_t{payload.get_data_length()} + 3) / 4;
}

/// True if byte i is transferred: there are no byte enables, or it is enabled (the enable array
/// repeats).
inline bool byte_enabled(const tlm::tlm_generic_payload& payload, unsigned i) {
  const unsigned char* enables = payload.get_byte_enable_ptr();
  return enables == nullptr || enables[i % payload.get_byte_enable_length()] == TLM_BYTE_ENABLED;
}

/// Checks the attributes that must be valid before a target accesses data. TLM_OK_RESPONSE if they
/// are; the target checks streaming.
inline tlm::tlm_response_status check_attributes(const tlm::tlm_generic_payload& payload) {
  if (payload.get_data_length() == 0) return tlm::TLM_BURST_ERROR_RESPONSE;
  if (payload.get_streaming_width() == 0) return tlm::TLM_BURST_ERROR_RESPONSE;
  if (payload.get_data_ptr() == nullptr) return tlm::TLM_GENERIC_ERROR_RESPONSE;
  if (payload.get_byte_enable_ptr() != nullptr && payload.get_byte_enable_length() == 0)
    return tlm::TLM_BYTE_ENABLE_ERROR_RESPONSE;
  return tlm::TLM_OK_RESPONSE;
}

/// Copies all attributes, but no extensions.
inline void copy_attributes(const tlm::tlm_generic_payload& from, tlm::tlm_generic_payload& to) {
  to.set_command(from.get_command());
  to.set_address(from.get_address());
  to.set_data_ptr(from.get_data_ptr());
  to.set_data_length(from.get_data_length());
  to.set_byte_enable_ptr(from.get_byte_enable_ptr());
  to.set_byte_enable_length(from.get_byte_enable_length());
  to.set_streaming_width(from.get_streaming_width());
  to.set_dmi_allowed(from.is_dmi_allowed());
  to.set_response_status(from.get_response_status());
}

}  // namespace capsoc::bus
