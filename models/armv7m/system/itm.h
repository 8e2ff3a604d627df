#pragma once

#include <cstdint>

#include "armv7m/system/registers.h"

namespace capsoc {
class Archive;
}

namespace capsoc::armv7m {

/// The stimulus ports of the instrumentation trace macrocell (C1.7). A program's writes go to the
/// listener at once, so a port is always ready. `tracing` is DEMCR.TRCENA.
class Itm {
 public:
  static constexpr unsigned ports = 32;

  void reset() { *this = {}; }
  void visit(Archive& archive);

  /// Each bit of TPR opens eight ports to unprivileged code; other registers are always closed to
  /// it.
  bool open_to_user(uint32_t address) const;
  /// The port of an address; ports() or more: another register.
  static unsigned port_of(uint32_t address) { return (address - ppb::ITM_STIM) / 4; }
  bool port_enabled(unsigned port, bool tracing) const;

  /// A debugger's access: ITMENA, and the bits of ITM_TER that `which` has, are set. Neither the
  /// lock nor another register changes.
  void enable(uint32_t which);
  void disable(uint32_t which) { ter_ &= ~which; }

  uint32_t read(uint32_t address, bool tracing) const;
  /// A register that is no port. `value` holds what was written, from bit 0.
  void write(uint32_t address, unsigned size, uint32_t value);

 private:
  uint32_t ter_ = 0, tpr_ = 0, tcr_ = 0;
  bool unlocked_ = false;
};

}  // namespace capsoc::armv7m
