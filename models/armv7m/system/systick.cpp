#include "armv7m/system/systick.h"

#include <algorithm>

#include "base/archive.h"

namespace capsoc::armv7m {
namespace {
constexpr uint32_t csr_enable = 1, csr_tickint = 2, csr_clksource = 4, csr_countflag = 1u << 16;
}

void Systick::reset(uint64_t now) {
  const unsigned reference = reference_;
  *this = {};
  reference_ = reference;
  start_cycle_ = now;
}

void Systick::visit(Archive& archive) {
  archive("csr", csr_);
  archive("rvr", rvr_);
  archive("start", start_);
  archive("countflag", countflag_);
  archive("start_cycle", start_cycle_);
  archive("event", event_);
  archive("reference", reference_);
  if (reference_ == 0) archive.refuse("has a reference clock that stands still");
}

/// Ticks of the selected clock up to a cycle: the core clock, or the reference of some cycles each.
uint64_t Systick::tick(uint64_t cycle) const {
  return (csr_ & csr_clksource) != 0 ? cycle : cycle / reference_;
}

/// The counter at a cycle, and whether it went from 1 to 0 since it was last fixed.
uint32_t Systick::value(uint64_t cycle, bool& wrapped) const {
  wrapped = false;
  if ((csr_ & csr_enable) == 0 || cycle <= start_cycle_) return start_;
  uint64_t ticks = tick(cycle) - tick(start_cycle_);
  if (ticks < start_) return static_cast<uint32_t>(start_ - ticks);
  wrapped = start_ != 0;
  ticks -= start_;
  if (ticks == 0 || rvr_ == 0) return 0;
  const uint64_t period = uint64_t{rvr_} + 1;
  wrapped = wrapped || ticks >= period;
  const uint64_t phase = ticks % period;
  return phase == 0 ? 0 : static_cast<uint32_t>(period - phase);
}

void Systick::fix(uint64_t now) {
  bool wrapped = false;
  const uint64_t at = std::max(now, start_cycle_);
  start_ = value(at, wrapped);
  start_cycle_ = at;
  countflag_ = countflag_ || wrapped;
}

void Systick::schedule() {
  event_ = never;
  if (!may_pend()) return;
  uint64_t ticks = start_;
  if (ticks == 0) {
    if (rvr_ == 0) return;
    ticks = uint64_t{rvr_} + 1;
  }
  const uint64_t due = tick(start_cycle_) + ticks;
  event_ = (csr_ & csr_clksource) != 0 ? due : due * reference_;
}

void Systick::expire() {
  // Exactly at the wrap, whatever cycle the instruction around it ended in.
  bool wrapped = false;
  start_ = value(event_, wrapped);
  start_cycle_ = event_;
  countflag_ = true;
  schedule();
}

void Systick::set_reference(uint64_t now, unsigned cycles_a_tick) {
  fix(now);
  reference_ = std::max(1u, cycles_a_tick);
  schedule();
}

bool Systick::may_pend() const {
  return (csr_ & (csr_enable | csr_tickint)) == (csr_enable | csr_tickint);
}

uint32_t Systick::read(uint32_t address, uint64_t now) const {
  bool wrapped = false;
  const uint32_t counter = value(now, wrapped);
  switch (address) {
    case ppb::SYST_CSR:
      return csr_ | (countflag_ || wrapped ? csr_countflag : 0);
    case ppb::SYST_RVR:
      return rvr_;
    case ppb::SYST_CVR:
      return counter;
    default:
      return 0;
  }
}

void Systick::write(const SystemRegister& target, const LaneWrite& write, uint64_t now) {
  fix(now);
  switch (target.address()) {
    case ppb::SYST_CSR:
      csr_ = write.over(csr_, target);
      break;
    case ppb::SYST_RVR:
      rvr_ = write.over(rvr_, target);
      break;
    case ppb::SYST_CVR:  // any write clears it
      start_ = 0;
      countflag_ = false;
      break;
    default:
      break;
  }
  schedule();
}

void Systick::csr_read(uint64_t now, bool countflag) {
  fix(now);
  if (countflag) countflag_ = false;
  schedule();
}

}  // namespace capsoc::armv7m
