#include <algorithm>

#include "cortex_m3/core.h"

namespace capsoc::cortex_m3 {
namespace {
constexpr uint32_t enable = 1, tickint = 2, clksource = 4;
}

/// Ticks of the selected clock up to a cycle: the core clock, or the reference of some cycles each.
uint64_t Core::systick_tick(uint64_t cycle) const {
  return (systick_csr_ & clksource) ? cycle : cycle / systick_reference_;
}

/// The counter at a cycle, and whether it went from 1 to 0 since it was last fixed (B3.3).
uint32_t Core::systick_value(uint64_t cycle, bool& wrapped) const {
  wrapped = false;
  if ((systick_csr_ & enable) == 0 || cycle <= systick_start_cycle_) return systick_start_;
  uint64_t ticks = systick_tick(cycle) - systick_tick(systick_start_cycle_);
  if (ticks < systick_start_) return static_cast<uint32_t>(systick_start_ - ticks);
  wrapped = systick_start_ != 0;
  ticks -= systick_start_;
  if (ticks == 0 || systick_rvr_ == 0) return 0;
  uint64_t period = uint64_t{systick_rvr_} + 1;
  wrapped = wrapped || ticks >= period;
  uint64_t phase = ticks % period;
  return phase == 0 ? 0 : static_cast<uint32_t>(period - phase);
}

void Core::systick_sync() {
  bool wrapped = false;
  uint64_t now = std::max(cycles(), systick_start_cycle_);
  systick_start_ = systick_value(now, wrapped);
  systick_start_cycle_ = now;
  systick_countflag_ = systick_countflag_ || wrapped;
}

void Core::systick_schedule() {
  systick_event_ = never;
  if ((systick_csr_ & (enable | tickint)) != (enable | tickint)) return;
  uint64_t ticks = systick_start_;
  if (ticks == 0) {
    if (systick_rvr_ == 0) return;
    ticks = uint64_t{systick_rvr_} + 1;
  }
  uint64_t tick = systick_tick(systick_start_cycle_) + ticks;
  systick_event_ = (systick_csr_ & clksource) ? tick : tick * systick_reference_;
}

void Core::systick_expire() {
  // Exactly at the wrap, whatever cycle the instruction around it ended in.
  bool wrapped = false;
  systick_start_ = systick_value(systick_event_, wrapped);
  systick_start_cycle_ = systick_event_;
  systick_countflag_ = true;
  pend(15);
  systick_schedule();
}

void Core::set_systick_reference(unsigned cycles_a_tick) {
  systick_sync();
  systick_reference_ = std::max(1u, cycles_a_tick);
  systick_schedule();
}

}  // namespace capsoc::cortex_m3
