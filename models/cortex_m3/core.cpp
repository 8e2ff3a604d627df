#include "cortex_m3/core.h"

#include <algorithm>
#include <utility>

#include "cortex_m3/decoder.h"
#include "cortex_m3/execute.h"

namespace capsoc::cortex_m3 {

/// Tells the listener about each case once. Inside a block pc_ is behind what is executed, so it is
/// the instruction's address for that long.
void Core::unpredictable(Unpredictable which, uint32_t address) {
  static_assert(static_cast<unsigned>(Unpredictable::count) <= 64);
  const uint64_t bit = uint64_t{1} << static_cast<unsigned>(which);
  if ((unpredictable_seen_ & bit) != 0) return;
  unpredictable_seen_ |= bit;
  if (!unpredictable_listener_) return;
  const uint32_t pc = std::exchange(pc_, address);
  unpredictable_listener_(which, address);
  pc_ = pc;
}

Core::Core(Bus& bus) : bus_(bus) {
  reset_system_control();
}

void Core::reset() {
  reset_system_control();
  r_.fill(0);
  n_ = 0;
  z_ = 1;
  c_ = v_ = q_ = false;
  control_ = primask_ = faultmask_ = basepri_ = ipsr_ = other_sp_ = 0;
  it_state_ = 0;
  trail_ = timing::no_trail;
  entered_at_ = never;
  sleeping_ = locked_up_ = attention_ = reset_request_ = semihosting_exit_ = false;
  event_register_ = exclusive_ = false;
  watch_stop_ = bkpt_stop_ = stuck_ = false;
  breakpoint_passed_ = never;
  event_ = Event::none;
  fault_report_ = {};
  first_fault_ = {};
  memory_.invalidate_all();
  uint32_t sp = 0, pc = 0;
  vtor_ = vector_table_;
  bool good = read_physical(vtor_, 4, sp) <= Result::device &&
              read_physical(vtor_ + 4, 4, pc) <= Result::device;
  stalled_ = false;  // by these reads
  r_[13] = sp & ~3u;
  r_[14] = 0xFFFFFFFF;
  pc_ = pc & ~1u;
  thumb_ = (pc & 1) != 0;
  check_ = true;
  if (!good) lock_up();
  if (observer_ != nullptr) observer_->started(*this);
}

void Core::set_executor(Executor executor) {
  executor_ = executor;
  in_blocks_ = executor_ == Executor::blocks && !sees_instructions_;
}

void Core::set_observer(Observer* observer, bool instructions, bool accesses) {
  observer_ = observer;
  sees_instructions_ = observer != nullptr && instructions;
  sees_accesses_ = observer != nullptr && accesses;
  set_executor(executor_);
  memory_.clear_views();
  select_view();
  check_ = true;
}

void Core::map_memory(uint32_t base, uint32_t size, uint8_t* host, bool writable,
                      unsigned wait_states) {
  memory_.map({base, size, host, writable, wait_states});
}
void Core::unmap_memory(uint32_t base, uint32_t size) {
  memory_.unmap(base, size);
}
void Core::invalidate_code(uint32_t address, uint32_t size) {
  if (!memory_.invalidate(address, size)) return;
  invalidated_ = true;
  check_ = true;
}

void Core::attention() {
  attention_ = true;
  check_ = true;
}

bool Core::bx_write_pc(uint32_t target) {
  if (ipsr_ != 0 && (target >> 28) == 0xF) {
    event_ = Event::exception_return;
    event_value_ = target;
    pc_ = target & ~1u;
    return false;
  }
  thumb_ = (target & 1) != 0;
  if (!thumb_) check_ = true;
  pc_ = target & ~1u;
  return false;
}

bool Core::fault(const Step& op, Cause cause, uint32_t address) {
  event_ = Event::fault;
  event_cause_ = cause;
  event_value_ = address;
  pc_ = op.address;
  return false;
}

void Core::handle_event() {
  Event event = event_;
  event_ = Event::none;
  switch (event) {
    case Event::fault:
      raise(record_cause(event_cause_, event_value_), pc_);
      break;
    case Event::svc:
      raise(11, pc_);
      break;
    case Event::bkpt:
      if (event_value_ == 0xAB && semihosting_) {
        if (!semihosting_(*this)) {
          semihosting_exit_ = true;
          check_ = true;
        }
        break;
      }
      if (halting_debug_) {
        pc_ = event_return_;
        bkpt_stop_ = check_ = true;
        break;
      }
      breakpoint_instruction(event_return_);
      break;
    case Event::exception_return:
      exception_return(event_value_);
      break;
    case Event::none:
      break;
  }
}

inline void Core::account(const Step& op) {
  cycles_ += op.cycles_before + op.cycles;
  instructions_ += op.instructions_to;
  it_state_ = op.it_after;
  trail_ = stalled_ ? timing::no_trail : op.trail;
  stalled_ = false;
}

inline void Core::conclude(const Step& op) {
  if (__builtin_expect(event_ != Event::none, 0)) {
    if (event_ == Event::fault) it_state_ = op.it_before;
    if (event_ == Event::exception_return) event_return_ = op.address;
    trail_ = timing::no_trail;
    handle_event();
  }
}

/// What both executors do behind an operation that left: account for it, then handle its event.
void Core::finish(const Step& op) {
  account(op);
  conclude(op);
}

bool Core::fetch(uint32_t address, uint16_t& halfword) {
  // Peripheral, device and system space are execute-never in the default map (B3.1).
  unsigned region = address >> 29;
  bool never_execute = region == 2 || region >= 5;
  uint32_t value = 0;
  Step at;
  at.address = pc_;
  if (never_execute || !mpu_allows(address, false, true, privileged())) {
    fault(at, Cause::fetch_access, address);
    return false;
  }
  if (const Memory::Region* r = memory_.find(address);
      r != nullptr && r->size - (address - r->base) >= 2) {
    std::memcpy(&halfword, r->host + (address - r->base), 2);
    return true;
  }
  unsigned wait = 0;
  if (!bus_.read(address, 2, value, wait, AccessKind::fetch)) {
    fault(at, Cause::fetch_bus, address);
    return false;
  }
  cycles_ += wait;
  halfword = static_cast<uint16_t>(value);
  return true;
}

void Core::step() {
  uint16_t first = 0, second = 0;
  uint32_t address = pc_;
  if (!fetch(address, first) || (is_wide(first) && !fetch(address + 2, second))) {
    cycles_ += 1;
    handle_event();
    return;
  }
  Step step;
  static_cast<DecodedOp&>(step) = decode(address, first, second, it_state_);
  if (Execute::cannot_continue(step)) {
    fault(step, Cause::invalid_state);
    cycles_ += 1;
    handle_event();
    return;
  }
  const Memory::Region* region = memory_.find(address);
  add_cycles(step, trail_, region != nullptr ? region->wait_states : 0);
  step.instructions_to = 1;
  Execute::bind(step);
  if (sees_instructions_) observer_->issued(*this, step);
  if (Execute::one(*this, step)) pc_ = next_address(step);
  account(step);
  if (sees_instructions_) observer_->retired(*this, step);
  conclude(step);
}

std::optional<StopReason> Core::service() {
  check_ = false;
  select_view();
  if (invalidated_) {
    invalidated_ = false;
    memory_.collect();
  }
  auto stop = [this](bool& flag, StopReason reason) {
    flag = false;
    check_ = true;
    return reason;
  };
  if (semihosting_exit_) return stop(semihosting_exit_, StopReason::semihosting_exit);
  if (reset_request_) return stop(reset_request_, StopReason::reset_request);
  if (watch_stop_) return stop(watch_stop_, StopReason::watchpoint);
  if (bkpt_stop_) return stop(bkpt_stop_, StopReason::breakpoint);
  if (stuck_) return stop(stuck_, StopReason::stuck);
  if (attention_) return stop(attention_, StopReason::attention);
  if (unsigned number = highest_pending(execution_priority()); number != 0) {
    bool wakes = sleeping_ || locked_up_;
    if (wakes && locked_up_ && number != 2) number = 0;
    if (number != 0) {
      sleeping_ = locked_up_ = false;
      if (entered_at_ == instructions_) {
        late_arrival(number);
      } else {
        exception_entry(number, pc_);
      }
      check_ = true;
      return std::nullopt;
    }
  }
  if (locked_up_) {
    check_ = true;
    return StopReason::lockup;
  }
  if (sleeping_) {
    if (wake_pending()) {
      sleeping_ = false;
      if (sleeping_for_event_) event_register_ = false;
      return std::nullopt;
    }
    check_ = true;
    return StopReason::sleeping;
  }
  if (!thumb_) {
    execute_without_thumb();
    check_ = true;
  }
  return std::nullopt;
}

/// INVSTATE belongs to the instruction at the target (A2.3.1, BXWritePC: "on the next
/// instruction"). It is raised by executing that one, and what cannot be fetched is not executed:
/// a fault of the fetch comes first (B3.2.15, IACCVIOL and IBUSERR).
void Core::execute_without_thumb() {
  uint16_t unused = 0;
  Step at;
  at.address = pc_;
  if (fetch(pc_, unused)) fault(at, Cause::invalid_state);
  cycles_ += 1;
  handle_event();
}

StopReason Core::run(uint64_t until_cycle) {
  while (true) {
    if (cycles_ >= systick_event_) systick_expire();
    if (__builtin_expect(check_, 0)) {
      bool may_go = cycles_ < until_cycle || sleeping_ || locked_up_ || attention_ ||
                    semihosting_exit_ || reset_request_ || watch_stop_ || bkpt_stop_ || stuck_;
      if (!may_go) return StopReason::budget;
      if (std::optional<StopReason> reason = service()) return *reason;
      continue;
    }
    if (cycles_ >= until_cycle) return StopReason::budget;
    if (!breakpoints_.empty() && at_breakpoint()) return StopReason::breakpoint;
    bool blocks = in_blocks_ && it_state_ == 0 && trail_ == timing::no_trail && !dwt_.observes_step;
    if (blocks) {
      execute_block(std::min(until_cycle, systick_event_));
    } else {
      dwt_.observes_step ? step_observed() : step();
    }
  }
}

StopReason Core::step_instruction() {
  return run(cycles_ + 1);
}

void Core::skip_to(uint64_t cycle) {
  while (cycles_ < cycle) {
    cycles_ = std::min(cycle, std::max(cycles_, systick_event_));
    if (cycles_ >= systick_event_) systick_expire();
  }
}

void Core::sleep_until_wake(bool for_event) {
  sleeping_ = true;
  sleeping_for_event_ = for_event;
  check_ = true;
}

// WFI wakes on an exception that would preempt were PRIMASK clear; WFE besides on an event
// (B1.5.17).
bool Core::wake_pending() const {
  if (sleeping_for_event_ && event_register_) return true;
  return highest_pending(execution_priority(!sleeping_for_event_)) != 0;
}

void Core::send_event() {
  event_register_ = true;
  check_ = true;
}

// The stack pointer in use sits in r_[13], the other one aside; switching exchanges them.
void Core::select_stack(bool psp) {
  bool now = uses_psp();
  if (psp != now) std::swap(r_[13], other_sp_);
}

void Core::set_msp(uint32_t value) {
  (uses_psp() ? other_sp_ : r_[13]) = value & ~3u;
}
void Core::set_psp(uint32_t value) {
  (uses_psp() ? r_[13] : other_sp_) = value & ~3u;
}

// SPSEL can be written in Thread mode only (B1.4.4).
void Core::set_control(uint32_t value) {
  bool psp = ipsr_ == 0 && (value & 2) != 0;
  if (ipsr_ == 0) {
    select_stack(psp);
    control_ = value & 3;
  } else {
    control_ = (control_ & 2) | (value & 1);
  }
  check_ = true;  // the view of the memory follows the privilege
}

void Core::set_primask(bool masked) {
  primask_ = masked ? 1 : 0;
  check_ = true;
}

void Core::set_priority_bits(unsigned bits) {
  priority_mask_ = 0xFF00u >> std::clamp(bits, 3u, 8u) & 0xFF;
}

void Core::set_basepri(uint32_t value) {
  basepri_ = value & priority_mask_;
  check_ = true;
}

void Core::set_faultmask(bool masked) {
  faultmask_ = masked ? 1 : 0;
  check_ = true;
}

void Core::set_reg(unsigned n, uint32_t value) {
  if (n == 13) {
    r_[13] = value & ~3u;
  } else if (n == 15) {
    pc_ = value & ~1u;
    it_state_ = 0;
    trail_ = timing::no_trail;
    sleeping_ = locked_up_ = false;  // it goes on there
  } else if (n < 15) {
    r_[n] = value;
  }
}

uint32_t Core::xpsr() const {
  uint32_t it = it_state_;
  return (n_ & 0x80000000u) | (z_ == 0 ? 1u << 30 : 0) | (c_ ? 1u << 29 : 0) | (v_ ? 1u << 28 : 0) |
         (q_ ? 1u << 27 : 0) | (it & 3) << 25 | (thumb_ ? 1u << 24 : 0) | (it >> 2) << 10 | ipsr_;
}

void Core::set_xpsr(uint32_t value) {
  n_ = value;
  z_ = (value >> 30 & 1) ? 0 : 1;
  c_ = (value >> 29 & 1) != 0;
  v_ = (value >> 28 & 1) != 0;
  q_ = (value >> 27 & 1) != 0;
  thumb_ = (value >> 24 & 1) != 0;
  it_state_ = static_cast<uint8_t>((value >> 25 & 3) | (value >> 10 & 0x3F) << 2);
  if (!thumb_) check_ = true;
}

}  // namespace capsoc::cortex_m3
