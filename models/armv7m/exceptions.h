#pragma once

#include <cstdint>

#include "armv7m/core_context.h"
#include "armv7m/floating_point.h"
#include "armv7m/memory/memory_access.h"
#include "armv7m/pending_exceptions.h"

namespace capsoc::armv7m {

/// The exception model, with the manual's names (ARM DDI 0403, B1.5): exception entry and return,
/// faults, and lockup. PendingExceptions selects the exception.
class Exceptions {
 public:
  /// Nothing is owned.
  Exceptions(CoreContext& context, PendingExceptions& pending, MemoryAccess& memory,
             FloatingPoint& floating_point)
      : context_(context), pending_(pending), memory_(memory), floating_point_(floating_point) {}

  /// Takes a synchronous exception: a fault or SVC.
  void raise(unsigned number, uint32_t return_address);
  /// Stacks the frame and enters the handler.
  void enter(unsigned number, uint32_t return_address);
  /// B1.5.12: an exception of higher priority that arrives before the first instruction of a
  /// handler takes its place on the frame already stacked; the displaced one stays pending.
  void late_arrival(unsigned number);
  /// A branch to EXC_RETURN by the instruction at an address.
  void leave(uint32_t exc_return, uint32_t instruction);
  /// B1.5.15: the core stays at the lockup address until reset, or an NMI where that may preempt.
  void lock_up();
  /// BKPT without a debugger that halts (C1.6.1): the DebugMonitor, else it escalates to HardFault.
  void breakpoint_instruction(uint32_t address);

 private:
  /// A fault that is disabled or cannot preempt becomes HardFault; 0 when even that cannot be
  /// taken.
  unsigned escalate(unsigned number, int priority);
  void capture_fault(unsigned number, uint32_t return_address) {
    capture_fault(number, return_address, interrupted(return_address));
  }
  void capture_fault(unsigned number, uint32_t return_address,
                     const InterruptedRegisters& registers);
  InterruptedRegisters interrupted(uint32_t return_address) const;
  uint32_t ones_of_exc_return() const;
  bool push_stack(uint32_t return_address, Cause& cause);
  bool push_basic_frame(uint32_t frame, uint32_t return_address, bool moved, Cause& cause);
  bool pop_stack(uint32_t exc_return, uint32_t instruction, Cause& cause);
  void take(unsigned number, uint32_t exc_return, Entry how, uint64_t since);
  void deactivate(unsigned number);
  /// A fault of the return itself is taken in place of what was returned from, its frame unstacked.
  void return_fault(Cause cause, uint32_t exc_return);

  CoreContext& context_;
  PendingExceptions& pending_;
  MemoryAccess& memory_;
  FloatingPoint& floating_point_;
};

}  // namespace capsoc::armv7m
