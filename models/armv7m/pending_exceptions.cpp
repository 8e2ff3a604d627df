#include "armv7m/pending_exceptions.h"

#include <algorithm>

namespace capsoc::armv7m {

int PendingExceptions::group_priority(unsigned number) const {
  return context_.state.scb.group_priority(context_.state.nvic.priority(number));
}

int PendingExceptions::execution_priority(bool ignore_primask) const {
  const State& state = context_.state;
  int highest = 256;
  for (uint64_t left = state.nvic.active(); left != 0; left &= left - 1)
    highest = std::min(highest, group_priority(static_cast<unsigned>(__builtin_ctzll(left))));
  int boosted = 256;
  if (state.basepri != 0) boosted = state.scb.group_priority(static_cast<int>(state.basepri));
  if (state.primask != 0 && !ignore_primask) boosted = 0;
  if (state.faultmask != 0) boosted = -1;
  return std::min(highest, boosted);
}

bool PendingExceptions::enabled(unsigned number) const {
  const State& state = context_.state;
  if (number >= exception::mem_manage && number <= exception::usage_fault)
    return state.scb.fault_enabled(number);
  return number < exception::first_interrupt || state.nvic.is_enabled(number);
}

unsigned PendingExceptions::highest_pending(int below) const {
  const Nvic& nvic = context_.state.nvic;
  unsigned best = 0;
  int best_priority = 256;
  for (uint64_t left = nvic.pending(); left != 0; left &= left - 1) {
    const unsigned number = static_cast<unsigned>(__builtin_ctzll(left));
    if (!enabled(number)) continue;
    const int priority = nvic.priority(number);
    if (priority < best_priority) {
      best = number;
      best_priority = priority;
    }
  }
  return best != 0 && context_.state.scb.group_priority(best_priority) < below ? best : 0;
}

bool PendingExceptions::wake_pending() const {
  const State& state = context_.state;
  if (state.sleeping_for_event && state.event_register) return true;
  return highest_pending(execution_priority(!state.sleeping_for_event)) != 0;
}

bool PendingExceptions::can_be_preempted() const {
  if (monitor_can_preempt()) return true;
  const int priority = execution_priority();
  for (unsigned number = exception::systick; number < exception::count; ++number) {
    const bool may_come =
        number == exception::systick ? context_.state.systick.may_pend() : enabled(number);
    if (may_come && group_priority(number) < priority) return true;
  }
  return false;
}

void PendingExceptions::pend(unsigned number) {
  State& state = context_.state;
  if (!state.nvic.is_pending(number)) {
    if (state.scb.sends_event_on_pend()) state.event_register = true;
    if (context_.listeners.pended) context_.listeners.pended(number);
  }
  state.nvic.set_pending(number, true);
  context_.requests.raise(Requests::changed);
}

void PendingExceptions::imprecise_bus_fault(const LostWrite& write) {
  Scb& scb = context_.state.scb;
  constexpr uint64_t waiting = uint64_t{1} << exception::bus_fault | 1u << exception::hard_fault;
  // One exception for all that fail before it is taken: it is for the first of them.
  if ((context_.state.nvic.pending() & waiting) == 0) context_.state.lost_write = write;
  scb.record_imprecise();
  const bool taken = enabled(exception::bus_fault);
  if (!taken) scb.record_forced();
  context_.state.nvic.set_pending(taken ? exception::bus_fault : exception::hard_fault, true);
  context_.requests.raise(Requests::changed);
}

bool PendingExceptions::monitor_can_preempt() const {
  return context_.state.scb.monitor_enabled() &&
         group_priority(exception::debug_monitor) < execution_priority();
}

void PendingExceptions::debug_event(Scb::DebugReason reason) {
  if (!monitor_can_preempt()) return;
  context_.state.scb.record(reason);
  context_.state.nvic.set_pending(exception::debug_monitor, true);
  context_.requests.raise(Requests::changed);
}

}  // namespace capsoc::armv7m
