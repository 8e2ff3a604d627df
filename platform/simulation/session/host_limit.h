// The host's reasons to end a run.
#pragma once

#include <atomic>
#include <chrono>
#include <ctime>
#include <functional>
#include <optional>

#include "base/result.h"

namespace capsoc::run {

/// Ends a run on a signal or at a limit of the host's time. Signals and a system timer interrupt
/// the run, so that it need not poll the clock, and also ends while it sleeps or waits for the
/// host. One instance at a time in a process.
class HostLimit {
 public:
  /// `seconds` of the host from now on; 0: no limit.
  explicit HostLimit(double seconds) : seconds_(seconds) {}
  ~HostLimit() { stop_watching(); }
  HostLimit(const HostLimit&) = delete;
  HostLimit& operator=(const HostLimit&) = delete;

  /// The time begins again, now: this process was forked since then. Before watch().
  void begin_again() { start_ = Clock::now(); }
  /// From now on calls `call` in a signal handler: for each signal and at the limit, then every 20
  /// ms until answered(). The timer's signal is SIGALRM; a blocking system call ends with EINTR. An
  /// Error: the host has no timer.
  std::optional<Error> watch(std::function<void()> call);
  /// Call when the run has reacted to `call`.
  void answered();
  /// Ends the calls, so that output after the run may wait for its reader.
  void stop_watching();

  double elapsed_s() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }
  /// Whether the run has to end.
  bool reached();
  /// Whether the time limit was exceeded, as of the last reached().
  bool out_of_time() const { return out_of_time_; }

 private:
  using Clock = std::chrono::steady_clock;
  static void handle();

  double seconds_;
  Clock::time_point start_ = Clock::now();
  bool out_of_time_ = false;
  std::function<void()> call_;
  std::optional<timer_t> timer_;
  std::atomic<bool> time_is_over_{false}, unanswered_{false};
};

}  // namespace capsoc::run
