#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <systemc>
#include <vector>

#include "base/archive.h"

namespace capsoc::kit {

/// A clock that is never toggled: it converts between simulated time and edge numbers, exactly.
///
/// Edge n of an epoch lies at epoch_time + ceil(n / f) in units of the time resolution. So every
/// edge is at or after its ideal time, and edge numbers continue without a jump over a change of
/// frequency. Edge 0 is the start of simulated time.
class ClockDomain {
 public:
  /// `hz` must not be 0; 0 counts as 1.
  explicit ClockDomain(uint64_t hz = 25'000'000);
  ClockDomain(const ClockDomain&) = delete;
  ClockDomain& operator=(const ClockDomain&) = delete;

  uint64_t frequency_hz() const { return frequency_hz_; }

  /// Number of the last rising edge at or before `time`. A time before the latest change of
  /// frequency counts as the instant of that change.
  uint64_t cycles_at(const sc_core::sc_time& time) const;

  /// The instant of edge `cycle`; the latest representable time if that is further away. An edge
  /// before the latest change of frequency yields the instant of that change.
  sc_core::sc_time time_of(uint64_t cycle) const;

  /// Time that `cycles` cycles take, from the last edge at or before `time`.
  sc_core::sc_time duration(uint64_t cycles, const sc_core::sc_time& time) const;
  /// The same, if it does not depend on the time and `cycles` is small; else null.
  const sc_core::sc_time* fixed_duration(uint64_t cycles) const {
    return whole_period_ != 0 && cycles < durations_.size() ? &durations_[cycles] : nullptr;
  }

  /// The first edge at or after `time`.
  uint64_t next_edge(const sc_core::sc_time& time) const;

  /// Changes the frequency at the present simulated time: the present edge number stays, the next
  /// edge comes one new period from now. Then notifies the listeners, in the order of their
  /// registration.
  void set_frequency(uint64_t hz);

  /// Does not notify listeners: parts that plan by edge numbers plan again after a restore.
  void visit(Archive& archive);

  /// `listener` runs after every change; it reschedules what it had planned by edge number.
  void on_change(std::function<void()> listener) { listeners_.push_back(std::move(listener)); }

 private:
  void take_frequency(uint64_t hz);
  uint64_t edge_at(uint64_t ticks) const;
  uint64_t edge_at_fraction(uint64_t ticks) const;

  uint64_t ticks_per_second_;  // of the kernel's time resolution
  uint64_t frequency_hz_ = 1;
  uint64_t whole_period_ = 0;  // in ticks; 0: it is no whole number of them
  uint64_t epoch_ticks_ = 0;
  uint64_t epoch_cycle_ = 0;
  std::array<sc_core::sc_time, 8> durations_;  // of whole periods
  // An edge and its instant, the last that time_of() was asked for: a device asks for the number of
  // the edge at which it is accessed.
  mutable uint64_t latest_ticks_ = 0, latest_cycle_ = 0;
  std::vector<std::function<void()>> listeners_;
};

// Inline, since every access to a device calls it several times.

inline uint64_t ClockDomain::edge_at(uint64_t ticks) const {
  if (ticks <= epoch_ticks_) return epoch_cycle_;
  uint64_t cycle = 0;
  if (whole_period_ != 0 &&
      !__builtin_add_overflow((ticks - epoch_ticks_) / whole_period_, epoch_cycle_, &cycle))
    return cycle;
  return edge_at_fraction(ticks);
}

inline uint64_t ClockDomain::cycles_at(const sc_core::sc_time& time) const {
  return time.value() == latest_ticks_ ? latest_cycle_ : edge_at(time.value());
}

/// The edge after the last edge before `time`.
inline uint64_t ClockDomain::next_edge(const sc_core::sc_time& time) const {
  if (time.value() <= epoch_ticks_) return epoch_cycle_;
  const uint64_t before = edge_at(time.value() - 1);
  return before == UINT64_MAX ? before : before + 1;
}

}  // namespace capsoc::kit
