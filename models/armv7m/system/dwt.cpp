// Nothing is looked at while no comparator and no step is set. Watched data leave the direct
// tables, as a debugger's watchpoints do; instruction and cycle matches and MON_STEP let the
// stepping executor do the work. A match is taken after the instruction that made it.
#include "armv7m/system/dwt.h"

#include "armv7m/profile.h"
#include "base/archive.h"

namespace capsoc::armv7m {
namespace {

constexpr uint32_t matched = 1u << 24, cycmatch = 1u << 7;
constexpr uint32_t largest_mask = 15;  // address bits that can be ignored
constexpr uint32_t in_comp = 0, in_mask = 4, in_function = 8;

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
bool in_comparators(uint32_t address) {
  return address - ppb::DWT_COMP0 < 16 * Dwt::comparators;
}
uint32_t comparator_at(uint32_t address) {
  return (address - ppb::DWT_COMP0) / 16;
}

}  // namespace

bool Dwt::is_function(uint32_t address) {
  return in_comparators(address) && (address & 0xC) == in_function;
}

void Dwt::reset() {
  *this = {};
}

void Dwt::visit(Archive& archive) {
  archive("ctrl", ctrl_);
  archive("cyccnt_base", cyccnt_base_);
  archive("cyccnt_stopped", cyccnt_stopped_);
  archive("comparator", comparator_);
  archive("mask", mask_);
  archive("function", function_);
  archive("count_seen", count_seen_);
}

uint32_t Dwt::cycle_count(uint64_t now, bool tracing) const {
  const bool runs = (ctrl_ & 1) != 0 && tracing;
  return runs ? static_cast<uint32_t>(now - cyccnt_base_) : cyccnt_stopped_;
}

void Dwt::set_cycle_count(uint64_t now, uint32_t count) {
  cyccnt_stopped_ = count;
  cyccnt_base_ = now - count;
}

void Dwt::select(uint64_t now, bool tracing, bool steps) {
  restored(tracing, steps);
  count_seen_ = cycle_count(now, tracing);
}

void Dwt::restored(bool tracing, bool steps) {
  watches_data_ = false;
  observes_steps_ = steps;
  for (const uint32_t function : function_) {
    watches_data_ = watches_data_ || (tracing && compares_data(function));
    observes_steps_ = observes_steps_ || (tracing && compares_steps(function));
  }
}

bool Dwt::match_step(uint32_t executed, uint64_t now, bool tracing) {
  const uint32_t count = cycle_count(now, tracing), passed = count - count_seen_;
  bool any = false;
  for (unsigned n = 0; n < comparators; ++n) {
    if (!compares_steps(function_[n]) || !tracing) continue;
    const uint32_t ignored = (1u << mask_[n]) - 1;
    const bool hit = (function_[n] & cycmatch) != 0
                         ? count - comparator_[n] < passed
                         : ((executed ^ comparator_[n]) & ~ignored & ~1u) == 0;
    if (!hit) continue;
    function_[n] |= matched;
    any = true;
  }
  count_seen_ = count;
  return any;
}

bool Dwt::match_data(uint32_t address, unsigned size, bool write) {
  bool any = false;
  for (unsigned n = 0; n < comparators; ++n) {
    const uint32_t function = function_[n];
    if (!compares_data(function) || function_of(function) == (write ? on_read : on_write)) continue;
    const uint32_t ignored = (1u << mask_[n]) - 1, first = comparator_[n] & ~ignored;
    if (first - address >= size && address - first > ignored) continue;
    function_[n] |= matched;
    any = true;
  }
  return any;
}

bool Dwt::watches_page(uint32_t page, uint32_t page_size) const {
  for (unsigned n = 0; n < comparators; ++n) {
    if (!compares_data(function_[n])) continue;
    const uint32_t ignored = (1u << mask_[n]) - 1, first = comparator_[n] & ~ignored;
    if (first - page < page_size || page - first <= ignored) return true;
  }
  return false;
}

uint32_t Dwt::read(uint32_t address, uint64_t now, bool tracing) const {
  if (address == ppb::DWT_CTRL) return armv7m_registers.at(address).description.reset | ctrl_;
  if (address == ppb::DWT_CYCCNT) return cycle_count(now, tracing);
  const uint32_t n = comparator_at(address);
  switch (address & 0xC) {
    case in_comp:
      return comparator_[n];
    case in_mask:
      return mask_[n];
    case in_function:
      return function_[n];
    default:
      return 0;
  }
}

void Dwt::matched_read(uint32_t address) {
  function_[comparator_at(address)] &= ~matched;
}

void Dwt::write(uint32_t address, const LaneWrite& write, uint64_t now, bool tracing) {
  if (!in_comparators(address)) {
    const uint32_t count = cycle_count(now, tracing);
    const bool counter = address == ppb::DWT_CYCCNT;
    if (!counter) ctrl_ = write.over(ctrl_, armv7m_registers.at(address));
    return set_cycle_count(now, counter ? write.over(count) : count);
  }
  const uint32_t n = comparator_at(address);
  switch (address & 0xC) {
    case in_comp:
      comparator_[n] = write.over(comparator_[n]);
      break;
    case in_mask:
      mask_[n] = write.over(mask_[n]) & largest_mask;
      break;
    case in_function:  // the first one alone can compare cycles
      function_[n] =
          (function_[n] & matched) | (write.over(function_[n]) & (0xF | (n == 0 ? cycmatch : 0)));
      break;
    default:
      break;
  }
}

}  // namespace capsoc::armv7m
