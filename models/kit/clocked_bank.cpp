#include "kit/clocked_bank.h"

namespace capsoc::kit {
ClockedBank::ClockedBank(const sc_core::sc_module_name& name, ClockDomain& clock)
    : RegisterBank(name, device_size, AccessRule::any_width, Holes::reads_zero), clock_(clock) {
  sc_core::sc_spawn_options options;
  options.spawn_method();
  options.dont_initialize();
  options.set_sensitivity(&event_);
  sc_core::sc_spawn([this] { on_event(); }, sc_core::sc_gen_unique_name("on_event"), &options);
  clock_.on_change([this] { on_clock_change(); });
}

void ClockedBank::plan() {
  const uint64_t next = next_change();
  if (next == planned_) return;
  planned_ = next;
  note_event();
  event_.cancel();
  if (next == never) return;
  const sc_core::sc_time at = clock_.time_of(next);
  if (at == sc_core::sc_max_time()) return;  // beyond the end of time at this frequency
  const sc_core::sc_time present = sc_core::sc_time_stamp();
  event_.notify(at > present ? at - present : sc_core::SC_ZERO_TIME);
}

void ClockedBank::on_event() {
  planned_ = never;
  advance(now());
  plan();
}

void ClockedBank::on_clock_change() {
  planned_ = never;
  event_.cancel();
  plan();
}

bool ClockedBank::read_word(uint32_t offset, uint32_t& value, bool debug) {
  if (debug) return RegisterBank::read_word(offset, value, true);
  advance(now());
  const bool answered = RegisterBank::read_word(offset, value, false);
  plan();
  return answered;
}

bool ClockedBank::write_word(uint32_t offset, uint32_t value, uint32_t lanes) {
  advance(now());
  const bool answered = RegisterBank::write_word(offset, value, lanes);
  plan();
  return answered;
}

void ClockedBank::restored() {
  on_clock_change();
}

}  // namespace capsoc::kit
