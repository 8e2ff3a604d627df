#pragma once

#include <cstdint>

#include "armv7m/isa/op.h"

namespace capsoc::armv7m {

/// Outcome of an access to memory or a device, from best to worst.
enum class BusResult : uint8_t { ok, device, bus_error, violation };

/// The private peripheral bus as MemoryAccess uses it. Addresses are aligned to the size of 1, 2 or
/// 4 bytes.
class PrivateBus {
 public:
  virtual BusResult read(uint32_t address, unsigned size, uint32_t& value, bool privileged) = 0;
  virtual BusResult write(uint32_t address, unsigned size, uint32_t value, bool privileged) = 0;
  /// The word at an address, without side effects.
  virtual uint32_t peek(uint32_t address) const = 0;

  // What is reported once, of an instruction's accesses.
  /// A size that the register does not take.
  virtual void check_access(const DecodedOp& op, uint32_t address, unsigned size) = 0;
  /// UNPREDICTABLE settings, and priority bits that are not implemented.
  virtual void check_write(const DecodedOp& op, uint32_t address, unsigned size, uint32_t value,
                           bool done) = 0;

 protected:
  ~PrivateBus() = default;
};

}  // namespace capsoc::armv7m
