#include "armv7m/core_context.h"

#include <utility>

namespace capsoc::armv7m {

bool CoreContext::interwork_to(uint32_t target) {
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

void CoreContext::sleep(bool for_event) {
  state.sleeping = true;
  state.sleeping_for_event = for_event;
  requests.raise(Requests::changed);
  if (listeners.sleeps) listeners.sleeps(true);
}

void CoreContext::report(Unpredictable which, uint32_t instruction) {
  static_assert(static_cast<unsigned>(Unpredictable::count) <= 64);
  const uint64_t bit = uint64_t{1} << static_cast<unsigned>(which);
  if ((state.unpredictable_seen & bit) != 0) return;
  state.unpredictable_seen |= bit;
  if (!listeners.unpredictable) return;
  const uint32_t pc = std::exchange(state.pc, instruction);
  listeners.unpredictable(which, instruction);
  state.pc = pc;
}

}  // namespace capsoc::armv7m
