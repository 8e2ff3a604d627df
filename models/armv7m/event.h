#pragma once

#include <cstdint>

namespace capsoc::armv7m {

/// Why an instruction raises a fault: one bit of CFSR each (B3.2.15).
enum class Cause : uint8_t {
  undefined_instruction,
  invalid_state,
  invalid_pc,
  no_coprocessor,
  unaligned,
  divide_by_zero,
  fetch_bus,
  fetch_access,
  data_bus,
  data_access,
  stacking_bus,
  stacking_access,
  unstacking_bus,
  unstacking_access,
  lazy_bus,  ///< of saving floating-point state when it is due
  lazy_access
};

/// What an instruction raises for the exception model, which handles it before the next
/// instruction.
struct Event {
  enum class Kind : uint8_t {
    none,
    fault,
    svc,
    bkpt,
    exception_return,
    abandoned,  ///< the instruction has no effect: an exception that is pending comes first
    lockup
  };
  Kind kind = Kind::none;
  Cause cause{};                ///< of a fault
  uint32_t value = 0;           ///< address of a fault, number of a BKPT, EXC_RETURN
  uint32_t return_address = 0;  ///< of BKPT, and the instruction that returned
};

/// Reasons for the run loop to act between two instructions, in one word that costs one test.
class Requests {
 public:
  enum Reason : uint32_t {
    changed = 1 << 0,    ///< state that exceptions, sleep, memory or mode depend on
    attention = 1 << 1,  ///< a caller from outside wants run() to end
    stuck = 1 << 2,
    watchpoint = 1 << 3,
    breakpoint = 1 << 4,  ///< BKPT, for a debugger that halts
    unanswered = 1 << 5,  ///< a semihosting call was made, and its answer comes later
  };
  static constexpr uint32_t stops = attention | stuck | watchpoint | breakpoint | unanswered;

  void raise(Reason reason) { reasons_ |= reason | changed; }
  bool any() const { return reasons_ != 0; }
  bool has(uint32_t reasons) const { return (reasons_ & reasons) != 0; }
  /// A stop stays until it is taken.
  void looked_at() { reasons_ &= stops; }
  bool take(Reason reason) {
    const bool there = has(reason);
    reasons_ &= ~uint32_t{reason};
    return there;
  }
  void drop_stops() { reasons_ &= ~stops; }

 private:
  uint32_t reasons_ = 0;
};

}  // namespace capsoc::armv7m
