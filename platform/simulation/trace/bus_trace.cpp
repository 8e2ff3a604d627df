#include "trace/bus_trace.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace capsoc::trace {

const char* status_name(tlm::tlm_response_status status) {
  switch (status) {
    case tlm::TLM_OK_RESPONSE:
      return "ok";
    case tlm::TLM_ADDRESS_ERROR_RESPONSE:
      return "address-error";
    case tlm::TLM_COMMAND_ERROR_RESPONSE:
      return "command-error";
    case tlm::TLM_BURST_ERROR_RESPONSE:
      return "burst-error";
    case tlm::TLM_BYTE_ENABLE_ERROR_RESPONSE:
      return "byte-enable-error";
    case tlm::TLM_INCOMPLETE_RESPONSE:
      return "no-response";
    default:
      return "slave-error";
  }
}

const char* data_port(uint32_t address) {
  if (address >> 20U == 0xE00) return "ppb";
  return address < 0x20000000 ? "d-code" : "system";
}

uint32_t data_word(const tlm::tlm_generic_payload& payload) {
  uint32_t word = 0;
  const unsigned size = std::min(payload.get_data_length(), 4U);
  for (unsigned i = 0; i < size; ++i)
    word |= static_cast<uint32_t>(payload.get_data_ptr()[i]) << (8 * i);
  return word;
}

BusTrace::BusTrace(std::unique_ptr<LineFile> file,
                   const std::vector<soc::BoardPeripheral>& registers)
    : file_(std::move(file)), targets_(registers) {
  file_->heading(fmt::format("{:>12} {:>14}  {:<9} {:<5} {} {:<8}  {:<8}  {:>6} {:<13} {}", "cycle",
                             "time/s", "initiator", "what", "B", "address", "data", "cycles",
                             "status", "target"));
}

void BusTrace::put(const BusAccess& access) {
  // As many digits as bytes were carried.
  const std::string data = fmt::format("{:0{}x}", access.data, 2 * access.size);
  std::string line = fmt::format("{:>12} {:>14.9f}  {:<9} {:<5} {} {:08x}  {:>8}  {:>6} {:<13} {}",
                                 access.cycle, access.seconds, access.initiator,
                                 access.write ? "write" : "read", access.size, access.address, data,
                                 access.cycles, access.status, targets_.place(access.address));
  line.erase(line.find_last_not_of(' ') + 1);
  file_->put(std::move(line));
}

}  // namespace capsoc::trace
