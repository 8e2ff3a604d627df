#pragma once

#include <cstdint>

#include "armv7m/system/registers.h"

namespace capsoc {
class Archive;
}

namespace capsoc::armv7m {

/// The system timer (B3.3). Its counter is a function of the cycles since its start, so no event
/// per tick is needed. `now` is the processor's cycle.
class Systick {
 public:
  static constexpr uint64_t never = ~uint64_t{0};

  void reset(uint64_t now);
  void visit(Archive& archive);

  /// Cycle of the next wrap that pends the exception, else `never`.
  uint64_t event() const { return event_; }
  /// At event(): the counter wraps, and the next event is planned.
  void expire();
  /// HCLK cycles of the reference clock (25 at reset), at least 1.
  void set_reference(uint64_t now, unsigned cycles_a_tick);
  /// The counter runs, and its wrap pends the exception.
  bool may_pend() const;

  uint32_t read(uint32_t address, uint64_t now) const;
  void write(const SystemRegister& target, const LaneWrite& write, uint64_t now);
  /// Call after a read of SYST_CSR, which clears COUNTFLAG.
  void csr_read(uint64_t now, bool countflag);

 private:
  uint64_t tick(uint64_t cycle) const;
  uint32_t value(uint64_t cycle, bool& wrapped) const;
  void fix(uint64_t now);
  void schedule();

  uint32_t csr_ = 0, rvr_ = 0, start_ = 0;
  bool countflag_ = false;
  uint64_t start_cycle_ = 0;
  uint64_t event_ = never;
  unsigned reference_ = 25;
};

}  // namespace capsoc::armv7m
