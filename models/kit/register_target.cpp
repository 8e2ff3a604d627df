#include "kit/register_target.h"

#include <fmt/format.h>

#include <cstring>

#include "kit/direct_route.h"
#include "kit/early_write.h"
#include "kit/guest_error.h"
#include "kit/steady_read.h"

namespace capsoc::kit {
namespace {

bool byte_enables_are_legal(const tlm::tlm_generic_payload& payload) {
  const unsigned char* enables = payload.get_byte_enable_ptr();
  if (enables == nullptr) return true;
  if (payload.get_byte_enable_length() == 0) return false;
  for (unsigned i = 0; i < payload.get_byte_enable_length(); ++i) {
    if (enables[i] != TLM_BYTE_DISABLED && enables[i] != TLM_BYTE_ENABLED) return false;
  }
  return true;
}

// Enables shorter than the data repeat (IEEE 1666-2011, 14.14).
bool byte_is_enabled(const tlm::tlm_generic_payload& payload, unsigned index) {
  const unsigned char* enables = payload.get_byte_enable_ptr();
  return enables == nullptr ||
         enables[index % payload.get_byte_enable_length()] == TLM_BYTE_ENABLED;
}

uint32_t lanes_of(const tlm::tlm_generic_payload& payload) {
  if (payload.get_data_length() == 4 && payload.get_byte_enable_ptr() == nullptr)
    return 0xFFFFFFFFu;
  const unsigned first = static_cast<unsigned>(payload.get_address() % 4);
  if (payload.get_byte_enable_ptr() == nullptr)
    return (0xFFFFFFFFu >> (8 * (4 - payload.get_data_length()))) << (8 * first);
  uint32_t lanes = 0;
  for (unsigned i = 0; i < payload.get_data_length(); ++i) {
    if (byte_is_enabled(payload, i)) lanes |= 0xFFu << (8 * (first + i));
  }
  return lanes;
}

}  // namespace

RegisterTarget::RegisterTarget(const sc_core::sc_module_name& name, uint64_t size, AccessRule rule)
    : sc_module(name), size_(size), rule_(rule) {
  socket.register_b_transport(this, &RegisterTarget::b_transport);
  socket.register_transport_dbg(this, &RegisterTarget::transport_dbg);
}

void RegisterTarget::report(std::string_view text) const {
  guest_error(name(), text);
}

void RegisterTarget::b_transport(tlm::tlm_generic_payload& payload, sc_core::sc_time& delay) {
  payload.set_dmi_allowed(false);
  payload.set_response_status(check(payload));
  if (payload.is_response_error()) {
    report(fmt::format("access of {} bytes at offset 0x{:x} refused ({})",
                       payload.get_data_length(), payload.get_address(),
                       payload.get_response_string()));
    return;
  }
  delay_ = delay;
  payload.set_response_status(access(payload));
  delay_ = sc_core::SC_ZERO_TIME;
}

tlm::tlm_response_status RegisterTarget::check(const tlm::tlm_generic_payload& payload) const {
  const unsigned length = payload.get_data_length();
  const uint64_t address = payload.get_address();
  if (!payload.is_read() && !payload.is_write()) return tlm::TLM_COMMAND_ERROR_RESPONSE;
  if (payload.get_data_ptr() == nullptr) return tlm::TLM_GENERIC_ERROR_RESPONSE;
  if (length != 1 && length != 2 && length != 4) return tlm::TLM_BURST_ERROR_RESPONSE;
  if (payload.get_streaming_width() < length) return tlm::TLM_BURST_ERROR_RESPONSE;
  if (!byte_enables_are_legal(payload)) return tlm::TLM_BYTE_ENABLE_ERROR_RESPONSE;
  if (address >= size_ || address % length != 0) return tlm::TLM_ADDRESS_ERROR_RESPONSE;
  if (rule_ == AccessRule::word_only) {
    const uint32_t lanes = lanes_of(payload);
    if (length != 4) return tlm::TLM_ADDRESS_ERROR_RESPONSE;
    if (payload.is_write() && lanes != 0 && lanes != 0xFFFFFFFF)
      return tlm::TLM_ADDRESS_ERROR_RESPONSE;
  }
  return tlm::TLM_OK_RESPONSE;
}

/// Of an access that was answered.
void RegisterTarget::describe_route(tlm::tlm_generic_payload& payload, uint32_t offset) {
  auto* const route = payload.get_extension<DirectRoute>();
  if (route != nullptr && is_direct(offset))
    route->begin(*this, offset, socket.get_base_export().operator->());
}

bool RegisterTarget::read_ahead(uint32_t offset, uint32_t& value, const sc_core::sc_time& time) {
  direct_ = &time;
  notified_ = false;
  read_word(offset, value, false);
  direct_ = nullptr;
  return notified_;
}

bool RegisterTarget::write_early(uint32_t offset, uint32_t value, uint32_t lanes,
                                 const sc_core::sc_time& time) {
  direct_ = &time;
  const bool taken = takes_early(offset, value & lanes, lanes);
  if (taken) write_word(offset, value & lanes, lanes);
  direct_ = nullptr;
  return taken;
}

tlm::tlm_response_status RegisterTarget::access(tlm::tlm_generic_payload& payload) {
  const uint32_t lanes = lanes_of(payload);
  if (lanes == 0) return tlm::TLM_OK_RESPONSE;  // no byte takes part, so no register is touched
  const bool whole = lanes == 0xFFFFFFFFu;      // the usual case
  const unsigned first = static_cast<unsigned>(payload.get_address() % 4);
  const uint32_t offset = static_cast<uint32_t>(payload.get_address()) - first;
  unsigned char* data = payload.get_data_ptr();
  uint32_t value = 0;
  if (payload.is_write()) {
    if (whole)
      std::memcpy(&value, data, 4);
    else
      for (unsigned i = 0; i < payload.get_data_length(); ++i)
        value |= uint32_t{data[i]} << (8 * (first + i));
    if (auto* const told = payload.get_extension<EarlyWrite>()) {
      told->taken = takes_early(offset, value & lanes, lanes);
      if (told->refused()) return tlm::TLM_OK_RESPONSE;
    }
    if (!write_word(offset, value & lanes, lanes)) return tlm::TLM_ADDRESS_ERROR_RESPONSE;
    describe_route(payload, offset);
    return tlm::TLM_OK_RESPONSE;
  }
  if (!read_word(offset, value, false)) return tlm::TLM_ADDRESS_ERROR_RESPONSE;
  if (whole) {
    std::memcpy(data, &value, 4);
  } else {
    for (unsigned i = 0; i < payload.get_data_length(); ++i) {
      if (byte_is_enabled(payload, i))
        data[i] = static_cast<unsigned char>(value >> (8 * (first + i)));
    }
  }
  if (auto* const told = payload.get_extension<SteadyRead>()) {
    told->steady = is_steady(offset);
    told->ahead = is_read_ahead(offset);
  }
  describe_route(payload, offset);
  return tlm::TLM_OK_RESPONSE;
}

uint32_t RegisterTarget::peek(uint32_t offset) {
  uint32_t value = 0;
  return offset < size_ && read_word(offset & ~uint32_t{3}, value, true) ? value : 0;
}

// Any length and alignment, up to the first offset without a register: a debugger reads what it
// likes. Debug writes are refused, since a register that is written without its effect is no longer
// that register.
unsigned RegisterTarget::transport_dbg(tlm::tlm_generic_payload& payload) {
  payload.set_response_status(tlm::TLM_GENERIC_ERROR_RESPONSE);
  if (!payload.is_read() || payload.get_data_ptr() == nullptr) return 0;
  unsigned done = 0;
  uint32_t value = 0;
  for (; done < payload.get_data_length(); ++done) {
    const uint64_t address = payload.get_address() + done;
    if (address >= size_) break;
    const bool is_next_word = done == 0 || address % 4 == 0;
    if (is_next_word && !read_word(static_cast<uint32_t>(address & ~uint64_t{3}), value, true))
      break;
    payload.get_data_ptr()[done] = static_cast<unsigned char>(value >> (8 * (address % 4)));
  }
  if (done != 0) payload.set_response_status(tlm::TLM_OK_RESPONSE);
  return done;
}

}  // namespace capsoc::kit
