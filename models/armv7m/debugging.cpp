#include "armv7m/debugging.h"

namespace capsoc::armv7m {

void Debugging::set_breakpoint(uint32_t address) {
  breakpoints_.insert(address & ~1u);
  // Blocks end before a breakpoint and none begins at one.
  memory_.invalidate_code(address & ~1u, 2);
  context_.requests.raise(Requests::changed);
}

void Debugging::pass_breakpoint() {
  passed_at_ = context_.state.instructions;
  passed_pc_ = context_.state.pc;
}

void Debugging::forget_arrival() {
  passed_at_ = State::never;
}

bool Debugging::at_breakpoint() {
  if (breakpoints_.count(context_.state.pc) == 0) return false;
  if (passed_at_ == context_.state.instructions && passed_pc_ == context_.state.pc) return false;
  pass_breakpoint();
  return true;
}

void Debugging::show_stimulus(uint32_t ports, bool on) {
  stimulus_ports_ = on ? stimulus_ports_ | ports : stimulus_ports_ & ~ports;
  if (!on) context_.state.itm.disable(ports);
  traces_ = traces_ || on;
  set_up_trace();
}

void Debugging::set_up_trace() {
  if (!traces_) return;
  context_.state.itm.enable(stimulus_ports_);
  system_.enable_tracing();
}

// Pages with a watched byte are missing in the views, so that every access to them takes the slow
// path; without watchpoints there is no view but the MPU's.
void Debugging::set_watchpoint(const Watchpoint& watchpoint) {
  watchpoints_.add(watchpoint);
  memory_.views_changed();
}

void Debugging::clear_watchpoint(const Watchpoint& watchpoint) {
  if (watchpoints_.remove(watchpoint)) memory_.views_changed();
}

}  // namespace capsoc::armv7m
