// Exceptions under the manual's names (ARM DDI 0403, B1.5).
#include <algorithm>

#include "cortex_m3/core.h"
#include "cortex_m3/timing.h"

namespace capsoc::cortex_m3 {
namespace {

constexpr uint64_t bit(unsigned number) {
  return uint64_t{1} << number;
}
constexpr unsigned nmi = 2, hard_fault = 3, mem_manage = 4, bus_fault = 5, usage_fault = 6,
                   debug_monitor = 12;
constexpr uint32_t ccr_nonbasethrdena = 1, ccr_stkalign = 1u << 9;
constexpr uint32_t shcsr_memfaultena = 1u << 16, shcsr_busfaultena = 1u << 17,
                   shcsr_usgfaultena = 1u << 18;
constexpr uint32_t hfsr_vecttbl = 2, hfsr_forced = 1u << 30;

}  // namespace

int Core::exception_priority(unsigned number) const {
  switch (number) {
    case 1:
      return -3;
    case nmi:
      return -2;
    case hard_fault:
      return -1;
    default:
      return state_.nvic.priority[number];
  }
}

/// The part of a priority that decides on preemption; fixed priorities have no subpriority.
int Core::group_priority(int priority) const {
  return priority < 0 ? priority : priority & ~((2 << state_.scb.prigroup) - 1) & 0xFF;
}

int Core::execution_priority(bool ignore_primask) const {
  int highest = 256;
  for (uint64_t left = state_.nvic.active; left != 0; left &= left - 1) {
    highest = std::min(
        highest, group_priority(exception_priority(static_cast<unsigned>(__builtin_ctzll(left)))));
  }
  int boosted = 256;
  if (state_.basepri != 0) boosted = group_priority(static_cast<int>(state_.basepri));
  if (state_.primask != 0 && !ignore_primask) boosted = 0;
  if (state_.faultmask != 0) boosted = -1;
  return std::min(highest, boosted);
}

bool Core::exception_enabled(unsigned number) const {
  switch (number) {
    case mem_manage:
      return (state_.scb.shcsr & shcsr_memfaultena) != 0;
    case bus_fault:
      return (state_.scb.shcsr & shcsr_busfaultena) != 0;
    case usage_fault:
      return (state_.scb.shcsr & shcsr_usgfaultena) != 0;
    default:
      return number < 16 || (state_.nvic.enabled & bit(number)) != 0;
  }
}

/// The pending exception of the highest priority, lowest number first, if it preempts `below`.
unsigned Core::highest_pending(int below) const {
  unsigned best = 0;
  int best_priority = 256;
  for (uint64_t left = state_.nvic.pending; left != 0; left &= left - 1) {
    unsigned number = static_cast<unsigned>(__builtin_ctzll(left));
    if (!exception_enabled(number)) continue;
    int priority = exception_priority(number);
    if (priority < best_priority) {
      best = number;
      best_priority = priority;
    }
  }
  return best != 0 && group_priority(best_priority) < below ? best : 0;
}

void Core::pend(unsigned number) {
  if ((state_.nvic.pending & bit(number)) == 0 && (state_.scb.scr & 0x10))
    state_.event_register = true;  // SEVONPEND
  state_.nvic.pending |= bit(number);
  check_ = true;
}

void Core::set_interrupt(unsigned line, bool level) {
  if (line >= interrupt_count) return;
  bool before = ((state_.nvic.lines >> line) & 1) != 0;
  state_.nvic.lines = level ? state_.nvic.lines | 1u << line : state_.nvic.lines & ~(1u << line);
  if (level && !before) pend(16 + line);
}

void Core::pulse_nmi() {
  pend(nmi);
}

unsigned Core::active_count() const {
  return static_cast<unsigned>(__builtin_popcountll(state_.nvic.active));
}

/// Status bits of a fault; returns the exception it raises.
unsigned Core::record_cause(Cause cause, uint32_t address) {
  auto with_mmfar = [&](uint32_t bits) {
    state_.scb.cfsr |= bits | 1u << 7;
    state_.scb.mmfar = address;
    return mem_manage;
  };
  auto plain = [&](uint32_t bits, unsigned number) {
    state_.scb.cfsr |= bits;
    return number;
  };
  switch (cause) {
    case Cause::undefined_instruction:
      return plain(1u << 16, usage_fault);
    case Cause::invalid_state:
      return plain(1u << 17, usage_fault);
    case Cause::invalid_pc:
      return plain(1u << 18, usage_fault);
    case Cause::no_coprocessor:
      return plain(1u << 19, usage_fault);
    case Cause::unaligned:
      return plain(1u << 24, usage_fault);
    case Cause::divide_by_zero:
      return plain(1u << 25, usage_fault);
    case Cause::fetch_bus:
      return plain(1u << 8, bus_fault);
    case Cause::fetch_access:
      return plain(1u << 0, mem_manage);
    case Cause::data_bus:
      state_.scb.bfar = address;
      return plain(1u << 9 | 1u << 15, bus_fault);
    case Cause::data_access:
      return with_mmfar(1u << 1);
    case Cause::stacking_bus:
      return plain(1u << 12, bus_fault);
    case Cause::stacking_access:
      return plain(1u << 4, mem_manage);
    case Cause::unstacking_bus:
      return plain(1u << 11, bus_fault);
    default:
      return plain(1u << 3, mem_manage);
  }
}

/// A fault that is disabled or cannot preempt becomes HardFault; 0 when even that cannot be taken.
unsigned Core::escalate(unsigned number, int priority) {
  if (exception_enabled(number) && group_priority(exception_priority(number)) < priority)
    return number;
  if (priority <= -1) return 0;
  state_.scb.hfsr |= hfsr_forced;
  return hard_fault;
}

/// Takes a synchronous exception: a fault or SVC.
void Core::raise(unsigned number, uint32_t return_address) {
  unsigned taken = escalate(number, execution_priority());
  if (taken == 0) {
    capture_fault(0, return_address);
    return lock_up();
  }
  exception_entry(taken, return_address);
}

void Core::capture_fault(unsigned number, uint32_t return_address) {
  FaultReport& f = state_.last_fault;
  using Kind = FaultReport::Kind;
  static constexpr Kind kinds[] = {Kind::hard_fault, Kind::mem_manage, Kind::bus_fault,
                                   Kind::usage_fault};
  f.kind = number == 0 ? Kind::lockup : kinds[number - hard_fault];
  f.exception = number == 0 ? state_.ipsr : number;
  f.cfsr = state_.scb.cfsr;
  f.hfsr = state_.scb.hfsr;
  f.mmfar = state_.scb.mmfar;
  f.bfar = state_.scb.bfar;
  f.frame = {state_.r[0],  state_.r[1],  state_.r[2],    state_.r[3],
             state_.r[12], state_.r[14], return_address, xpsr()};
  f.address = (state_.scb.cfsr & 1u << 15)  ? state_.scb.bfar
              : (state_.scb.cfsr & 1u << 7) ? state_.scb.mmfar
                                            : return_address;
  f.nesting = active_count();
  f.cycle = state_.cycles;
  ++state_.fault_count;
  constexpr uint64_t fault_exceptions = 0xF << hard_fault;
  if ((state_.nvic.active & fault_exceptions) == 0) state_.first_fault = f;
}

// B1.5.15: the core stays at the lockup address until reset, or an NMI where that may preempt.
void Core::lock_up() {
  if (state_.last_fault.kind != FaultReport::Kind::lockup) {
    capture_fault(0, state_.pc);
    --state_.fault_count;
  }
  state_.locked_up = true;
  state_.pc = 0xFFFFFFFE;
  check_ = true;
}

/// A store that had left the instruction behind failed (B1.5.14): BusFault, or HardFault where that
/// is disabled, waits until its priority is sufficient. No address is kept.
void Core::imprecise_bus_fault() {
  constexpr uint32_t cfsr_impreciserr = 1u << 10;
  state_.scb.cfsr |= cfsr_impreciserr;
  const bool enabled = exception_enabled(bus_fault);
  if (!enabled) state_.scb.hfsr |= hfsr_forced;
  state_.nvic.pending |= bit(enabled ? bus_fault : hard_fault);
  check_ = true;
}

bool Core::monitor_enabled() const {
  return (state_.scb.demcr & 1u << 16) != 0;
}

bool Core::monitor_can_preempt() const {
  return monitor_enabled() &&
         group_priority(exception_priority(debug_monitor)) < execution_priority();
}

/// An event of the DWT or a step (C1.6.1): ignored unless the DebugMonitor is enabled and of
/// sufficient priority.
void Core::debug_event(uint32_t dfsr_bit) {
  if (!monitor_can_preempt()) return;
  state_.scb.dfsr |= dfsr_bit;
  state_.nvic.pending |= bit(debug_monitor);
  check_ = true;
}

/// BKPT without a debugger that halts (C1.6.1): the DebugMonitor, else it escalates to HardFault.
void Core::breakpoint_instruction(uint32_t address) {
  constexpr uint32_t dfsr_bkpt = 2, hfsr_debugevt = 1u << 31;
  state_.scb.dfsr |= dfsr_bkpt;
  if (monitor_can_preempt()) return exception_entry(debug_monitor, address);
  state_.scb.hfsr |= hfsr_debugevt;
  if (execution_priority() <= -1) return lock_up();
  exception_entry(hard_fault, address);
}

/// Whether an exception that comes by itself, NMI aside, could preempt the present code.
bool Core::can_be_preempted() const {
  constexpr unsigned systick = 15, first_interrupt = 16;
  if (monitor_can_preempt()) return true;
  const int priority = execution_priority();
  for (unsigned number = systick; number < first_interrupt + interrupt_count; ++number) {
    const bool may_come =
        number == systick ? (state_.systick.csr & 3) == 3 : exception_enabled(number);
    if (may_come && group_priority(exception_priority(number)) < priority) return true;
  }
  return false;
}

void Core::spin_in_fault() {
  if (!hopeless_ || can_be_preempted() || !hopeless_()) return;
  stuck_ = check_ = true;
}

bool Core::push_stack(uint32_t return_address, Cause& cause) {
  uint32_t sp = state_.r[13];
  bool align = (state_.scb.ccr & ccr_stkalign) != 0 && (sp & 4) != 0;
  uint32_t frame = (sp - 0x20) & ~((state_.scb.ccr & ccr_stkalign) ? 4u : 0u);
  const uint32_t words[8] = {
      state_.r[0],  state_.r[1],  state_.r[2],    state_.r[3],
      state_.r[12], state_.r[14], return_address, xpsr() | (align ? 1u << 9 : 0)};
  bool priv = privileged();
  state_.r[13] = frame;
  for (unsigned i = 0; i < 8; ++i) {
    Result result = write_aligned(frame + 4 * i, 4, words[i], priv);
    if (result <= Result::device) continue;
    cause = result == Result::bus_error ? Cause::stacking_bus : Cause::stacking_access;
    return false;
  }
  return true;
}

void Core::exception_entry(unsigned number, uint32_t return_address) {
  if (number >= hard_fault && number <= usage_fault) capture_fault(number, return_address);
  const uint64_t since = state_.cycles;
  state_.cycles += timing::exception_entry;
  const uint32_t exc_return = state_.ipsr != 0 ? 0xFFFFFFF1u
                              : uses_psp()     ? 0xFFFFFFFDu
                                               : 0xFFFFFFF9u;
  const int before = execution_priority();
  Cause cause{};
  if (!push_stack(return_address, cause)) {
    // A derived exception: the better of the two is taken, the other one stays pending.
    unsigned derived = escalate(record_cause(cause, 0), before);
    if (derived == 0 && number != nmi) {
      capture_fault(0, return_address);
      return lock_up();
    }
    if (derived != 0) {
      if (exception_priority(derived) <= exception_priority(number)) {
        if (derived != number) state_.nvic.pending |= bit(number);
        capture_fault(derived, return_address);
        number = derived;
      } else {
        state_.nvic.pending |= bit(derived);
      }
    }
  }
  exception_taken(number, exc_return, Entry::preempts, since);
}

/// B1.5.12: an exception of higher priority that arrives before the first instruction of a handler
/// takes its place on the frame already stacked; the displaced one stays pending.
void Core::late_arrival(unsigned number) {
  const unsigned displaced = state_.ipsr;
  state_.nvic.active &= ~bit(displaced);
  state_.nvic.pending |= bit(displaced);
  const uint64_t since = state_.cycles;
  state_.cycles += timing::late_arrival;
  if (number >= hard_fault && number <= usage_fault) capture_fault(number, state_.pc);
  exception_taken(number, state_.r[14], Entry::displaces, since);
}

void Core::exception_taken(unsigned number, uint32_t exc_return, Entry how, uint64_t since) {
  uint32_t vector = 0;
  // The vector table is read past the MPU, by the default map.
  if (read_physical(state_.scb.vtor + 4 * number, 4, vector) > Result::device) {
    state_.scb.hfsr |= hfsr_vecttbl;
    bool hopeless = number <= hard_fault || execution_priority() <= -1;
    state_.nvic.pending |= hopeless ? 0 : bit(number);
    if (hopeless || read_physical(state_.scb.vtor + 4 * hard_fault, 4, vector) > Result::device) {
      capture_fault(0, state_.pc);
      return lock_up();
    }
    capture_fault(hard_fault, state_.pc);
    state_.nvic.pending &= ~bit(hard_fault);
    number = hard_fault;
  }
  select_stack(false);
  state_.control &= ~2u;
  state_.ipsr = number;
  state_.nvic.pending &= ~bit(number);
  state_.nvic.active |= bit(number);
  state_.r[14] = exc_return;
  state_.pc = vector & ~1u;
  state_.thumb = (vector & 1) != 0;
  state_.it_state = 0;
  state_.trail = timing::no_trail;
  state_.stalled = false;  // by the stacking
  state_.exclusive = false;
  state_.event_register = true;
  check_ = true;
  // Whether faults can be displaced is IMPLEMENTATION DEFINED; here they cannot.
  state_.entered_at = number >= hard_fault && number <= usage_fault ? never : state_.instructions;
  if (observer_ != nullptr) observer_->entered(*this, number, how, since);
}

void Core::deactivate(unsigned number) {
  state_.nvic.active &= ~bit(number);
  if (number != nmi) state_.faultmask = 0;
  // A level that is still high asks again.
  if (number >= 16 && ((state_.nvic.lines >> (number - 16)) & 1)) pend(number);
  check_ = true;
}

/// A fault of the return itself is taken in place of what was returned from, its frame unstacked.
void Core::return_fault(Cause cause, uint32_t exc_return) {
  unsigned number = escalate(record_cause(cause, 0), execution_priority());
  if (number == 0) {
    capture_fault(0, state_.pc);
    return lock_up();
  }
  capture_fault(number, state_.pc);
  const uint64_t since = state_.cycles;
  state_.cycles += timing::tail_chain;
  exception_taken(number, exc_return, Entry::tail_chains, since);
}

void Core::exception_return(uint32_t exc_return) {
  const unsigned returning = state_.ipsr;
  const bool was_active = (state_.nvic.active & bit(returning)) != 0;
  const unsigned nested = active_count();
  const bool base_ok = nested == 1 || (state_.scb.ccr & ccr_nonbasethrdena) != 0;
  bool legal = was_active && (exc_return | 0xF) == 0xFFFFFFFFu;
  if ((exc_return | 0xF) != 0xFFFFFFFFu) unpredictable(Unpredictable::exc_return, event_return_);
  switch (exc_return & 0xF) {
    case 0x1:
      legal = legal && nested != 1;
      break;
    case 0x9:
    case 0xD:
      legal = legal && base_ok;
      break;
    default:
      legal = false;
  }
  if (was_active) deactivate(returning);
  if (!legal) return return_fault(Cause::invalid_pc, 0xF0000000u | exc_return);
  if (unsigned next = highest_pending(execution_priority()); next != 0) {
    const uint64_t since = state_.cycles;
    state_.cycles += timing::tail_chain;
    if (next >= hard_fault && next <= usage_fault) capture_fault(next, state_.pc);
    return exception_taken(next, exc_return, Entry::tail_chains, since);
  }
  Cause cause{};
  state_.cycles += timing::exception_return;
  if (!pop_stack(exc_return, cause)) return return_fault(cause, exc_return);
  state_.stalled = false;
  state_.exclusive = false;
  state_.event_register = true;
  check_ = true;
  if (observer_ != nullptr) observer_->returned(*this, returning);
  if (state_.ipsr == 0 && (state_.scb.scr & 2)) sleep_until_wake(false);  // SLEEPONEXIT
}

bool Core::pop_stack(uint32_t exc_return, Cause& cause) {
  const bool psp = (exc_return & 0xF) == 0xD, to_thread = (exc_return & 0xF) != 1;
  const uint32_t frame = psp ? state_.other_sp : state_.r[13];
  const bool priv = !to_thread || (state_.control & 1) == 0;
  uint32_t words[8];
  for (unsigned i = 0; i < 8; ++i) {
    Result result = read_aligned(frame + 4 * i, 4, words[i], priv);
    if (result <= Result::device) continue;
    cause = result == Result::bus_error ? Cause::unstacking_bus : Cause::unstacking_access;
    return false;
  }
  const uint32_t psr = words[7];
  if (((psr & 0x1FF) == 0) != to_thread) {
    cause = Cause::invalid_pc;
    return false;
  }
  bool aligned = (psr & 1u << 9) != 0 && (state_.scb.ccr & ccr_stkalign) != 0;
  uint32_t sp = (frame + 0x20) | (aligned ? 4u : 0u);
  (psp ? state_.other_sp : state_.r[13]) = sp;
  state_.ipsr = psr & 0x1FF;
  // Handler mode had MSP in state_.r[13]; Thread mode takes what the return value names.
  state_.control = (state_.control & 1) | (psp ? 2u : 0u);
  if (psp) std::swap(state_.r[13], state_.other_sp);
  for (unsigned i = 0; i < 4; ++i) state_.r[i] = words[i];
  state_.r[12] = words[4];
  state_.r[14] = words[5];
  if ((words[6] & 1) != 0) unpredictable(Unpredictable::return_address, event_return_);
  state_.pc = words[6] & ~1u;
  set_xpsr(psr);
  return true;
}

}  // namespace capsoc::cortex_m3
