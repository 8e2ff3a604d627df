#include "armv7m/exceptions.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "armv7m/exception_frame.h"
#include "armv7m/isa/timing.h"

namespace capsoc::armv7m {
namespace {

/// EXC_RETURN (B1.5.8): all ones, except the low four bits, which select the return, and bit 4 with
/// an FPU.
constexpr uint32_t exc_return_ones = 0xFFFFFFF0,
                   extended_ones = exc_return_ones & ~exc_return_basic_frame;
constexpr uint32_t to_handler = 0x1, to_thread_main = 0x9, to_thread_process = 0xD;
uint32_t destination(uint32_t exc_return) {
  return exc_return & ~exc_return_ones;
}

constexpr uint32_t lockup_address = 0xFFFFFFFE;
constexpr uint32_t stacked_alignment = 1u << 9;

/// Of a fault's exception; 0: a lockup.
FaultReport::Kind kind_of(unsigned number) {
  using Kind = FaultReport::Kind;
  switch (number) {
    case 0:
      return Kind::lockup;
    case exception::mem_manage:
      return Kind::mem_manage;
    case exception::bus_fault:
      return Kind::bus_fault;
    case exception::usage_fault:
      return Kind::usage_fault;
    default:
      return Kind::hard_fault;
  }
}

}  // namespace

unsigned Exceptions::escalate(unsigned number, int priority) {
  if (pending_.enabled(number) && pending_.group_priority(number) < priority) return number;
  if (priority <= -1) return 0;
  context_.state.scb.record_forced();
  return exception::hard_fault;
}

void Exceptions::raise(unsigned number, uint32_t return_address) {
  const unsigned taken = escalate(number, pending_.execution_priority());
  if (taken == 0) {
    capture_fault(0, return_address);
    return lock_up();
  }
  enter(taken, return_address);
}

InterruptedRegisters Exceptions::interrupted(uint32_t return_address) const {
  const State& state = context_.state;
  InterruptedRegisters registers{state.r, state.msp(), state.psp(), state.ipsr};
  registers.r[15] = return_address;
  return registers;
}

/// The report of a fault; number 0: of a lockup.
void Exceptions::capture_fault(unsigned number, uint32_t return_address,
                               const InterruptedRegisters& registers) {
  State& state = context_.state;
  FaultReport& f = state.last_fault;
  f.kind = kind_of(number);
  f.exception = number == 0 ? state.ipsr : number;
  f.cfsr = state.scb.cfsr();
  f.hfsr = state.scb.hfsr();
  f.mmfar = state.scb.mmfar();
  f.bfar = state.scb.bfar();
  f.frame = {state.r[0],  state.r[1],  state.r[2],     state.r[3],
             state.r[12], state.r[14], return_address, state.xpsr()};
  f.address = state.scb.fault_address(return_address);
  f.nesting = state.nvic.active_count();
  f.cycle = state.cycles;
  f.registers = registers;
  constexpr uint32_t imprecise = 1u << 10;
  f.lost_write = (f.cfsr & imprecise) != 0 ? state.lost_write : LostWrite{};
  if (!context_.profile.has_fault_status) state.scb.forget_faults();
  ++state.fault_count;
  constexpr uint64_t fault_exceptions = uint64_t{0xF} << exception::hard_fault;
  if ((state.nvic.active() & fault_exceptions) == 0) state.first_fault = f;
}

void Exceptions::lock_up() {
  State& state = context_.state;
  if (state.last_fault.kind != FaultReport::Kind::lockup) {
    capture_fault(0, state.pc);
    --state.fault_count;
  }
  state.locked_up = true;
  state.pc = lockup_address;
  context_.requests.raise(Requests::changed);
}

void Exceptions::breakpoint_instruction(uint32_t address) {
  Scb& scb = context_.state.scb;
  scb.record(Scb::DebugReason::bkpt);
  if (pending_.monitor_can_preempt()) return enter(exception::debug_monitor, address);
  scb.record_debug_event();
  if (pending_.execution_priority() <= -1) return lock_up();
  enter(exception::hard_fault, address);
}

bool Exceptions::push_stack(uint32_t return_address, Cause& cause) {
  State& state = context_.state;
  const uint32_t sp = state.r[13];
  const bool extended = state.has_fp_context();
  const bool aligns = extended || state.scb.aligns_stack(), moved = aligns && (sp & 4) != 0;
  const uint32_t bytes = extended ? extended_frame_bytes : exception_frame_bytes;
  const uint32_t frame = (sp - bytes) & ~(aligns ? 4u : 0u);
  const bool stacked = push_basic_frame(frame, return_address, moved, cause);
  if (!extended) return stacked;
  const auto failed = floating_point_.push(frame + exception_frame_bytes, stacked);
  if (failed) cause = *failed;
  return stacked && !failed;
}

bool Exceptions::push_basic_frame(uint32_t frame, uint32_t return_address, bool moved,
                                  Cause& cause) {
  State& state = context_.state;
  const uint32_t words[8] = {
      state.r[0],  state.r[1],  state.r[2],     state.r[3],
      state.r[12], state.r[14], return_address, state.xpsr() | (moved ? stacked_alignment : 0)};
  const bool priv = state.privileged();
  state.r[13] = frame;
  if (uint8_t* bytes = memory_.plain(frame, 8, true)) {
    std::memcpy(bytes, words, sizeof words);
    return true;
  }
  for (unsigned i = 0; i < 8; ++i) {
    const BusResult result = memory_.write(frame + 4 * i, 4, words[i], priv);
    if (result <= BusResult::device) continue;
    cause = result == BusResult::bus_error ? Cause::stacking_bus : Cause::stacking_access;
    return false;
  }
  return true;
}

void Exceptions::enter(unsigned number, uint32_t return_address) {
  State& state = context_.state;
  if (exception::is_fault(number)) capture_fault(number, return_address);
  const uint64_t since = state.cycles;
  state.cycles += context_.profile.timing.exception_entry;
  const uint32_t frame_kind = state.has_fp_context() ? 0 : exc_return_basic_frame;
  const uint32_t exc_return = extended_ones | frame_kind |
                              (state.ipsr != 0    ? to_handler
                               : state.uses_psp() ? to_thread_process
                                                  : to_thread_main);
  const int before = pending_.execution_priority();
  const uint32_t sp = state.r[13];
  bool ends_in_lockup = false;
  Cause cause{};
  if (!push_stack(return_address, cause)) {
    InterruptedRegisters before_stacking = interrupted(return_address);
    before_stacking.r[13] = sp;
    (state.uses_psp() ? before_stacking.psp : before_stacking.msp) = sp;
    // A derived exception: the better of the two is taken, the other one stays pending.
    const unsigned derived = escalate(state.scb.record(cause, 0), before);
    ends_in_lockup = derived == 0 && context_.profile.locks_up_before_nmi;
    if (derived == 0 && (number != exception::nmi || ends_in_lockup))
      capture_fault(0, return_address, before_stacking);
    if (derived == 0 && number != exception::nmi) return lock_up();
    if (derived != 0 && state.nvic.priority(derived) <= state.nvic.priority(number)) {
      if (derived != number) state.nvic.set_pending(number, true);
      capture_fault(derived, return_address, before_stacking);
      number = derived;
    } else if (derived != 0) {
      state.nvic.set_pending(derived, true);
    }
  }
  take(number, exc_return, Entry::preempts, since);
  if (ends_in_lockup) lock_up();
}

void Exceptions::late_arrival(unsigned number) {
  State& state = context_.state;
  const unsigned displaced = state.ipsr;
  state.nvic.set_active(displaced, false);
  state.nvic.set_pending(displaced, true);
  const uint64_t since = state.cycles;
  state.cycles += context_.profile.timing.late_arrival;
  if (exception::is_fault(number)) capture_fault(number, state.pc);
  take(number, state.r[14], Entry::displaces, since);
}

/// ExceptionTaken: the frame is stacked, the handler's address is read, and it begins.
void Exceptions::take(unsigned number, uint32_t exc_return, Entry how, uint64_t since) {
  State& state = context_.state;
  const auto read_vector = [&](unsigned of, uint32_t& vector) {
    // The vector table is read past the MPU, by the default map.
    return memory_.read_physical(state.scb.vector(of), 4, vector) <= BusResult::device;
  };
  uint32_t vector = 0;
  if (!read_vector(number, vector)) {
    state.scb.record_vector_table();
    const bool hopeless = number <= exception::hard_fault || pending_.execution_priority() <= -1;
    if (!hopeless) state.nvic.set_pending(number, true);
    if (hopeless || !read_vector(exception::hard_fault, vector)) {
      capture_fault(0, state.pc);
      return lock_up();
    }
    capture_fault(exception::hard_fault, state.pc);
    state.nvic.set_pending(exception::hard_fault, false);
    number = exception::hard_fault;
  }
  state.select_stack(false);
  state.control &= 1u;  // neither SPSEL nor FPCA
  state.ipsr = number;
  state.nvic.set_pending(number, false);
  state.nvic.set_active(number, true);
  state.r[14] = exc_return;
  state.pc = vector & ~1u;
  state.thumb = (vector & 1) != 0;
  state.it_state = 0;
  state.trail = timing::no_trail;
  state.stalled = false;  // by the stacking
  state.exclusive = false;
  state.event_register = true;
  context_.requests.raise(Requests::changed);
  // Whether faults can be displaced is IMPLEMENTATION DEFINED; here they cannot.
  state.entered_at = exception::is_fault(number) ? State::never : state.instructions;
  if (Observer* observer = context_.listeners.observer)
    observer->entered(context_.core(), number, how, since);
}

void Exceptions::deactivate(unsigned number) {
  State& state = context_.state;
  state.nvic.set_active(number, false);
  if (number != exception::nmi) state.faultmask = 0;
  // A level that is still high asks again.
  if (state.nvic.line_is_high(number)) pending_.pend(number);
  context_.requests.raise(Requests::changed);
}

void Exceptions::return_fault(Cause cause, uint32_t exc_return) {
  State& state = context_.state;
  const unsigned number = escalate(state.scb.record(cause, 0), pending_.execution_priority());
  if (number == 0) {
    capture_fault(0, state.pc);
    return lock_up();
  }
  capture_fault(number, state.pc);
  const uint64_t since = state.cycles;
  state.cycles += context_.profile.timing.tail_chain;
  take(number, exc_return, Entry::tail_chains, since);
}

uint32_t Exceptions::ones_of_exc_return() const {
  return context_.profile.has_fpu() ? extended_ones : exc_return_ones;
}

void Exceptions::leave(uint32_t exc_return, uint32_t instruction) {
  State& state = context_.state;
  const unsigned returning = state.ipsr;
  const bool was_active = state.nvic.is_active(returning);
  const unsigned nested = state.nvic.active_count();
  const bool base_ok = nested == 1 || state.scb.allows_nonbase_thread();
  const uint32_t ones = ones_of_exc_return();
  const bool well_formed = (exc_return & ones) == ones;
  if (!well_formed) context_.report(Unpredictable::exc_return, instruction);
  bool legal = was_active && well_formed;
  switch (destination(exc_return)) {
    case to_handler:
      legal = legal && nested != 1;
      break;
    case to_thread_main:
    case to_thread_process:
      legal = legal && base_ok;
      break;
    default:
      legal = false;
  }
  if (was_active) deactivate(returning);
  if (!legal) return return_fault(Cause::invalid_pc, 0xF0000000u | exc_return);
  if (const unsigned next = pending_.highest_pending(pending_.execution_priority()); next != 0) {
    const uint64_t since = state.cycles;
    state.cycles += context_.profile.timing.tail_chain;
    if (exception::is_fault(next)) capture_fault(next, state.pc);
    return take(next, exc_return, Entry::tail_chains, since);
  }
  Cause cause{};
  state.cycles += context_.profile.timing.exception_return;
  if (!pop_stack(exc_return, instruction, cause)) return return_fault(cause, exc_return);
  state.stalled = false;
  state.exclusive = false;
  state.event_register = true;
  context_.requests.raise(Requests::changed);
  if (Observer* observer = context_.listeners.observer)
    observer->returned(context_.core(), returning);
  if (state.ipsr == 0 && state.scb.sleeps_on_exit()) context_.sleep(false);
}

bool Exceptions::pop_stack(uint32_t exc_return, uint32_t instruction, Cause& cause) {
  State& state = context_.state;
  const bool psp = destination(exc_return) == to_thread_process,
             to_thread = destination(exc_return) != to_handler;
  const uint32_t frame = psp ? state.other_sp : state.r[13];
  const bool priv = !to_thread || (state.control & 1) == 0;
  uint32_t words[8];
  const uint8_t* const bytes = memory_.plain(frame, 8, false);
  if (bytes != nullptr) std::memcpy(words, bytes, sizeof words);
  for (unsigned i = 0; i < 8 && bytes == nullptr; ++i) {
    const BusResult result = memory_.read(frame + 4 * i, 4, words[i], priv);
    if (result <= BusResult::device) continue;
    cause = result == BusResult::bus_error ? Cause::unstacking_bus : Cause::unstacking_access;
    return false;
  }
  const uint32_t psr = words[7];
  const uint32_t existing = psr & context_.profile.xpsr_bits;
  if (((existing & exception_number_mask) == 0) != to_thread) {
    cause = Cause::invalid_pc;
    return false;
  }
  const bool extended = (exc_return & exc_return_basic_frame) == 0;
  if (extended) {
    if (const auto failed = floating_point_.pop(frame + exception_frame_bytes, priv)) {
      cause = *failed;
      return false;
    }
  }
  const bool aligned = (psr & stacked_alignment) != 0 && (extended || state.scb.aligns_stack());
  const uint32_t sp = (frame + frame_bytes(exc_return)) | (aligned ? 4u : 0u);
  (psp ? state.other_sp : state.r[13]) = sp;
  state.ipsr = existing & exception_number_mask;
  // Handler mode had MSP in r[13]; Thread mode takes what the return value names.
  state.control = (state.control & 1) | (psp ? 2u : 0u) | (extended ? State::control_fpca : 0u);
  if (psp) std::swap(state.r[13], state.other_sp);
  for (unsigned i = 0; i < 4; ++i) state.r[i] = words[i];
  state.r[12] = words[4];
  state.r[14] = words[5];
  if ((words[6] & 1) != 0) context_.report(Unpredictable::return_address, instruction);
  state.pc = words[6] & ~1u;
  state.set_xpsr(existing);
  return true;
}

}  // namespace capsoc::armv7m
