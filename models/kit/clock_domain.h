#pragma once

#include <cstdint>
#include <functional>
#include <systemc>
#include <vector>

#include "kit/archive.h"

namespace capsoc::kit {

/// A clock that is never toggled: it converts between simulated time and edge numbers, exactly.
///
/// Edge n of an epoch lies at epoch_time + ceil(n / f) in units of the time resolution, so every
/// edge is at or after its ideal place and edge numbers survive a change of frequency without a
/// jump. Edge 0 is the start of simulated time.
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

  /// What so many cycles take from the last edge at or before `time`.
  sc_core::sc_time duration(uint64_t cycles, const sc_core::sc_time& time) const;

  /// The first edge at or after `time`.
  uint64_t next_edge(const sc_core::sc_time& time) const;

  /// Changes the frequency at the present simulated time: the present edge number stays, the next
  /// edge comes one new period from now. Then tells the listeners, in the order of their
  /// registration.
  void set_frequency(uint64_t hz);

  /// Nobody is told: whoever plans by edge numbers does so anew after a restore.
  void visit(Archive& archive);

  /// `listener` runs after every change; it reschedules what it had planned by edge number.
  void on_change(std::function<void()> listener) { listeners_.push_back(std::move(listener)); }

 private:
  void take_frequency(uint64_t hz);

  uint64_t ticks_per_second_;  // of the kernel's time resolution
  uint64_t frequency_hz_ = 1;
  uint64_t whole_period_ = 0;  // in ticks; 0: it is no whole number of them
  uint64_t epoch_ticks_ = 0;
  uint64_t epoch_cycle_ = 0;
  std::vector<std::function<void()>> listeners_;
};

}  // namespace capsoc::kit
