// Semihosting calls of the guest (BKPT 0xAB): the end of the run with a status, and text for the
// log.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "cortex_m3/core.h"

namespace capsoc::run {

/// Answers SYS_EXIT, SYS_EXIT_EXTENDED, SYS_WRITEC and SYS_WRITE0; every other call returns -1 in
/// r0. Source: Arm semihosting for AArch32 and AArch64, operation numbers and parameter blocks.
class Semihosting {
 public:
  /// Returns false when the guest ended the run.
  bool call(cortex_m3::Core& core);

  /// The status that the guest ended with.
  int exit_status() const { return exit_status_; }

 private:
  void write0(cortex_m3::Core& core, uint32_t address);
  void put(char character);

  int exit_status_ = 0;
  std::string line_;
};

}  // namespace capsoc::run
