#include "armv7m/watchpoints.h"

#include <algorithm>

#include "armv7m/memory/memory.h"

namespace capsoc::armv7m {

bool Watchpoints::remove(const Watchpoint& watchpoint) {
  const auto found = std::find(watchpoints_.begin(), watchpoints_.end(), watchpoint);
  if (found == watchpoints_.end()) return false;
  watchpoints_.erase(found);
  return true;
}

bool Watchpoints::watches_data() const {
  return !watchpoints_.empty() || context_.state.dwt.watches_data();
}

bool Watchpoints::watches_page(uint32_t address, bool write) const {
  const uint32_t page = address & ~(Memory::page_size - 1);
  const Dwt& dwt = context_.state.dwt;
  if (dwt.watches_data() && dwt.watches_page(page, Memory::page_size)) return true;
  return std::any_of(watchpoints_.begin(), watchpoints_.end(), [page, write](const Watchpoint& w) {
    return (write ? w.on_write : w.on_read) &&
           (w.address - page < Memory::page_size || page - w.address < w.size);
  });
}

bool Watchpoints::watched(uint32_t address, unsigned size, bool write) {
  Dwt& dwt = context_.state.dwt;
  const bool matches = dwt.watches_data() && dwt.match_data(address, size, write);
  if (matches) pending_.debug_event(Scb::DebugReason::dwttrap);
  if (context_.requests.has(Requests::watchpoint))
    return true;  // the first of an instruction counts
  for (const Watchpoint& w : watchpoints_) {
    if (!(write ? w.on_write : w.on_read)) continue;
    if (w.address - address >= size && address - w.address >= w.size) continue;
    watch_hit_ = {w, std::max(address, w.address)};
    context_.requests.raise(Requests::watchpoint);
    return true;
  }
  return matches;
}

}  // namespace capsoc::armv7m
