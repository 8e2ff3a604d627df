#pragma once

#include <cstdint>

#include "cortex_m3/event.h"
#include "cortex_m3/fault_report.h"
#include "cortex_m3/observer.h"
#include "cortex_m3/system/scb.h"

namespace capsoc::cortex_m3 {

class Machine;

/// The exception model, under the manual's names (ARM DDI 0403, B1.5): which exception is taken,
/// how it is entered and left, faults, and lockup.
class Exceptions {
 public:
  explicit Exceptions(Machine& machine) : machine_(machine) {}

  /// Lower is more urgent; 256 when nothing is active or masked.
  int execution_priority(bool ignore_primask = false) const;
  /// The pending exception of the highest priority, lowest number first, if it preempts `below`;
  /// else 0.
  unsigned highest_pending(int below) const;
  bool enabled(unsigned number) const;
  /// WFI wakes on an exception that would preempt were PRIMASK clear; WFE besides on an event
  /// (B1.5.17).
  bool wake_pending() const;
  /// Whether an exception that comes by itself, NMI aside, could preempt the present code.
  bool can_be_preempted() const;

  void pend(unsigned number);
  /// Takes a synchronous exception: a fault or SVC.
  void raise(unsigned number, uint32_t return_address);
  /// The frame is stacked and the handler entered.
  void enter(unsigned number, uint32_t return_address);
  /// B1.5.12: an exception of higher priority that arrives before the first instruction of a
  /// handler takes its place on the frame already stacked; the displaced one stays pending.
  void late_arrival(unsigned number);
  /// A branch to EXC_RETURN by the instruction at an address.
  void leave(uint32_t exc_return, uint32_t instruction);
  /// B1.5.15: the core stays at the lockup address until reset, or an NMI where that may preempt.
  void lock_up();
  /// A store that had left the instruction behind failed (B1.5.14): BusFault, or HardFault where
  /// that is disabled, waits until its priority is sufficient. No register keeps the write.
  void imprecise_bus_fault(const LostWrite& write);

  /// An event of the DWT or a step (C1.6.1): ignored unless the DebugMonitor is enabled and of
  /// sufficient priority.
  void debug_event(Scb::DebugReason reason);
  bool monitor_can_preempt() const;
  /// BKPT without a debugger that halts (C1.6.1): the DebugMonitor, else it escalates to HardFault.
  void breakpoint_instruction(uint32_t address);

 private:
  int group_priority(unsigned number) const;
  /// A fault that is disabled or cannot preempt becomes HardFault; 0 when even that cannot be
  /// taken.
  unsigned escalate(unsigned number, int priority);
  void capture_fault(unsigned number, uint32_t return_address) {
    capture_fault(number, return_address, interrupted(return_address));
  }
  void capture_fault(unsigned number, uint32_t return_address,
                     const InterruptedRegisters& registers);
  InterruptedRegisters interrupted(uint32_t return_address) const;
  bool push_stack(uint32_t return_address, Cause& cause);
  bool pop_stack(uint32_t exc_return, uint32_t instruction, Cause& cause);
  void take(unsigned number, uint32_t exc_return, Entry how, uint64_t since);
  void deactivate(unsigned number);
  /// A fault of the return itself is taken in place of what was returned from, its frame unstacked.
  void return_fault(Cause cause, uint32_t exc_return);

  Machine& machine_;
};

}  // namespace capsoc::cortex_m3
