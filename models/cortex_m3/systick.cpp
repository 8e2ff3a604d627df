#include <algorithm>

#include "cortex_m3/core.h"

namespace capsoc::cortex_m3 {
namespace {
constexpr uint32_t enable = 1, tickint = 2, clksource = 4;
}

/// Ticks of the selected clock up to a cycle: the core clock, or the reference of some cycles each.
uint64_t Core::systick_tick(uint64_t cycle) const {
  return (state_.systick.csr & clksource) ? cycle : cycle / state_.systick.reference;
}

/// The counter at a cycle, and whether it went from 1 to 0 since it was last fixed (B3.3).
uint32_t Core::systick_value(uint64_t cycle, bool& wrapped) const {
  wrapped = false;
  if ((state_.systick.csr & enable) == 0 || cycle <= state_.systick.start_cycle)
    return state_.systick.start;
  uint64_t ticks = systick_tick(cycle) - systick_tick(state_.systick.start_cycle);
  if (ticks < state_.systick.start) return static_cast<uint32_t>(state_.systick.start - ticks);
  wrapped = state_.systick.start != 0;
  ticks -= state_.systick.start;
  if (ticks == 0 || state_.systick.rvr == 0) return 0;
  uint64_t period = uint64_t{state_.systick.rvr} + 1;
  wrapped = wrapped || ticks >= period;
  uint64_t phase = ticks % period;
  return phase == 0 ? 0 : static_cast<uint32_t>(period - phase);
}

void Core::systick_sync() {
  bool wrapped = false;
  uint64_t now = std::max(cycles(), state_.systick.start_cycle);
  state_.systick.start = systick_value(now, wrapped);
  state_.systick.start_cycle = now;
  state_.systick.countflag = state_.systick.countflag || wrapped;
}

void Core::systick_schedule() {
  state_.systick.event = never;
  if ((state_.systick.csr & (enable | tickint)) != (enable | tickint)) return;
  uint64_t ticks = state_.systick.start;
  if (ticks == 0) {
    if (state_.systick.rvr == 0) return;
    ticks = uint64_t{state_.systick.rvr} + 1;
  }
  uint64_t tick = systick_tick(state_.systick.start_cycle) + ticks;
  state_.systick.event = (state_.systick.csr & clksource) ? tick : tick * state_.systick.reference;
}

void Core::systick_expire() {
  // Exactly at the wrap, whatever cycle the instruction around it ended in.
  bool wrapped = false;
  state_.systick.start = systick_value(state_.systick.event, wrapped);
  state_.systick.start_cycle = state_.systick.event;
  state_.systick.countflag = true;
  pend(15);
  systick_schedule();
}

void Core::set_systick_reference(unsigned cycles_a_tick) {
  systick_sync();
  state_.systick.reference = std::max(1u, cycles_a_tick);
  systick_schedule();
}

}  // namespace capsoc::cortex_m3
