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
      return priority_.value[number];
  }
}

/// The part of a priority that decides on preemption; fixed priorities have no subpriority.
int Core::group_priority(int priority) const {
  return priority < 0 ? priority : priority & ~((2 << prigroup_) - 1) & 0xFF;
}

int Core::execution_priority(bool ignore_primask) const {
  int highest = 256;
  for (uint64_t left = active_; left != 0; left &= left - 1) {
    highest = std::min(
        highest, group_priority(exception_priority(static_cast<unsigned>(__builtin_ctzll(left)))));
  }
  int boosted = 256;
  if (basepri_ != 0) boosted = group_priority(static_cast<int>(basepri_));
  if (primask_ != 0 && !ignore_primask) boosted = 0;
  if (faultmask_ != 0) boosted = -1;
  return std::min(highest, boosted);
}

bool Core::exception_enabled(unsigned number) const {
  switch (number) {
    case mem_manage:
      return (shcsr_ & shcsr_memfaultena) != 0;
    case bus_fault:
      return (shcsr_ & shcsr_busfaultena) != 0;
    case usage_fault:
      return (shcsr_ & shcsr_usgfaultena) != 0;
    default:
      return number < 16 || (enabled_ & bit(number)) != 0;
  }
}

/// The pending exception of the highest priority, lowest number first, if it preempts `below`.
unsigned Core::highest_pending(int below) const {
  unsigned best = 0;
  int best_priority = 256;
  for (uint64_t left = pending_; left != 0; left &= left - 1) {
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
  if ((pending_ & bit(number)) == 0 && (scr_ & 0x10)) event_register_ = true;  // SEVONPEND
  pending_ |= bit(number);
  check_ = true;
}

void Core::set_interrupt(unsigned line, bool level) {
  if (line >= interrupt_count) return;
  bool before = ((lines_ >> line) & 1) != 0;
  lines_ = level ? lines_ | 1u << line : lines_ & ~(1u << line);
  if (level && !before) pend(16 + line);
}

void Core::pulse_nmi() {
  pend(nmi);
}

unsigned Core::active_count() const {
  return static_cast<unsigned>(__builtin_popcountll(active_));
}

/// Status bits of a fault; returns the exception it raises.
unsigned Core::record_cause(Cause cause, uint32_t address) {
  auto with_mmfar = [&](uint32_t bits) {
    cfsr_ |= bits | 1u << 7;
    mmfar_ = address;
    return mem_manage;
  };
  auto plain = [&](uint32_t bits, unsigned number) {
    cfsr_ |= bits;
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
      bfar_ = address;
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
  hfsr_ |= hfsr_forced;
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
  FaultReport& f = fault_report_;
  using Kind = FaultReport::Kind;
  static constexpr Kind kinds[] = {Kind::hard_fault, Kind::mem_manage, Kind::bus_fault,
                                   Kind::usage_fault};
  f.kind = number == 0 ? Kind::lockup : kinds[number - hard_fault];
  f.exception = number == 0 ? ipsr_ : number;
  f.cfsr = cfsr_;
  f.hfsr = hfsr_;
  f.mmfar = mmfar_;
  f.bfar = bfar_;
  f.frame = {r_[0], r_[1], r_[2], r_[3], r_[12], r_[14], return_address, xpsr()};
  f.address = (cfsr_ & 1u << 15) ? bfar_ : (cfsr_ & 1u << 7) ? mmfar_ : return_address;
  f.nesting = active_count();
  f.cycle = cycles_;
  ++fault_count_;
  constexpr uint64_t fault_exceptions = 0xF << hard_fault;
  if ((active_ & fault_exceptions) == 0) first_fault_ = f;
}

// B1.5.15: the core stays at the lockup address until reset, or an NMI where that may preempt.
void Core::lock_up() {
  if (fault_report_.kind != FaultReport::Kind::lockup) {
    capture_fault(0, pc_);
    --fault_count_;
  }
  locked_up_ = true;
  pc_ = 0xFFFFFFFE;
  check_ = true;
}

/// A store that had left the instruction behind failed (B1.5.14): BusFault, or HardFault where that
/// is disabled, waits until its priority is sufficient. No address is kept.
void Core::imprecise_bus_fault() {
  constexpr uint32_t cfsr_impreciserr = 1u << 10;
  cfsr_ |= cfsr_impreciserr;
  const bool enabled = exception_enabled(bus_fault);
  if (!enabled) hfsr_ |= hfsr_forced;
  pending_ |= bit(enabled ? bus_fault : hard_fault);
  check_ = true;
}

bool Core::monitor_enabled() const {
  return (demcr_ & 1u << 16) != 0;
}

bool Core::monitor_can_preempt() const {
  return monitor_enabled() &&
         group_priority(exception_priority(debug_monitor)) < execution_priority();
}

/// An event of the DWT or a step (C1.6.1): ignored unless the DebugMonitor is enabled and of
/// sufficient priority.
void Core::debug_event(uint32_t dfsr_bit) {
  if (!monitor_can_preempt()) return;
  dfsr_ |= dfsr_bit;
  pending_ |= bit(debug_monitor);
  check_ = true;
}

/// BKPT without a debugger that halts (C1.6.1): the DebugMonitor, else it escalates to HardFault.
void Core::breakpoint_instruction(uint32_t address) {
  constexpr uint32_t dfsr_bkpt = 2, hfsr_debugevt = 1u << 31;
  dfsr_ |= dfsr_bkpt;
  if (monitor_can_preempt()) return exception_entry(debug_monitor, address);
  hfsr_ |= hfsr_debugevt;
  if (execution_priority() <= -1) return lock_up();
  exception_entry(hard_fault, address);
}

/// Whether an exception that comes by itself, NMI aside, could preempt the present code.
bool Core::can_be_preempted() const {
  constexpr unsigned systick = 15, first_interrupt = 16;
  if (monitor_can_preempt()) return true;
  const int priority = execution_priority();
  for (unsigned number = systick; number < first_interrupt + interrupt_count; ++number) {
    const bool may_come = number == systick ? (systick_csr_ & 3) == 3 : exception_enabled(number);
    if (may_come && group_priority(exception_priority(number)) < priority) return true;
  }
  return false;
}

void Core::spin_in_fault() {
  if (!hopeless_ || can_be_preempted() || !hopeless_()) return;
  stuck_ = check_ = true;
}

bool Core::push_stack(uint32_t return_address, Cause& cause) {
  uint32_t sp = r_[13];
  bool align = (ccr_ & ccr_stkalign) != 0 && (sp & 4) != 0;
  uint32_t frame = (sp - 0x20) & ~((ccr_ & ccr_stkalign) ? 4u : 0u);
  const uint32_t words[8] = {r_[0],  r_[1],  r_[2],          r_[3],
                             r_[12], r_[14], return_address, xpsr() | (align ? 1u << 9 : 0)};
  bool priv = privileged();
  r_[13] = frame;
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
  const uint64_t since = cycles_;
  cycles_ += timing::exception_entry;
  const uint32_t exc_return = ipsr_ != 0 ? 0xFFFFFFF1u : uses_psp() ? 0xFFFFFFFDu : 0xFFFFFFF9u;
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
        if (derived != number) pending_ |= bit(number);
        capture_fault(derived, return_address);
        number = derived;
      } else {
        pending_ |= bit(derived);
      }
    }
  }
  exception_taken(number, exc_return, Entry::preempts, since);
}

/// B1.5.12: an exception of higher priority that arrives before the first instruction of a handler
/// takes its place on the frame already stacked; the displaced one stays pending.
void Core::late_arrival(unsigned number) {
  const unsigned displaced = ipsr_;
  active_ &= ~bit(displaced);
  pending_ |= bit(displaced);
  const uint64_t since = cycles_;
  cycles_ += timing::late_arrival;
  if (number >= hard_fault && number <= usage_fault) capture_fault(number, pc_);
  exception_taken(number, r_[14], Entry::displaces, since);
}

void Core::exception_taken(unsigned number, uint32_t exc_return, Entry how, uint64_t since) {
  uint32_t vector = 0;
  // The vector table is read past the MPU, by the default map.
  if (read_physical(vtor_ + 4 * number, 4, vector) > Result::device) {
    hfsr_ |= hfsr_vecttbl;
    bool hopeless = number <= hard_fault || execution_priority() <= -1;
    pending_ |= hopeless ? 0 : bit(number);
    if (hopeless || read_physical(vtor_ + 4 * hard_fault, 4, vector) > Result::device) {
      capture_fault(0, pc_);
      return lock_up();
    }
    capture_fault(hard_fault, pc_);
    pending_ &= ~bit(hard_fault);
    number = hard_fault;
  }
  select_stack(false);
  control_ &= ~2u;
  ipsr_ = number;
  pending_ &= ~bit(number);
  active_ |= bit(number);
  r_[14] = exc_return;
  pc_ = vector & ~1u;
  thumb_ = (vector & 1) != 0;
  it_state_ = 0;
  trail_ = timing::no_trail;
  stalled_ = false;  // by the stacking
  exclusive_ = false;
  event_register_ = true;
  check_ = true;
  // Whether faults can be displaced is IMPLEMENTATION DEFINED; here they cannot.
  entered_at_ = number >= hard_fault && number <= usage_fault ? never : instructions_;
  if (observer_ != nullptr) observer_->entered(*this, number, how, since);
}

void Core::deactivate(unsigned number) {
  active_ &= ~bit(number);
  if (number != nmi) faultmask_ = 0;
  // A level that is still high asks again.
  if (number >= 16 && ((lines_ >> (number - 16)) & 1)) pend(number);
  check_ = true;
}

/// A fault of the return itself is taken in place of what was returned from, its frame unstacked.
void Core::return_fault(Cause cause, uint32_t exc_return) {
  unsigned number = escalate(record_cause(cause, 0), execution_priority());
  if (number == 0) {
    capture_fault(0, pc_);
    return lock_up();
  }
  capture_fault(number, pc_);
  const uint64_t since = cycles_;
  cycles_ += timing::tail_chain;
  exception_taken(number, exc_return, Entry::tail_chains, since);
}

void Core::exception_return(uint32_t exc_return) {
  const unsigned returning = ipsr_;
  const bool was_active = (active_ & bit(returning)) != 0;
  const unsigned nested = active_count();
  const bool base_ok = nested == 1 || (ccr_ & ccr_nonbasethrdena) != 0;
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
    const uint64_t since = cycles_;
    cycles_ += timing::tail_chain;
    if (next >= hard_fault && next <= usage_fault) capture_fault(next, pc_);
    return exception_taken(next, exc_return, Entry::tail_chains, since);
  }
  Cause cause{};
  cycles_ += timing::exception_return;
  if (!pop_stack(exc_return, cause)) return return_fault(cause, exc_return);
  stalled_ = false;
  exclusive_ = false;
  event_register_ = true;
  check_ = true;
  if (observer_ != nullptr) observer_->returned(*this, returning);
  if (ipsr_ == 0 && (scr_ & 2)) sleep_until_wake(false);  // SLEEPONEXIT
}

bool Core::pop_stack(uint32_t exc_return, Cause& cause) {
  const bool psp = (exc_return & 0xF) == 0xD, to_thread = (exc_return & 0xF) != 1;
  const uint32_t frame = psp ? other_sp_ : r_[13];
  const bool priv = !to_thread || (control_ & 1) == 0;
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
  bool aligned = (psr & 1u << 9) != 0 && (ccr_ & ccr_stkalign) != 0;
  uint32_t sp = (frame + 0x20) | (aligned ? 4u : 0u);
  (psp ? other_sp_ : r_[13]) = sp;
  ipsr_ = psr & 0x1FF;
  // Handler mode had MSP in r_[13]; Thread mode takes what the return value names.
  control_ = (control_ & 1) | (psp ? 2u : 0u);
  if (psp) std::swap(r_[13], other_sp_);
  for (unsigned i = 0; i < 4; ++i) r_[i] = words[i];
  r_[12] = words[4];
  r_[14] = words[5];
  if ((words[6] & 1) != 0) unpredictable(Unpredictable::return_address, event_return_);
  pc_ = words[6] & ~1u;
  set_xpsr(psr);
  return true;
}

}  // namespace capsoc::cortex_m3
