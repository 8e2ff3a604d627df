#include "armv7m/tlm/sleep.h"

#include <algorithm>

namespace capsoc::armv7m {

void Sleep::note_work() {
  // The core may be ahead of the kernel. It lags only after a change to a faster clock.
  if (end_on_idle_)
    end_on_idle_->begin(std::max(clock_.time_of(core_.cycles()), sc_core::sc_time_stamp()));
}

void Sleep::visit(Archive& archive) {
  bool watched = end_on_idle_.has_value();
  archive("ends_on_idle", watched);
  if (watched != end_on_idle_.has_value())
    return archive.refuse("is of a run with another end_on_idle");
  if (end_on_idle_) archive("end_on_idle", *end_on_idle_);
}

EndReason Sleep::until_woken() {
  if (end_on_idle_) end_on_idle_->fall_asleep(sc_core::sc_time_stamp());
  const EndReason reason = sleep();
  if (end_on_idle_) end_on_idle_->wake_up(sc_core::sc_time_stamp());
  return reason;
}

EndReason Sleep::sleep() {
  while (!core_.wake_pending() && !client_.must_wake()) {
    const sc_core::sc_time now = sc_core::sc_time_stamp();
    if (end_on_idle_ && end_on_idle_->is_over(now)) return EndReason::end_on_idle;
    if (horizon_.pause_at() <= now) {  // it fell asleep at the instant of the pause
      client_.pause_if_due();
      continue;
    }
    if (!wait_for_something(now)) return EndReason::none;
    horizon_.settle();
    horizon_.catch_up();
    if (client_.is_interrupted()) return EndReason::interrupted;
    // What was slept so far counts.
    if (end_on_idle_ && horizon_.pause_at() <= sc_core::sc_time_stamp())
      end_on_idle_->wake_up(sc_core::sc_time_stamp());
    client_.pause_if_due();
    if (client_.debugger_wants_attention()) break;
  }
  return EndReason::none;
}

/// Waits for what can come next. False: nothing can, and the debugger takes over.
bool Sleep::wait_for_something(const sc_core::sc_time& now) {
  const sc_core::sc_time longest_nap(1, sc_core::SC_MS);  // with a debugger
  horizon_.give_way();
  sc_core::sc_time nap =
      end_on_idle_ ? end_on_idle_->deadline() - now : sc_core::sc_max_time() - now;
  if (horizon_.pause_at() > now && horizon_.pauses())
    nap = std::min(nap, horizon_.pause_at() - now);
  const uint64_t internal = core_.next_internal_event();
  if (internal != Core::never) {
    const sc_core::sc_time until = clock_.time_of(internal);
    if (client_.debugger_looks()) nap = std::min(nap, longest_nap);
    if (until > now) sc_core::wait(std::min(until - now, nap), wake_);
    return true;
  }
  const bool is_pending = client_.has_debugger() && sc_core::sc_pending_activity();
  if (is_pending && client_.debugger_looks()) {
    sc_core::wait(std::min(nap, longest_nap), wake_);
    return true;
  }
  if (client_.has_debugger() && !is_pending && client_.debugger_takes_over()) return false;
  // The host may still wake it through a channel that the kernel waits for, and only the kernel
  // knows whether there is one: so this does not stop the simulation, sc_start() returns.
  const bool goes_on = expects_inputs_ || sc_core::sc_pending_activity();
  only_woken_ = !end_on_idle_ && !(horizon_.pauses() && goes_on);
  if (only_woken_)
    sc_core::wait(wake_);
  else
    sc_core::wait(nap, wake_);
  only_woken_ = false;
  return true;
}

}  // namespace capsoc::armv7m
