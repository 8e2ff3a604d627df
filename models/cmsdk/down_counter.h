// A counter that steps down every `divisor` clock edges, as a function of the edge number.
#pragma once

#include <cstdint>
#include <limits>

#include "base/archive.h"

namespace capsoc::cmsdk {

/// Counts from its value to 0, stays there for one step and then takes `reload`; a one-shot counter
/// or one whose reload is 0 stays at 0. Plain arithmetic: nothing happens between calls, and edge
/// numbers never decrease from call to call.
class DownCounter {
 public:
  static constexpr uint64_t never = std::numeric_limits<uint64_t>::max();

  uint32_t reload = 0;
  bool one_shot = false;

  bool running() const { return running_; }
  /// The value at the last advance().
  uint32_t value() const { return value_; }
  /// The value at `cycle`, without moving.
  uint32_t value_at(uint64_t cycle) const;
  /// The first edge after the last advance() at which the counter steps from 1 to 0, or never.
  uint64_t next_zero() const;

  /// Moves to `cycle`; true if the counter reached 0 on the way, once or more.
  bool advance(uint64_t cycle);

  /// These act at the edge of the last advance(). A new value or divisor starts a whole step.
  void set_value(uint32_t value);
  void set_divisor(uint32_t divisor);
  void start();
  void stop() { running_ = false; }

  /// `now`: the edge at the archive's time; the last advance() cannot lie after it.
  void visit(Archive& archive, uint64_t now);

 private:
  uint64_t steps_until(uint64_t cycle) const;

  uint64_t present_ = 0;  // the edge of the last advance()
  uint64_t anchor_ = 0;   // the edge of the last step, from which the next one is counted
  uint32_t value_ = 0;
  uint32_t divisor_ = 1;
  bool running_ = false;
};

}  // namespace capsoc::cmsdk
