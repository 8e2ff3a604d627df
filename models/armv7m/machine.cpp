#include "armv7m/machine.h"

#include <utility>

namespace capsoc::armv7m {

Machine::Machine(Core& core, Bus& bus, const Profile& core_profile)
    : CoreContext(core, core_profile),
      pending(*this),
      watchpoints(*this, pending),
      memory(*this, bus, system, pending, watchpoints),
      floating_point(*this, pending, memory),
      // NOLINTNEXTLINE(bugprone-throw-keyword-missing): the processor's, not C++'s
      exceptions(*this, pending, memory, floating_point),
      system(*this, pending, memory),
      debugging(*this, watchpoints, memory, system) {
  state.nvic.set_priority_bits(profile.least_priority_bits);
  state.reset(*profile.registers);
  memory.select_view();
}

void Machine::spin_in_fault() {
  if (!listeners.hopeless || pending.can_be_preempted() || !listeners.hopeless()) return;
  requests.raise(Requests::stuck);
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
        if (listeners.semihosting(core())) break;
        state.semihosting_exit = true;
        requests.raise(Requests::changed);
      } else if (halting.enabled()) {
        state.pc = happened.return_address;
        requests.raise(Requests::breakpoint);
      } else {
        exceptions.breakpoint_instruction(happened.return_address);
      }
      break;
    case Event::Kind::exception_return:
      exceptions.leave(happened.value, happened.return_address);
      break;
    case Event::Kind::lockup:
      exceptions.lock_up();
      break;
    case Event::Kind::abandoned:
    case Event::Kind::none:
      break;
  }
}

}  // namespace capsoc::armv7m
