#include "inject/clock_faults.h"

#include <algorithm>

namespace capsoc::inject {

std::vector<const Injected*> ClockFaults::waiting() const {
  std::vector<const Injected*> waiting;
  for (const Injected* injected : faults_)
    if (!injected->is_over && !injected->outcome.applied) waiting.push_back(injected);
  return waiting;
}

bool ClockFaults::is_stopped(const Injected& injected) const {
  return std::find(stopped_.begin(), stopped_.end(), &injected) != stopped_.end();
}

sc_core::sc_time ClockFaults::next() const {
  sc_core::sc_time soonest = sc_core::sc_max_time();
  for (const Injected* injected : faults_) {
    if (injected->is_over || !injected->outcome.applied) continue;
    soonest = std::min(
        soonest, is_stopped(*injected)
                     ? *injected->end
                     : position_.soc.coprocessor.quiet_at().value_or(sc_core::sc_time_stamp()));
  }
  return soonest;
}

void ClockFaults::begin(Injected& injected) const {
  if (injected.fault.duration)
    position_.soc.coprocessor.stop_clock();
  else
    position_.soc.coprocessor.lose_clock_edge();
  position_.note(injected, 1, 0);
}

void ClockFaults::pause(const sc_core::sc_time& now) {
  coprocessor::CoprocessorTlm& coprocessor = position_.soc.coprocessor;
  for (Injected* injected : faults_) {
    if (injected->is_over) continue;
    if (!injected->outcome.applied) {
      if (!position_.reached(injected->fault.when)) continue;
      begin(*injected);
      if (injected->fault.duration) stopped_.push_back(injected);
    }
    if (is_stopped(*injected)) {
      if (now < *injected->end) continue;
      coprocessor.start_clock();
      stopped_.erase(std::find(stopped_.begin(), stopped_.end(), injected));
    }
    injected->is_over = !coprocessor.is_behind_clock();
  }
}

}  // namespace capsoc::inject
