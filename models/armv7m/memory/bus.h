#pragma once

#include <cstdint>

namespace capsoc::armv7m {

enum class AccessKind : uint8_t { fetch, load, store };

/// The slow path of the core, for addresses without a direct mapping. Addresses are aligned to the
/// size of 1, 2 or 4 bytes; false is a bus error; `wait_cycles` are the cycles beyond the first.
class Bus {
 public:
  virtual ~Bus() = default;
  virtual bool read(uint32_t address, unsigned size, uint32_t& value, unsigned& wait_cycles,
                    AccessKind kind) = 0;
  virtual bool write(uint32_t address, unsigned size, uint32_t value, unsigned& wait_cycles) = 0;
  /// The same, of a load or a store that succeeds at once: no other component runs. False, and
  /// nothing is done: it has to be made by read() or write().
  virtual bool read_at_once(uint32_t /*address*/, unsigned /*size*/, uint32_t& /*value*/,
                            unsigned& /*wait_cycles*/) {
    return false;
  }
  virtual bool write_at_once(uint32_t /*address*/, unsigned /*size*/, uint32_t /*value*/,
                             unsigned& /*wait_cycles*/) {
    return false;
  }
};

}  // namespace capsoc::armv7m
