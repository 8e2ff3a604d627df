#pragma once

#include <cstdint>
#include <optional>

#include "armv7m/core_context.h"
#include "armv7m/memory/memory_access.h"
#include "armv7m/pending_exceptions.h"

namespace capsoc::armv7m {

/// Who may use the floating-point registers, and when they are saved (ARM DDI 0403, B1.5.7).
class FloatingPoint {
 public:
  /// Nothing is owned.
  FloatingPoint(CoreContext& context, PendingExceptions& pending, MemoryAccess& memory)
      : context_(context), pending_(pending), memory_(memory) {}

  /// ExecuteFPCheck, in front of each instruction of the extension. Its access is allowed, a save
  /// that is due is made, and a context begins where there is none. fault: the instruction has no
  /// effect.
  Access begin(const Step& op) {
    return __builtin_expect(is_open(), 1) ? Access::ok : begin_slowly(op);
  }
  /// True where begin() has nothing to do. Instructions of the extension leave it so.
  bool is_open() const {
    const State& state = context_.state;
    return state.fpu.enabled(state.privileged()) && !state.fpu.save_is_due() &&
           (state.has_fp_context() || !state.fpu.counts_contexts());
  }

  // Of exceptions, with the address of S0 in a frame.
  /// On entry, where CONTROL.FPCA is set: stacks the registers, or leaves that to the next
  /// instruction that uses them. `stacked`: the rest of the frame is. Empty: no fault.
  std::optional<Cause> push(uint32_t address, bool stacked);
  /// On return from a frame that has them.
  std::optional<Cause> pop(uint32_t address, bool privileged);

 private:
  Access begin_slowly(const Step& op);
  Access preserve(const Step& op);
  uint32_t ready() const;
  bool pend(Cause cause);

  CoreContext& context_;
  PendingExceptions& pending_;
  MemoryAccess& memory_;
};

}  // namespace capsoc::armv7m
