// The bus trace: one line for each access.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <tlm>
#include <vector>

#include "armv7m/core.h"
#include "soc/board_registers.h"
#include "trace/bus_targets.h"
#include "trace/line_file.h"

namespace capsoc::trace {

/// One access on a bus, of up to four bytes.
struct BusAccess {
  uint64_t cycle = 0;          ///< HCLK cycle in which it begins
  double seconds = 0;          ///< simulated time of that
  uint64_t cycles = 1;         ///< how long it takes, with its wait states
  const char* initiator = "";  ///< i-code, d-code, system, ppb, debugger
  uint32_t address = 0, data = 0;
  unsigned size = 0;
  bool write = false;
  const char* status = "ok";  ///< the response
};

/// The response in words.
const char* status_name(tlm::tlm_response_status status);
/// The processor's port for a data access (Cortex-M3 TRM, bus interfaces).
const char* data_port(uint32_t address);
/// The first bytes of a payload as a little-endian word.
uint32_t data_word(const tlm::tlm_generic_payload& payload);

class BusTrace {
 public:
  /// `registers`: of the board, by their names.
  BusTrace(std::unique_ptr<LineFile> file, const std::vector<soc::BoardPeripheral>& registers);
  void put(const BusAccess& access);
  std::optional<Error> finish() { return file_->finish(); }

 private:
  std::unique_ptr<LineFile> file_;
  BusTargets targets_;
};

}  // namespace capsoc::trace
