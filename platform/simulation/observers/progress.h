// A line on the terminal that says how far the run is. Off a terminal it says nothing.
#pragma once

#include <chrono>

#include "metrics/metrics.h"

namespace capsoc::run {

/// Rewrites one line of stderr at most five times a second of the host.
class Progress {
 public:
  explicit Progress(bool on_terminal) : shown_(on_terminal) {}

  /// `simulated_s`: simulated time in seconds; the parameters as they converge.
  void update(double simulated_s, const metrics::ParameterWords& words);
  /// Clears the line.
  void finish();

 private:
  using Clock = std::chrono::steady_clock;
  bool shown_;
  unsigned calls_ = 0;
  Clock::time_point start_ = Clock::now();
  Clock::time_point last_ = start_;
};

}  // namespace capsoc::run
