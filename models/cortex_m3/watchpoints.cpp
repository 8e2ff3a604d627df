// What a debugger stops at. Nothing here is reached while no breakpoint and no watchpoint is set,
// neither by a debugger nor by the program in the DWT.
#include <algorithm>

#include "cortex_m3/core.h"

namespace capsoc::cortex_m3 {

void Core::set_breakpoint(uint32_t address) {
  breakpoints_.insert(address & ~1u);
  invalidate_code(address & ~1u, 2);  // blocks end before a breakpoint and none begins at one
  check_ = true;
}

void Core::pass_breakpoint() {
  breakpoint_passed_ = state_.instructions;
  passed_pc_ = state_.pc;
}

/// True once for every arrival at a breakpoint.
bool Core::at_breakpoint() {
  if (breakpoints_.count(state_.pc) == 0) return false;
  if (breakpoint_passed_ == state_.instructions && passed_pc_ == state_.pc) return false;
  pass_breakpoint();
  return true;
}

// Pages with a watched byte are missing in the views, so that every access to them takes the slow
// path; without watchpoints there is no view but the MPU's.
void Core::set_watchpoint(const Watchpoint& watchpoint) {
  watchpoints_.push_back(watchpoint);
  memory_.clear_views();
  select_view();
  check_ = true;
}

void Core::clear_watchpoint(const Watchpoint& watchpoint) {
  const auto found = std::find(watchpoints_.begin(), watchpoints_.end(), watchpoint);
  if (found == watchpoints_.end()) return;
  watchpoints_.erase(found);
  memory_.clear_views();
  select_view();
  check_ = true;
}

bool Core::watches_page(uint32_t address) const {
  const uint32_t page = address & ~(Memory::page_size - 1);
  if (state_.dwt.watches_data && dwt_watches_page(page)) return true;
  return std::any_of(watchpoints_.begin(), watchpoints_.end(), [page](const Watchpoint& w) {
    return w.address - page < Memory::page_size || page - w.address < w.size;
  });
}

/// Notes an access to a watched byte; the present instruction is the last one of the run then.
bool Core::watched(uint32_t address, unsigned size, bool write) {
  if (state_.dwt.watches_data) match_data(address, size, write);
  if (watch_stop_) return true;  // the first of an instruction counts
  for (const Watchpoint& w : watchpoints_) {
    if (!(write ? w.on_write : w.on_read)) continue;
    if (w.address - address >= size && address - w.address >= w.size) continue;
    watch_hit_ = {w, std::max(address, w.address)};
    watch_stop_ = check_ = true;
    return true;
  }
  return false;
}

}  // namespace capsoc::cortex_m3
