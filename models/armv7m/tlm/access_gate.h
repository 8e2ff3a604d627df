#pragma once

#include <cstdint>

namespace capsoc::armv7m {

/// Between the processor and its bus: changes, loses or fails accesses on their way. It is not
/// asked about mapped memory and the private peripheral bus. With a gate each access waits for the
/// kernel, and no polling loop is skipped.
class AccessGate {
 public:
  struct Access {
    uint32_t address = 0;
    unsigned size = 0;  ///< 1, 2 or 4 bytes
    bool is_store = false;
  };
  enum class Fate : uint8_t {
    arrives,
    lost,   ///< of a store: its target never sees it; the response is OKAY
    fails,  ///< its target never sees it; the response is ERROR
  };

  /// Before an access, at its time. May change what a store writes.
  virtual Fate sent(const Access& access, uint32_t& value) = 0;
  /// After a load. May change what it read.
  virtual void returned(const Access& access, uint32_t& value) = 0;

 protected:
  AccessGate() = default;
  AccessGate(const AccessGate&) = default;
  AccessGate& operator=(const AccessGate&) = default;
  ~AccessGate() = default;
};

}  // namespace capsoc::armv7m
