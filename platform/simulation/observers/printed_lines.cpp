#include "observers/printed_lines.h"

#include <fmt/format.h>

#include <algorithm>

namespace capsoc::run {
namespace {

/// Lines that may be on their way: the UART holds two bytes.
constexpr std::size_t most_lines = 4;

}  // namespace

std::optional<Error> PrintedLines::open() {
  soc::Soc& soc = view_.soc();
  for (std::size_t n = 0; n < uarts_.size(); ++n) {
    const bus::MapEntry* entry = bus::find_entry(soc.ahb.map(), fmt::format("uart{}", n));
    addresses_[n] = entry != nullptr ? static_cast<uint32_t>(entry->base) : 0;
    uarts_[n].transmitted = soc.uarts()[n]->transmitted.listen([this, n](uint8_t) {
      Uart& uart = uarts_[n];
      ++uart.sent;
      while (uart.lines.size() > 1 && uart.lines[1].number <= uart.sent) uart.lines.pop_front();
    });
  }
  transfers_ = soc.ahb.transfers.listen([this](const tlm::tlm_generic_payload& payload,
                                               const sc_core::sc_time&,
                                               const sc_core::sc_time&) { written(payload); });
  return std::nullopt;
}

/// DATA is the first register of a UART.
void PrintedLines::written(const tlm::tlm_generic_payload& payload) {
  if (!payload.is_write() || !payload.is_response_ok() || payload.get_data_length() == 0) return;
  const auto found =
      std::find(addresses_.begin(), addresses_.end(), static_cast<uint32_t>(payload.get_address()));
  if (found == addresses_.end() || *found == 0) return;
  Uart& uart = uarts_[static_cast<std::size_t>(found - addresses_.begin())];
  ++uart.written;
  uart.newest = view_.registers();
  if (*payload.get_data_ptr() != '\n') return;
  uart.lines.push_back({uart.written, view_.call_stack(uart.newest)});
  if (uart.lines.size() > most_lines) uart.lines.pop_front();
}

/// Of a crash or a limit, where the program is says more.
void PrintedLines::finish(RunResult& result) {
  if (result.code == exit_code::limit || result.code == exit_code::crashed) return;
  if (const auto uart = lines_.failed())
    result.place_report = describe_line(lines_.line(*uart), view_, call_stack(*uart));
}

std::string PrintedLines::call_stack(std::size_t number) const {
  const Uart& uart = uarts_[number];
  if (uart.written == 0) return "";
  for (const Line& line : uart.lines)
    if (line.number == uart.sent) return view_.text_of(line.stack);
  return view_.text_of(view_.call_stack(uart.newest));
}

}  // namespace capsoc::run
