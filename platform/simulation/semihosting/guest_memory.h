// The guest's memory as semihosting sees it.
#pragma once

#include <cstdint>

namespace capsoc::semihosting {

/// Memory and nothing else: no device is read or written through it, whatever the guest's pointers
/// say.
class GuestMemory {
 public:
  virtual ~GuestMemory() = default;
  /// All of it, or false.
  virtual bool read(uint32_t address, void* data, uint32_t size) = 0;
  /// All of it, or false and nothing is written.
  virtual bool write(uint32_t address, const void* data, uint32_t size) = 0;
};

}  // namespace capsoc::semihosting
