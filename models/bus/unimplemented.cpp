#include "bus/unimplemented.h"

#include <fmt/format.h>

#include <cstring>
#include <utility>

#include "bus/payload.h"
#include "kit/guest_error.h"

namespace capsoc::bus {

Unimplemented::Unimplemented(const sc_core::sc_module_name& name, std::string device, uint64_t base,
                             CurrentPc current_pc)
    : sc_module(name),
      socket("socket"),
      device_(std::move(device)),
      base_(base),
      current_pc_(std::move(current_pc)) {
  socket.register_b_transport(this, &Unimplemented::b_transport);
  socket.register_transport_dbg(this, &Unimplemented::transport_dbg);
}

void Unimplemented::b_transport(tlm::tlm_generic_payload& payload, sc_core::sc_time&) {
  const tlm::tlm_response_status status = check_attributes(payload);
  payload.set_response_status(status);
  if (status != tlm::TLM_OK_RESPONSE || payload.get_command() == tlm::TLM_IGNORE_COMMAND) return;
  ++accesses_;
  if (report_.empty()) report_first(payload);
  if (!payload.is_read()) return;
  for (unsigned i = 0; i < payload.get_data_length(); ++i)
    if (byte_enabled(payload, i)) payload.get_data_ptr()[i] = 0;
  if (auto* const route = payload.get_extension<kit::DirectRoute>())
    route->begin(*this, socket.get_base_export().operator->());
}

void Unimplemented::report_first(const tlm::tlm_generic_payload& payload) {
  report_ =
      fmt::format("{} of 0x{:08x}: '{}' is not modelled, it reads 0 and drops writes",
                  payload.is_read() ? "read" : "write", base_ + payload.get_address(), device_);
  if (current_pc_) report_ += fmt::format(" (pc 0x{:08x})", current_pc_());
  kit::guest_error(device_, report_);
}

unsigned Unimplemented::transport_dbg(tlm::tlm_generic_payload& payload) {
  if (payload.get_data_ptr() == nullptr) return 0;
  if (payload.is_read()) std::memset(payload.get_data_ptr(), 0, payload.get_data_length());
  return payload.get_data_length();
}

}  // namespace capsoc::bus
