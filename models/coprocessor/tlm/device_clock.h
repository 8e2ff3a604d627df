// PCLK as the coprocessor's device gets it.
#pragma once

#include <cstdint>
#include <systemc>

#include "kit/clock_domain.h"

namespace capsoc::coprocessor {

/// Edges of a clock domain without those that a fault takes away. Edge numbers are those that the
/// device has seen: after an edge that was lost they are less than the domain's, until catch_up().
class DeviceClock {
 public:
  /// The domain must outlive this.
  explicit DeviceClock(const kit::ClockDomain& domain) : domain_(domain) {}

  /// Number of the device's last edge at or before `time`, which is not before the last stop().
  uint64_t cycles_at(const sc_core::sc_time& time) const {
    if (stops_ != 0) return frozen_;
    const uint64_t all = domain_.cycles_at(time);
    return all > lost_ ? all - lost_ : 0;
  }
  /// The instant of an edge, if the clock stays as it is; the latest time while it is stopped.
  sc_core::sc_time time_of(uint64_t cycle) const {
    return stops_ != 0 ? sc_core::sc_max_time() : domain_.time_of(cycle + lost_);
  }
  /// The domain's number of a device's edge that has passed, or is the next one.
  uint64_t domain_cycle(uint64_t cycle) const { return cycle + lost_; }

  bool is_stopped() const { return stops_ != 0; }
  bool is_behind() const { return lost_ != 0 || stops_ != 0; }

  /// The next edge does not come.
  void lose_edge() { ++lost_; }
  /// No edge comes from `now` on, until as many start() as stop().
  void stop(const sc_core::sc_time& now) {
    if (stops_ == 0) frozen_ = cycles_at(now);
    ++stops_;
  }
  void start(const sc_core::sc_time& now) {
    if (--stops_ == 0) lost_ = domain_.cycles_at(now) - frozen_;
  }
  /// From now on the numbers are the domain's again: for a device in which the edges between would
  /// have changed nothing.
  void catch_up() { lost_ = 0; }
  void forget_faults() { lost_ = stops_ = 0; }

 private:
  const kit::ClockDomain& domain_;
  uint64_t lost_ = 0, frozen_ = 0, stops_ = 0;
};

}  // namespace capsoc::coprocessor
