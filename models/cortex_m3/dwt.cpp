// The Data Watchpoint and Trace unit and the DebugMonitor's register (ARM DDI 0403, C1.6 and C1.8):
// the cycle counter and four comparators whose matches set MATCHED and go to the DebugMonitor
// exception. Packets, the profiling counters and data value comparison are absent and read as zero;
// so is the whole FPB, which says that it has no comparators.
//
// Nothing is looked at while no comparator and no step is set. Watched data leave the direct
// tables, as a debugger's watchpoints do; instruction and cycle matches and MON_STEP let the
// stepping executor do the work. A match is taken behind the instruction that made it.
#include "cortex_m3/core.h"

namespace capsoc::cortex_m3 {
namespace {

constexpr uint32_t first_comparator = 0xE0001020, ctrl = 0xE0001000;
constexpr uint32_t trcena = 1u << 24, mon_en = 1u << 16, mon_pend = 1u << 17, mon_step = 1u << 18,
                   mon_req = 1u << 19, vector_catches = 0x7F1;
constexpr uint32_t dfsr_halted = 1, dfsr_dwttrap = 4;
constexpr uint32_t matched = 1u << 24, cycmatch = 1u << 7;
constexpr uint32_t largest_mask = 15;  // address bits that can be ignored
constexpr unsigned debug_monitor = 12;

/// What FUNCTION[3:0] compares and does (C1.8.17); the rest makes packets or signals.
enum Function : uint32_t { on_instruction = 4, on_read = 5, on_write = 6, on_access = 7 };

uint32_t function_of(uint32_t reg) {
  return reg & 0xF;
}
bool compares_data(uint32_t reg) {
  return (reg & cycmatch) == 0 && function_of(reg) >= on_read && function_of(reg) <= on_access;
}
bool compares_steps(uint32_t reg) {
  return function_of(reg) == on_instruction;
}

}  // namespace

bool Core::in_dwt_comparators(uint32_t address) {
  return address - first_comparator < 4 * 16;
}

uint32_t Core::cycle_count() const {
  const bool runs = (state_.dwt.ctrl & 1) != 0 && (state_.scb.demcr & trcena) != 0;
  return runs ? static_cast<uint32_t>(cycles() - state_.dwt.cyccnt_base)
              : state_.dwt.cyccnt_stopped;
}

uint32_t Core::dwt_read(uint32_t address) const {
  const uint32_t n = (address - first_comparator) / 16;
  switch (address & 0xC) {
    case 0:
      return state_.dwt.comparator[n];
    case 4:
      return state_.dwt.mask[n];
    case 8:
      return state_.dwt.function[n];
    default:
      return 0;
  }
}

/// DWT_CTRL, DWT_CYCCNT and the comparators.
void Core::dwt_write(uint32_t address, uint32_t value, uint32_t mask) {
  const auto merge = [&](uint32_t old) { return (old & ~mask) | (value & mask); };
  if (!in_dwt_comparators(address)) {
    const uint32_t count = address == ctrl ? cycle_count() : merge(cycle_count());
    if (address == ctrl) state_.dwt.ctrl = merge(state_.dwt.ctrl) & 1;
    state_.dwt.cyccnt_stopped = count;
    state_.dwt.cyccnt_base = cycles() - count;
    return select_dwt();
  }
  const uint32_t n = (address - first_comparator) / 16;
  switch (address & 0xC) {
    case 0:
      state_.dwt.comparator[n] = merge(state_.dwt.comparator[n]);
      break;
    case 4:
      state_.dwt.mask[n] = merge(state_.dwt.mask[n]) & largest_mask;
      break;
    case 8:  // the first one alone can compare cycles
      state_.dwt.function[n] = (state_.dwt.function[n] & matched) |
                               (merge(state_.dwt.function[n]) & (0xF | (n == 0 ? cycmatch : 0)));
      break;
    default:
      break;
  }
  select_dwt();
}

/// MON_PEND is the pending state itself, whatever MON_EN says. The vector catches are a halting
/// debugger's.
void Core::write_demcr(uint32_t value) {
  const uint32_t count = cycle_count();
  state_.scb.demcr = value & (trcena | mon_en | mon_step | mon_req | vector_catches);
  state_.dwt.cyccnt_stopped = count;
  state_.dwt.cyccnt_base = cycles() - count;
  if ((value & mon_pend) != 0) {
    pend(debug_monitor);
  } else {
    state_.nvic.pending &= ~(uint64_t{1} << debug_monitor);
  }
  select_dwt();
}

/// What has to be looked at, from the registers.
void Core::select_dwt() {
  const bool on = (state_.scb.demcr & trcena) != 0;
  state_.dwt.watches_data = false;
  state_.dwt.observes_step = (state_.scb.demcr & (mon_en | mon_step)) == (mon_en | mon_step);
  for (const uint32_t function : state_.dwt.function) {
    state_.dwt.watches_data = state_.dwt.watches_data || (on && compares_data(function));
    state_.dwt.observes_step = state_.dwt.observes_step || (on && compares_steps(function));
  }
  state_.dwt.count_seen = cycle_count();
  memory_.clear_views();
  check_ = true;
}

/// One instruction while a step, an instruction or a cycle is waited for.
void Core::step_observed() {
  constexpr uint32_t stepping = mon_en | mon_step;
  const bool steps = (state_.scb.demcr & stepping) == stepping && monitor_can_preempt();
  const uint32_t executed = state_.pc;
  step();
  match_step(executed);
  if (!steps) return;
  state_.scb.dfsr |= dfsr_halted;
  pend(debug_monitor);
}

void Core::match_step(uint32_t executed) {
  const uint32_t count = cycle_count(), passed = count - state_.dwt.count_seen;
  for (unsigned n = 0; n < 4; ++n) {
    uint32_t& function = state_.dwt.function[n];
    if (!compares_steps(function) || (state_.scb.demcr & trcena) == 0) continue;
    const uint32_t ignored = (1u << state_.dwt.mask[n]) - 1;
    const bool hit = (function & cycmatch) != 0
                         ? count - state_.dwt.comparator[n] < passed
                         : ((executed ^ state_.dwt.comparator[n]) & ~ignored & ~1u) == 0;
    if (!hit) continue;
    function |= matched;
    debug_event(dfsr_dwttrap);
  }
  state_.dwt.count_seen = count;
}

void Core::match_data(uint32_t address, unsigned size, bool write) {
  for (unsigned n = 0; n < 4; ++n) {
    uint32_t& function = state_.dwt.function[n];
    if (!compares_data(function) || function_of(function) == (write ? on_read : on_write)) continue;
    const uint32_t ignored = (1u << state_.dwt.mask[n]) - 1,
                   first = state_.dwt.comparator[n] & ~ignored;
    if (first - address >= size && address - first > ignored) continue;
    function |= matched;
    debug_event(dfsr_dwttrap);
  }
}

/// `page`: its first address. A mask reaches beyond one page at most by whole pages.
bool Core::dwt_watches_page(uint32_t page) const {
  for (unsigned n = 0; n < 4; ++n) {
    if (!compares_data(state_.dwt.function[n])) continue;
    const uint32_t ignored = (1u << state_.dwt.mask[n]) - 1,
                   first = state_.dwt.comparator[n] & ~ignored;
    if (first - page < Memory::page_size || page - first <= ignored) return true;
  }
  return false;
}

}  // namespace capsoc::cortex_m3
