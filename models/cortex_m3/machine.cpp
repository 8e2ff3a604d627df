#include "cortex_m3/machine.h"

#include <utility>

namespace capsoc::cortex_m3 {

Machine::Machine(Core& core, Bus& bus)
    : memory(*this, bus),
      blocks(*this),
      exceptions(*this),  // NOLINT(bugprone-throw-keyword-missing): the processor's, not C++'s
      system(*this),
      debugging(*this),
      core_(core) {
  state.reset();
  memory.select_view();
}

bool Machine::fault(uint32_t instruction, Cause cause, uint32_t value) {
  event = {Event::Kind::fault, cause, value, event.return_address};
  state.pc = instruction;
  return false;
}

bool Machine::interwork_to(uint32_t target) {
  state.pc = target & ~1u;
  if (state.ipsr != 0 && (target >> 28) == 0xF) {
    event.kind = Event::Kind::exception_return;
    event.value = target;
    return false;
  }
  state.thumb = (target & 1) != 0;
  if (!state.thumb) requests.raise(Requests::changed);
  return false;
}

void Machine::sleep(bool for_event) {
  state.sleeping = true;
  state.sleeping_for_event = for_event;
  requests.raise(Requests::changed);
}

void Machine::spin_in_fault() {
  if (!listeners.hopeless || exceptions.can_be_preempted() || !listeners.hopeless()) return;
  requests.raise(Requests::stuck);
}

void Machine::report(Unpredictable which, uint32_t instruction) {
  static_assert(static_cast<unsigned>(Unpredictable::count) <= 64);
  const uint64_t bit = uint64_t{1} << static_cast<unsigned>(which);
  if ((state.unpredictable_seen & bit) != 0) return;
  state.unpredictable_seen |= bit;
  if (!listeners.unpredictable) return;
  const uint32_t pc = std::exchange(state.pc, instruction);
  listeners.unpredictable(which, instruction);
  state.pc = pc;
}

void Machine::handle_event() {
  constexpr uint32_t semihosting_call = 0xAB;
  const Event happened = std::exchange(event, Event{});
  switch (happened.kind) {
    case Event::Kind::fault:
      exceptions.raise(state.scb.record(happened.cause, happened.value), state.pc);
      break;
    case Event::Kind::svc:
      exceptions.raise(exception::svcall, state.pc);
      break;
    case Event::Kind::bkpt:
      if (happened.value == semihosting_call && listeners.semihosting) {
        if (listeners.semihosting(core_)) break;
        state.semihosting_exit = true;
        requests.raise(Requests::changed);
      } else if (debugging.halting()) {
        state.pc = happened.return_address;
        requests.raise(Requests::breakpoint);
      } else {
        exceptions.breakpoint_instruction(happened.return_address);
      }
      break;
    case Event::Kind::exception_return:
      exceptions.leave(happened.value, happened.return_address);
      break;
    case Event::Kind::none:
      break;
  }
}

}  // namespace capsoc::cortex_m3
