#include "inject/clock_faults.h"

#include <algorithm>

namespace capsoc::inject {

std::vector<const Injected*> ClockFaults::waiting() const {
  std::vector<const Injected*> waiting;
  for (const OnClock& each : faults_)
    if (!each.injected->is_over && !each.injected->outcome.applied)
      waiting.push_back(each.injected);
  return waiting;
}

sc_core::sc_time ClockFaults::next() const {
  sc_core::sc_time soonest = sc_core::sc_max_time();
  for (const auto& [injected, stops] : faults_) {
    if (injected->is_over || !injected->outcome.applied) continue;
    const sc_core::sc_time end =
        stops ? *injected->end
              : position_.soc.coprocessor.quiet_at().value_or(sc_core::sc_time_stamp());
    soonest = std::min(soonest, end);
  }
  return soonest;
}

void ClockFaults::begin(OnClock& each) const {
  each.stops = each.injected->fault.duration.has_value();
  if (each.stops)
    position_.soc.coprocessor.stop_clock();
  else
    position_.soc.coprocessor.lose_clock_edge();
  position_.note(*each.injected, 1, 0);
}

void ClockFaults::pause(const sc_core::sc_time& now) {
  coprocessor::CoprocessorTlm& coprocessor = position_.soc.coprocessor;
  for (OnClock& each : faults_) {
    Injected& injected = *each.injected;
    if (injected.is_over) continue;
    if (!injected.outcome.applied) {
      if (!position_.reached(injected.fault.when)) continue;
      begin(each);
    }
    if (each.stops) {
      if (now < *injected.end) continue;
      coprocessor.start_clock();
      each.stops = false;
    }
    injected.is_over = !coprocessor.is_behind_clock();
  }
}

}  // namespace capsoc::inject
