#pragma once

#include <cstdint>

#include "armv7m/core.h"

namespace capsoc::armv7m {

/// A debugger of the processor. All calls come from the processor's SystemC process, between two
/// instructions, with the core and the kernel at the same instant. They may block the host:
/// simulated time does not advance meanwhile.
class Debugger {
 public:
  virtual ~Debugger() = default;

  /// Called before the core continues. True: it executes only one instruction.
  virtual bool before_run() = 0;
  /// After a run that ended with `reason`; `advanced`: something was executed. True: the
  /// simulation continues though the reason would end it.
  virtual bool after_run(StopReason reason, bool advanced) = 0;
  /// Nothing is left that could wake the processor. False: let the simulation end.
  virtual bool asleep_for_good() = 0;
  /// True: before_run() should be called soon. Called during a sleep, each simulated millisecond if
  /// looks_at_sleep().
  virtual bool wants_attention() const = 0;
  virtual bool looks_at_sleep() const { return true; }
  /// True: neither before_run() nor a run that ends in StopReason::budget or attention matters to
  /// it now. Then accesses to devices take no longer than without a debugger: runs that leave the
  /// core ahead of the kernel follow each other, and before_run() is not called between them. Asked
  /// between two runs, and at each access.
  virtual bool sees_stops_alone() const { return false; }
  /// The most cycles that may pass in one run of the core.
  virtual uint64_t longest_run() const { return ~uint64_t{0}; }
  /// The debugger asked for the end of the simulation.
  virtual bool ended() const = 0;
};

}  // namespace capsoc::armv7m
