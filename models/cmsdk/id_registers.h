// The twelve identification registers at the end of every CMSDK peripheral.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "kit/register_bank.h"

namespace capsoc::cmsdk {

/// PID0 of the peripherals (DDI 0479).
enum class PartNumber : uint8_t {
  gpio = 0x20,
  uart = 0x21,
  timer = 0x22,
  dual_timer = 0x23,
  watchdog = 0x24
};

/// PID4 to PID7 at 0xFD0, PID0 to PID3 at 0xFE0, CID0 to CID3 at 0xFF0, eight bits each, read-only
/// (CMSDK technical reference manual, DDI 0479). Only PID0, the part number, differs.
class IdRegisters {
 public:
  IdRegisters(kit::RegisterBank& bank, PartNumber part);

 private:
  std::vector<std::unique_ptr<kit::Register>> registers_;
};

/// The description of a register whose access is nothing special.
registers::RegisterDescription describe_register(const char* name, uint32_t offset,
                                                 registers::Access access, uint32_t bits);

}  // namespace capsoc::cmsdk
