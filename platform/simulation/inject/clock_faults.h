// Faults of the coprocessor's clock: edges that do not come.
#pragma once

#include <vector>

#include "inject/stream_faults.h"

namespace capsoc::inject {

/// One edge, or all of some time. They act between two instructions. A fault lasts until the
/// pipeline is empty after it: until then results come later than they would.
class ClockFaults {
 public:
  /// The faults and the position outlive this.
  explicit ClockFaults(const Position& position) : position_(position) {}
  static bool takes(const Fault& fault) { return fault.kind == Fault::Kind::lose_clock; }
  void add(Injected& injected) { faults_.push_back({&injected}); }

  /// Those that have not begun.
  std::vector<const Injected*> waiting() const;
  /// When one that has begun is to be looked at again; sc_max_time(): never.
  sc_core::sc_time next() const;
  /// Between two instructions: begins and ends those whose instant has come.
  void pause(const sc_core::sc_time& now);

 private:
  struct OnClock {
    Injected* injected;
    bool stops = false;  ///< the clock, for some time that lasts
  };
  void begin(OnClock& each) const;

  const Position& position_;
  std::vector<OnClock> faults_;
};

}  // namespace capsoc::inject
