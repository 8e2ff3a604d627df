#include "armv7m/core.h"

#include <algorithm>
#include <utility>

#include "base/archive.h"

namespace capsoc::armv7m {

void Core::reset() {
  State& state = machine_.state;
  MemoryAccess& memory = machine_.memory;
  state.reset(*machine_.profile.registers);
  memory.regions_changed();
  machine_.requests.drop_stops();
  machine_.debugging.forget_arrival();
  machine_.event = {};
  known_turn_.forget();
  memory.map().invalidate_all();
  state.scb.set_vector_table(vector_table_);
  uint32_t sp = 0, pc = 0;
  const bool good =
      memory.read_physical(state.scb.vector(0), 4, sp) <= BusResult::device &&
      memory.read_physical(state.scb.vector(exception::reset), 4, pc) <= BusResult::device;
  state.stalled = false;  // by these reads
  memory.watch_vectors();
  state.r[13] = sp & ~3u;
  state.r[14] = 0xFFFFFFFF;
  state.pc = pc & ~1u;
  state.thumb = (pc & 1) != 0;
  machine_.requests.raise(Requests::changed);
  if (!good) machine_.exceptions.lock_up();
  machine_.debugging.set_up_trace();
  if (machine_.listeners.observer != nullptr) machine_.listeners.observer->started(*this);
}

State& Core::edit() {
  machine_.requests.raise(Requests::changed);
  return machine_.state;
}

void Core::visit(Archive& archive) {
  State& state = machine_.state;
  state.visit(archive);
  if (profile().has_fpu()) archive("fpu", state.fpu);
  if ((state.control & ~profile().control_bits()) != 0)
    archive.refuse("has a CONTROL that the processor does not have");
  uint32_t stimulus_ports = machine_.debugging.stimulus_ports();
  archive("stimulus_ports", stimulus_ports);
  if (!archive.loading() || !archive.ok()) return;
  machine_.event = {};
  known_turn_.forget();
  machine_.requests.drop_stops();
  machine_.debugging.forget_arrival();
  state.dwt.restored(state.scb.tracing(), state.scb.monitor_steps());
  machine_.memory.regions_changed();
  // What the program has made of the trace since stays as it is.
  if (stimulus_ports != machine_.debugging.stimulus_ports()) machine_.debugging.set_up_trace();
}

void Core::set_executor(Executor executor) {
  executor_ = executor;
  if (executor == Executor::translator && translator_ == nullptr && no_translator_.empty())
    translator_ = Translator::make(machine_, blocks_, translator_limits_, no_translator_);
  if (executor == Executor::stepping || machine_.listeners.sees_instructions)
    executing_ = &stepping_;
  else if (executor == Executor::translator && translator_ != nullptr)
    executing_ = translator_.get();
  else
    executing_ = &blocks_;
}

void Core::add_observer(Observer& observer, bool instructions, bool accesses) {
  observers_.add(observer, instructions, accesses);
  observers_changed();
}

void Core::remove_observer(Observer& observer) {
  observers_.remove(observer);
  observers_changed();
}

void Core::count_executions(ExecutionCounts* counts) {
  machine_.counts = counts;
  machine_.memory.invalidate_all_code();
}

void Core::observers_changed() {
  machine_.listeners.observer = observers_.all();
  machine_.listeners.sees_instructions = observers_.see_instructions();
  machine_.listeners.sees_accesses = observers_.see_accesses();
  set_executor(executor_);
  machine_.memory.views_changed();
}

void Core::set_interrupt(unsigned line, bool level) {
  if (line >= interrupt_count) return;
  if (machine_.state.nvic.set_line(line, level))
    machine_.pending.pend(exception::first_interrupt + line);
}

void Core::send_event() {
  edit().event_register = true;
}

/// What ends run() before anything else happens, in the order of urgency; it stays asked for to be
/// looked at again.
std::optional<StopReason> Core::stop_wanted() {
  State& state = machine_.state;
  Requests& requests = machine_.requests;
  if (!requests.has(Requests::unanswered) && std::exchange(state.semihosting_waits, false) &&
      listeners().semihosting)
    state.semihosting_exit = !listeners().semihosting(*this);
  if (requests.take(Requests::unanswered)) return StopReason::semihosting_waits;
  if (std::exchange(state.semihosting_exit, false)) return StopReason::semihosting_exit;
  if (std::exchange(state.reset_request, false)) return StopReason::reset_request;
  if (requests.take(Requests::watchpoint)) return StopReason::watchpoint;
  if (requests.take(Requests::breakpoint)) return StopReason::breakpoint;
  if (requests.take(Requests::stuck)) return StopReason::stuck;
  if (requests.take(Requests::attention)) return StopReason::attention;
  return std::nullopt;
}

/// Looks at what was asked for: a stop, an exception, sleep, lockup. None: execution continues.
std::optional<StopReason> Core::service() {
  State& state = machine_.state;
  Requests& requests = machine_.requests;
  requests.looked_at();
  machine_.memory.select_view();
  machine_.memory.collect();
  const auto look_again = [&](std::optional<StopReason> reason) {
    requests.raise(Requests::changed);
    return reason;
  };
  if (const auto reason = stop_wanted()) return look_again(reason);
  const PendingExceptions& pending = machine_.pending;
  unsigned number = pending.highest_pending(pending.execution_priority());
  if (state.locked_up && number != exception::nmi) number = 0;
  if (number != 0) {
    if (state.sleeping && listeners().sleeps) listeners().sleeps(false);
    state.sleeping = state.locked_up = false;
    if (state.entered_at == state.instructions)
      machine_.exceptions.late_arrival(number);
    else
      machine_.exceptions.enter(number, state.pc);
    return look_again(std::nullopt);
  }
  if (state.locked_up) return look_again(StopReason::lockup);
  if (state.sleeping) {
    if (!wake_pending()) return look_again(StopReason::sleeping);
    state.sleeping = false;
    if (listeners().sleeps) listeners().sleeps(false);
    if (state.sleeping_for_event) state.event_register = false;
    return std::nullopt;
  }
  if (!state.thumb) {
    stepping_.without_thumb();
    return look_again(std::nullopt);
  }
  return std::nullopt;
}

StopReason Core::run(uint64_t until_cycle) {
  if (machine_.counts == nullptr) return execute(until_cycle);
  machine_.counts->begins(machine_.state.pc);
  const StopReason reason = execute(until_cycle);
  machine_.counts->ends(machine_.state.pc);
  return reason;
}

StopReason Core::execute(uint64_t until_cycle) {
  State& state = machine_.state;
  Requests& requests = machine_.requests;
  while (true) {
    if (state.cycles >= state.systick.event()) expire_systick();
    if (__builtin_expect(requests.any(), 0)) {
      const bool may_go = state.cycles < until_cycle || state.sleeping || state.locked_up ||
                          state.semihosting_exit || state.reset_request ||
                          requests.has(Requests::stops);
      if (!may_go) return StopReason::budget;
      const uint32_t before = state.pc;
      const std::optional<StopReason> reason = service();
      if (machine_.counts != nullptr) machine_.counts->moved(before, state.pc);
      if (reason) return *reason;
      continue;
    }
    if (state.cycles >= until_cycle) return StopReason::budget;
    Debugging& debugging = machine_.debugging;
    if (debugging.has_breakpoints() && debugging.at_breakpoint()) return StopReason::breakpoint;
    if (__builtin_expect(state.dwt.observes_steps(), 0))
      step_observed();
    else if (one_instruction_)
      stepping_.run(until_cycle);
    else
      executing_->run(std::min(until_cycle, state.systick.event()));
    if (__builtin_expect(one_instruction_, 0))
      return requests.take(Requests::watchpoint) ? StopReason::watchpoint : StopReason::budget;
  }
}

/// The cycle alone does not tell instructions apart: one that is folded takes none.
StopReason Core::step_instruction() {
  one_instruction_ = true;
  const StopReason reason = run(machine_.state.cycles + 1);
  one_instruction_ = false;
  return reason;
}

/// One instruction while a step, an instruction or a cycle is waited for.
void Core::step_observed() {
  State& state = machine_.state;
  const bool steps = state.scb.monitor_steps() && machine_.pending.monitor_can_preempt();
  const uint32_t executed = state.pc;
  stepping_.run(never);
  if (state.dwt.match_step(executed, machine_.cycles(), state.scb.tracing()))
    machine_.pending.debug_event(Scb::DebugReason::dwttrap);
  if (!steps) return;
  state.scb.record(Scb::DebugReason::halted);
  machine_.pending.pend(exception::debug_monitor);
}

void Core::expire_systick() {
  machine_.state.systick.expire();
  machine_.pending.pend(exception::systick);
}

void Core::skip_to(uint64_t cycle) {
  State& state = machine_.state;
  while (state.cycles < cycle) {
    state.cycles = std::min(cycle, std::max(state.cycles, state.systick.event()));
    if (state.cycles >= state.systick.event()) expire_systick();
  }
}

}  // namespace capsoc::armv7m
