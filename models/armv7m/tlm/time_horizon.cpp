#include "armv7m/tlm/time_horizon.h"

#include <algorithm>

namespace capsoc::armv7m {

void TimeHorizon::set_pause(const sc_core::sc_time& time) {
  pause_at_ = time;
  set_bounds();
}

void TimeHorizon::look_ahead() {
  const sc_core::sc_time now = sc_core::sc_time_stamp();
  const sc_core::sc_time next = now + sc_core::sc_time_to_pending_activity();
  // After an access ahead of the kernel everything is as it was.
  if (has_bounds_ && now == looked_at_ && next == next_activity_) return;
  looked_at_ = now;
  next_activity_ = next;
  set_bounds();
}

/// What follows from the times, in cycles, which is what is compared at every access.
void TimeHorizon::set_bounds() {
  has_bounds_ = true;
  const sc_core::sc_time& first = std::min(next_activity_, pause_at_);
  late_from_ = first <= looked_at_ ? 0 : clock_.next_edge(first);
  limit_ = clock_.cycles_at(std::min(looked_at_ + quantum_, next_activity_));
  if (pause_at_ <= next_activity_) limit_ = std::min(limit_, clock_.next_edge(pause_at_));
  limit_ = std::max(limit_, clock_.cycles_at(looked_at_) + 1);
}

uint64_t TimeHorizon::begin_run(uint64_t longest) {
  end_of_run_ = std::min(limit_, core_.cycles() + longest);
  return end_of_run_;
}

void TimeHorizon::let_kernel_run(const sc_core::sc_time& time) {
  ++kernel_runs_;
  turn_.give_way();
  sc_core::wait(time);
}

/// If the end of the simulation is at this instant there is no next instruction: sc_stop() lets the
/// processes of its delta cycle run.
void TimeHorizon::settle() {
  if (!is_unsettled()) return;
  ++kernel_runs_;
  const SettlingTurn::Scope turn(turn_);
  while (is_unsettled()) let_kernel_run(sc_core::SC_ZERO_TIME);
}

void TimeHorizon::synchronise() {
  const sc_core::sc_time local = clock_.time_of(core_.cycles());
  const sc_core::sc_time now = sc_core::sc_time_stamp();
  if (local > now) let_kernel_run(local - now);
  settle();
}

void TimeHorizon::follow() {
  while (is_late()) {
    const sc_core::sc_time now = sc_core::sc_time_stamp();
    if (is_stopping() || pause_at_ <= next_activity_) return synchronise();
    if (next_activity_ > now) let_kernel_run(next_activity_ - now);
    settle();
    look_ahead();
  }
}

void TimeHorizon::catch_up() {
  const uint64_t cycle = clock_.cycles_at(sc_core::sc_time_stamp());
  if (cycle > core_.cycles()) core_.skip_to(cycle);
}

}  // namespace capsoc::armv7m
