#include "cortex_m3/debugging.h"

#include <algorithm>

#include "cortex_m3/machine.h"

namespace capsoc::cortex_m3 {

void Debugging::set_breakpoint(uint32_t address) {
  breakpoints_.insert(address & ~1u);
  // Blocks end before a breakpoint and none begins at one.
  machine_.memory.invalidate_code(address & ~1u, 2);
  machine_.requests.raise(Requests::changed);
}

void Debugging::pass_breakpoint() {
  passed_at_ = machine_.state.instructions;
  passed_pc_ = machine_.state.pc;
}

void Debugging::forget_arrival() {
  passed_at_ = State::never;
}

bool Debugging::at_breakpoint() {
  if (breakpoints_.count(machine_.state.pc) == 0) return false;
  if (passed_at_ == machine_.state.instructions && passed_pc_ == machine_.state.pc) return false;
  pass_breakpoint();
  return true;
}

uint32_t Debugging::control_and_status() const {
  constexpr uint32_t c_debugen = 1, c_halt = 1u << 1, s_regrdy = 1u << 16, s_halt = 1u << 17;
  if (!halting_) return 0;
  return halted_ ? c_debugen | c_halt | s_regrdy | s_halt : c_debugen;
}

void Debugging::show_stimulus(uint32_t ports, bool on) {
  stimulus_ports_ = on ? stimulus_ports_ | ports : stimulus_ports_ & ~ports;
  if (!on) machine_.state.itm.disable(ports);
  traces_ = traces_ || on;
  set_up_trace();
}

void Debugging::set_up_trace() {
  if (!traces_) return;
  machine_.state.itm.enable(stimulus_ports_);
  machine_.system.enable_tracing();
}

// Pages with a watched byte are missing in the views, so that every access to them takes the slow
// path; without watchpoints there is no view but the MPU's.
void Debugging::set_watchpoint(const Watchpoint& watchpoint) {
  watchpoints_.push_back(watchpoint);
  machine_.memory.views_changed();
}

void Debugging::clear_watchpoint(const Watchpoint& watchpoint) {
  const auto found = std::find(watchpoints_.begin(), watchpoints_.end(), watchpoint);
  if (found == watchpoints_.end()) return;
  watchpoints_.erase(found);
  machine_.memory.views_changed();
}

bool Debugging::watches_data() const {
  return !watchpoints_.empty() || machine_.state.dwt.watches_data();
}

bool Debugging::watches_page(uint32_t address) const {
  const uint32_t page = address & ~(Memory::page_size - 1);
  const Dwt& dwt = machine_.state.dwt;
  if (dwt.watches_data() && dwt.watches_page(page, Memory::page_size)) return true;
  return std::any_of(watchpoints_.begin(), watchpoints_.end(), [page](const Watchpoint& w) {
    return w.address - page < Memory::page_size || page - w.address < w.size;
  });
}

bool Debugging::watched(uint32_t address, unsigned size, bool write) {
  Dwt& dwt = machine_.state.dwt;
  const bool matches = dwt.watches_data() && dwt.match_data(address, size, write);
  if (matches) machine_.exceptions.debug_event(Scb::DebugReason::dwttrap);
  if (machine_.requests.has(Requests::watchpoint))
    return true;  // the first of an instruction counts
  for (const Watchpoint& w : watchpoints_) {
    if (!(write ? w.on_write : w.on_read)) continue;
    if (w.address - address >= size && address - w.address >= w.size) continue;
    watch_hit_ = {w, std::max(address, w.address)};
    machine_.requests.raise(Requests::watchpoint);
    return true;
  }
  return matches;
}

}  // namespace capsoc::cortex_m3
