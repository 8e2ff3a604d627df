#include "cortex_m3/core.h"

#include <algorithm>
#include <utility>

#include "cortex_m3/decoder.h"
#include "cortex_m3/execute.h"
#include "kit/archive.h"

namespace capsoc::cortex_m3 {

/// Tells the listener about each case once. Inside a block state_.pc is behind what is executed, so
/// it is the instruction's address for that long.
void Core::unpredictable(Unpredictable which, uint32_t address) {
  static_assert(static_cast<unsigned>(Unpredictable::count) <= 64);
  const uint64_t bit = uint64_t{1} << static_cast<unsigned>(which);
  if ((state_.unpredictable_seen & bit) != 0) return;
  state_.unpredictable_seen |= bit;
  if (!unpredictable_listener_) return;
  const uint32_t pc = std::exchange(state_.pc, address);
  unpredictable_listener_(which, address);
  state_.pc = pc;
}

Core::Core(Bus& bus) : bus_(bus) {
  reset_system_control();
}

void Core::reset() {
  reset_system_control();
  state_.r.fill(0);
  state_.n = 0;
  state_.z = 1;
  state_.c = state_.v = state_.q = false;
  state_.control = state_.primask = state_.faultmask = state_.basepri = state_.ipsr =
      state_.other_sp = 0;
  state_.it_state = 0;
  state_.trail = timing::no_trail;
  state_.entered_at = never;
  state_.sleeping = state_.locked_up = attention_ = state_.reset_request = state_.semihosting_exit =
      false;
  state_.event_register = state_.exclusive = false;
  watch_stop_ = bkpt_stop_ = stuck_ = false;
  breakpoint_passed_ = never;
  event_ = Event::none;
  state_.last_fault = {};
  state_.first_fault = {};
  memory_.invalidate_all();
  uint32_t sp = 0, pc = 0;
  state_.scb.vtor = vector_table_;
  bool good = read_physical(state_.scb.vtor, 4, sp) <= Result::device &&
              read_physical(state_.scb.vtor + 4, 4, pc) <= Result::device;
  state_.stalled = false;  // by these reads
  state_.r[13] = sp & ~3u;
  state_.r[14] = 0xFFFFFFFF;
  state_.pc = pc & ~1u;
  state_.thumb = (pc & 1) != 0;
  check_ = true;
  if (!good) lock_up();
  if (observer_ != nullptr) observer_->started(*this);
}

void Core::visit(kit::Archive& archive) {
  state_.visit(archive);
  if (!archive.loading() || !archive.ok()) return;
  event_ = Event::none;
  attention_ = stuck_ = watch_stop_ = bkpt_stop_ = false;
  breakpoint_passed_ = never;
  access_offset_ = 0;
  mpu_changed();
  const uint32_t count_seen = state_.dwt.count_seen;
  select_dwt();
  state_.dwt.count_seen = count_seen;
  select_view();
  check_ = true;
}

void Core::memory_changed() {
  memory_.invalidate_all();
  invalidated_ = true;
  check_ = true;
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
  if (state_.ipsr != 0 && (target >> 28) == 0xF) {
    event_ = Event::exception_return;
    event_value_ = target;
    state_.pc = target & ~1u;
    return false;
  }
  state_.thumb = (target & 1) != 0;
  if (!state_.thumb) check_ = true;
  state_.pc = target & ~1u;
  return false;
}

bool Core::fault(const Step& op, Cause cause, uint32_t address) {
  event_ = Event::fault;
  event_cause_ = cause;
  event_value_ = address;
  state_.pc = op.address;
  return false;
}

void Core::handle_event() {
  Event event = event_;
  event_ = Event::none;
  switch (event) {
    case Event::fault:
      raise(record_cause(event_cause_, event_value_), state_.pc);
      break;
    case Event::svc:
      raise(11, state_.pc);
      break;
    case Event::bkpt:
      if (event_value_ == 0xAB && semihosting_) {
        if (!semihosting_(*this)) {
          state_.semihosting_exit = true;
          check_ = true;
        }
        break;
      }
      if (halting_debug_) {
        state_.pc = event_return_;
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
  state_.cycles += op.cycles_before + op.cycles;
  state_.instructions += op.instructions_to;
  state_.it_state = op.it_after;
  state_.trail = state_.stalled ? timing::no_trail : op.trail;
  state_.stalled = false;
}

inline void Core::conclude(const Step& op) {
  if (__builtin_expect(event_ != Event::none, 0)) {
    if (event_ == Event::fault) state_.it_state = op.it_before;
    if (event_ == Event::exception_return) event_return_ = op.address;
    state_.trail = timing::no_trail;
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
  at.address = state_.pc;
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
  state_.cycles += wait;
  halfword = static_cast<uint16_t>(value);
  return true;
}

void Core::step() {
  uint16_t first = 0, second = 0;
  uint32_t address = state_.pc;
  if (!fetch(address, first) || (is_wide(first) && !fetch(address + 2, second))) {
    state_.cycles += 1;
    handle_event();
    return;
  }
  Step step;
  static_cast<DecodedOp&>(step) = decode(address, first, second, state_.it_state);
  if (Execute::cannot_continue(step)) {
    fault(step, Cause::invalid_state);
    state_.cycles += 1;
    handle_event();
    return;
  }
  const Memory::Region* region = memory_.find(address);
  add_cycles(step, state_.trail, region != nullptr ? region->wait_states : 0);
  step.instructions_to = 1;
  Execute::bind(step);
  if (sees_instructions_) observer_->issued(*this, step);
  if (Execute::one(*this, step)) state_.pc = next_address(step);
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
  if (state_.semihosting_exit) return stop(state_.semihosting_exit, StopReason::semihosting_exit);
  if (state_.reset_request) return stop(state_.reset_request, StopReason::reset_request);
  if (watch_stop_) return stop(watch_stop_, StopReason::watchpoint);
  if (bkpt_stop_) return stop(bkpt_stop_, StopReason::breakpoint);
  if (stuck_) return stop(stuck_, StopReason::stuck);
  if (attention_) return stop(attention_, StopReason::attention);
  if (unsigned number = highest_pending(execution_priority()); number != 0) {
    bool wakes = state_.sleeping || state_.locked_up;
    if (wakes && state_.locked_up && number != 2) number = 0;
    if (number != 0) {
      state_.sleeping = state_.locked_up = false;
      if (state_.entered_at == state_.instructions) {
        late_arrival(number);
      } else {
        exception_entry(number, state_.pc);
      }
      check_ = true;
      return std::nullopt;
    }
  }
  if (state_.locked_up) {
    check_ = true;
    return StopReason::lockup;
  }
  if (state_.sleeping) {
    if (wake_pending()) {
      state_.sleeping = false;
      if (state_.sleeping_for_event) state_.event_register = false;
      return std::nullopt;
    }
    check_ = true;
    return StopReason::sleeping;
  }
  if (!state_.thumb) {
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
  at.address = state_.pc;
  if (fetch(state_.pc, unused)) fault(at, Cause::invalid_state);
  state_.cycles += 1;
  handle_event();
}

StopReason Core::run(uint64_t until_cycle) {
  while (true) {
    if (state_.cycles >= state_.systick.event) systick_expire();
    if (__builtin_expect(check_, 0)) {
      bool may_go = state_.cycles < until_cycle || state_.sleeping || state_.locked_up ||
                    attention_ || state_.semihosting_exit || state_.reset_request || watch_stop_ ||
                    bkpt_stop_ || stuck_;
      if (!may_go) return StopReason::budget;
      if (std::optional<StopReason> reason = service()) return *reason;
      continue;
    }
    if (state_.cycles >= until_cycle) return StopReason::budget;
    if (!breakpoints_.empty() && at_breakpoint()) return StopReason::breakpoint;
    bool blocks = in_blocks_ && state_.it_state == 0 && state_.trail == timing::no_trail &&
                  !state_.dwt.observes_step;
    if (blocks) {
      execute_block(std::min(until_cycle, state_.systick.event));
    } else {
      state_.dwt.observes_step ? step_observed() : step();
    }
  }
}

StopReason Core::step_instruction() {
  return run(state_.cycles + 1);
}

void Core::skip_to(uint64_t cycle) {
  while (state_.cycles < cycle) {
    state_.cycles = std::min(cycle, std::max(state_.cycles, state_.systick.event));
    if (state_.cycles >= state_.systick.event) systick_expire();
  }
}

void Core::sleep_until_wake(bool for_event) {
  state_.sleeping = true;
  state_.sleeping_for_event = for_event;
  check_ = true;
}

// WFI wakes on an exception that would preempt were PRIMASK clear; WFE besides on an event
// (B1.5.17).
bool Core::wake_pending() const {
  if (state_.sleeping_for_event && state_.event_register) return true;
  return highest_pending(execution_priority(!state_.sleeping_for_event)) != 0;
}

void Core::send_event() {
  state_.event_register = true;
  check_ = true;
}

// The stack pointer in use sits in state_.r[13], the other one aside; switching exchanges them.
void Core::select_stack(bool psp) {
  bool now = uses_psp();
  if (psp != now) std::swap(state_.r[13], state_.other_sp);
}

void Core::set_msp(uint32_t value) {
  (uses_psp() ? state_.other_sp : state_.r[13]) = value & ~3u;
}
void Core::set_psp(uint32_t value) {
  (uses_psp() ? state_.r[13] : state_.other_sp) = value & ~3u;
}

// SPSEL can be written in Thread mode only (B1.4.4).
void Core::set_control(uint32_t value) {
  bool psp = state_.ipsr == 0 && (value & 2) != 0;
  if (state_.ipsr == 0) {
    select_stack(psp);
    state_.control = value & 3;
  } else {
    state_.control = (state_.control & 2) | (value & 1);
  }
  check_ = true;  // the view of the memory follows the privilege
}

void Core::set_primask(bool masked) {
  state_.primask = masked ? 1 : 0;
  check_ = true;
}

void Core::set_priority_bits(unsigned bits) {
  priority_mask_ = 0xFF00u >> std::clamp(bits, 3u, 8u) & 0xFF;
}

void Core::set_basepri(uint32_t value) {
  state_.basepri = value & priority_mask_;
  check_ = true;
}

void Core::set_faultmask(bool masked) {
  state_.faultmask = masked ? 1 : 0;
  check_ = true;
}

void Core::set_reg(unsigned n, uint32_t value) {
  if (n == 13) {
    state_.r[13] = value & ~3u;
  } else if (n == 15) {
    state_.pc = value & ~1u;
    state_.it_state = 0;
    state_.trail = timing::no_trail;
    state_.sleeping = state_.locked_up = false;  // it goes on there
  } else if (n < 15) {
    state_.r[n] = value;
  }
}

uint32_t Core::xpsr() const {
  uint32_t it = state_.it_state;
  return (state_.n & 0x80000000u) | (state_.z == 0 ? 1u << 30 : 0) | (state_.c ? 1u << 29 : 0) |
         (state_.v ? 1u << 28 : 0) | (state_.q ? 1u << 27 : 0) | (it & 3) << 25 |
         (state_.thumb ? 1u << 24 : 0) | (it >> 2) << 10 | state_.ipsr;
}

void Core::set_xpsr(uint32_t value) {
  state_.n = value;
  state_.z = (value >> 30 & 1) ? 0 : 1;
  state_.c = (value >> 29 & 1) != 0;
  state_.v = (value >> 28 & 1) != 0;
  state_.q = (value >> 27 & 1) != 0;
  state_.thumb = (value >> 24 & 1) != 0;
  state_.it_state = static_cast<uint8_t>((value >> 25 & 3) | (value >> 10 & 0x3F) << 2);
  if (!state_.thumb) check_ = true;
}

}  // namespace capsoc::cortex_m3
