#pragma once

#include <cstdint>

namespace capsoc::armv7m {

/// Whether a debugger is attached and halts the processor (C1.6).
class HaltingDebug {
 public:
  /// Enables halting debug: BKPT ends run() with `breakpoint` before it executes, instead of
  /// raising a fault.
  void set_enabled(bool enabled) { enabled_ = enabled; }
  bool enabled() const { return enabled_; }
  /// Whether the debugger halts the processor; visible only in DHCSR.
  void set_halted(bool halted) { halted_ = halted; }
  /// DHCSR (C1.6.2): C_DEBUGEN while a debugger is attached, C_HALT, S_HALT and S_REGRDY while it
  /// halts the processor.
  uint32_t control_and_status() const {
    constexpr uint32_t c_debugen = 1, c_halt = 1u << 1, s_regrdy = 1u << 16, s_halt = 1u << 17;
    if (!enabled_) return 0;
    return halted_ ? c_debugen | c_halt | s_regrdy | s_halt : c_debugen;
  }

 private:
  bool enabled_ = false, halted_ = false;
};

}  // namespace capsoc::armv7m
