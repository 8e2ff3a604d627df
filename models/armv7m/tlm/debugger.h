#pragma once

#include <cstdint>

#include "armv7m/core.h"

namespace capsoc::armv7m {

/// Who watches the processor. All calls come from the processor's own SystemC process, between two
/// instructions, with the core and the kernel at the same instant. They may keep the host as long
/// as they like: simulated time stands still meanwhile.
class Debugger {
 public:
  virtual ~Debugger() = default;

  /// Before the core continues. True: it is to execute one instruction.
  virtual bool before_run() = 0;
  /// After a run that ended with `reason`; `advanced`: something was executed. True: the
  /// simulation continues though the reason would end it.
  virtual bool after_run(StopReason reason, bool advanced) = 0;
  /// Nothing is left that could wake the processor. False: let the simulation end.
  virtual bool asleep_for_good() = 0;
  /// True: before_run() is wanted soon. Asked during a sleep, each millisecond of it if
  /// looks_at_sleep().
  virtual bool wants_attention() const = 0;
  virtual bool looks_at_sleep() const { return true; }
  /// The most cycles that may pass in one run of the core.
  virtual uint64_t longest_run() const { return ~uint64_t{0}; }
  /// The debugger asked for the end of the simulation.
  virtual bool ended() const = 0;
};

}  // namespace capsoc::armv7m
