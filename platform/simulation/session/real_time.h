// Simulated time paced to the host's.
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <systemc>

namespace capsoc::run {

/// Holds the host back while simulated time is ahead of it. It sleeps and does nothing else, so
/// that a run with the same input is the same run.
class RealTime {
 public:
  /// Simulated seconds a second of the host; 0: not paced.
  explicit RealTime(double factor) : factor_(factor) {}

  bool on() const { return factor_ > 0; }
  /// Simulated time between two calls of pace(): 10 ms of the host, too short to notice.
  sc_core::sc_time slice() const;

  /// Returns when the host's time has come for the simulated one, or when `give_up` says so.
  /// Simulated time that is late catches up, but by at most a second of the host. What a stopped
  /// process or a slow host has lost beyond that stays lost.
  void pace(const sc_core::sc_time& now, const std::function<bool()>& give_up);

  /// Seconds of the host that were lost so.
  double lost_s() const { return lost_s_; }

 private:
  using Clock = std::chrono::steady_clock;
  double factor_;
  std::optional<Clock::time_point> start_;  ///< the host's time of the simulated time 0
  double lost_s_ = 0;
};

}  // namespace capsoc::run
