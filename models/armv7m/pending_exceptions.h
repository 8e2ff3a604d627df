#pragma once

#include <cstdint>

#include "armv7m/core_context.h"

namespace capsoc::armv7m {

/// Pends exceptions and decides which may be taken (ARM DDI 0403, B1.5.4), by priorities and masks.
/// Exceptions enters them.
class PendingExceptions {
 public:
  /// `context` is not owned.
  explicit PendingExceptions(CoreContext& context) : context_(context) {}

  /// Lower is more urgent; 256 when nothing is active or masked.
  int execution_priority(bool ignore_primask = false) const;
  int group_priority(unsigned number) const;
  bool enabled(unsigned number) const;
  /// The pending exception of the highest priority, lowest number first, if it preempts `below`;
  /// else 0.
  unsigned highest_pending(int below) const;
  /// WFI wakes on an exception that would preempt were PRIMASK clear; WFE also on an event
  /// (B1.5.17).
  bool wake_pending() const;
  /// Whether an asynchronous exception other than NMI could preempt the present code.
  bool can_be_preempted() const;

  void pend(unsigned number);
  /// A buffered store failed after its instruction had retired (B1.5.14). BusFault, or HardFault
  /// where that is disabled, is pending until its priority is sufficient. No register keeps the
  /// write.
  void imprecise_bus_fault(const LostWrite& write);
  /// An event of the DWT or a step (C1.6.1): ignored unless the DebugMonitor is enabled and of
  /// sufficient priority.
  void debug_event(Scb::DebugReason reason);
  bool monitor_can_preempt() const;

 private:
  CoreContext& context_;
};

}  // namespace capsoc::armv7m
