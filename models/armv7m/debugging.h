#pragma once

#include <cstdint>
#include <set>

#include "armv7m/core_context.h"
#include "armv7m/memory/memory_access.h"
#include "armv7m/system/system_space.h"
#include "armv7m/watchpoints.h"

namespace capsoc::armv7m {

/// Breakpoints and watchpoints of a debugger. Not on the execution path while neither a debugger
/// nor the program (in the DWT) has set one.
class Debugging {
 public:
  /// Nothing is owned.
  Debugging(CoreContext& context, Watchpoints& watchpoints, MemoryAccess& memory,
            SystemSpace& system)
      : context_(context), watchpoints_(watchpoints), memory_(memory), system_(system) {}

  /// Sets whether a debugger is attached, and whether it halts the processor.
  void set_halting(bool enabled) { context_.halting.set_enabled(enabled); }
  bool halting() const { return context_.halting.enabled(); }
  void set_halted(bool halted) { context_.halting.set_halted(halted); }

  /// Ends run() before the instruction at the address; the next run() executes it.
  void set_breakpoint(uint32_t address);
  void clear_breakpoint(uint32_t address) { breakpoints_.erase(address & ~1u); }
  bool has_breakpoint(uint32_t address) const { return breakpoints_.count(address & ~1u) != 0; }
  bool has_breakpoints() const { return !breakpoints_.empty(); }
  /// The next run() executes the instruction at PC whether it has a breakpoint or not.
  void pass_breakpoint();
  /// True once for every arrival at a breakpoint.
  bool at_breakpoint();

  /// As the printf viewer of a debugger does (C1.7): DEMCR.TRCENA, ITM_TCR.ITMENA and the bits of
  /// ITM_TER that `ports` names (bit n is port n) are set, now and after each reset. Off: these
  /// bits of ITM_TER are cleared, and trace stays on.
  void show_stimulus(uint32_t ports, bool on);
  uint32_t stimulus_ports() const { return stimulus_ports_; }
  /// After a reset, or a restored state that another debugger left.
  void set_up_trace();

  /// Ends run() after the instruction that made such an access.
  void set_watchpoint(const Watchpoint& watchpoint);
  void clear_watchpoint(const Watchpoint& watchpoint);
  const WatchHit& watch_hit() const { return watchpoints_.hit(); }

  /// After a reset or a restore: no arrival is remembered.
  void forget_arrival();

 private:
  CoreContext& context_;
  Watchpoints& watchpoints_;
  MemoryAccess& memory_;
  SystemSpace& system_;
  std::set<uint32_t> breakpoints_;
  uint64_t passed_at_ = ~uint64_t{0};  // instructions when the one at passed_pc_ was passed
  uint32_t passed_pc_ = 0;
  bool traces_ = false;
  uint32_t stimulus_ports_ = 0;
};

}  // namespace capsoc::armv7m
