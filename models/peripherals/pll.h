#pragma once

#include <cstdint>

#include "base/archive.h"

namespace capsoc::peripherals {

/// The PLL and the clock switch as states, without time: the owner says when the lock is reached.
class Pll {
 public:
  static constexpr uint64_t reference_hz = 25'000'000;
  static constexpr uint64_t minimum_hz = 1'000'000;
  static constexpr uint64_t maximum_hz = 200'000'000;

  /// Whether reference_hz * multiplier / divider lies within the limits.
  static bool legal(uint32_t multiplier, uint32_t divider);

  /// False, and nothing changes, if the ratio is illegal. Another ratio loses the lock.
  bool set_ratio(uint32_t multiplier, uint32_t divider);

  /// Off loses the lock.
  void enable(bool on);
  void select(bool on) { select_ = on; }

  /// The lock time has passed. Without effect while the PLL is off.
  void lock() { locked_ = enabled_; }

  bool enabled() const { return enabled_; }
  bool locked() const { return locked_; }

  /// Whether the PLL drives the output of the switch; otherwise the reference does.
  bool drives_output() const { return locked_ && select_; }

  /// Frequency after the switch, in Hz; a fraction is cut off.
  uint64_t output_hz() const;

  void visit(Archive& archive);

 private:
  uint32_t multiplier_ = 1;
  uint32_t divider_ = 1;
  bool enabled_ = false;
  bool select_ = false;
  bool locked_ = false;
};

}  // namespace capsoc::peripherals
