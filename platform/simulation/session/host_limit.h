// The host's reasons to end a run.
#pragma once

#include <atomic>
#include <chrono>
#include <ctime>
#include <functional>
#include <optional>

#include "base/result.h"

namespace capsoc::run {

/// A signal, or a limit of the host's time. Signals and a timer of the system call for the run's
/// attention, so that it need not ask the clock, and none that sleeps or waits for the host is
/// overlooked. One at a time in a process.
class HostLimit {
 public:
  /// `seconds` of the host from now on; 0: no limit.
  explicit HostLimit(double seconds) : seconds_(seconds) {}
  ~HostLimit() { stop_watching(); }
  HostLimit(const HostLimit&) = delete;
  HostLimit& operator=(const HostLimit&) = delete;

  /// From now on `call` is called in a signal handler: for each signal and at the limit, then every
  /// 20 ms until answered(). The signal of the timer is SIGALRM: a system call that waits ends with
  /// EINTR. An Error: the host has no timer for it.
  std::optional<Error> watch(std::function<void()> call);
  /// The call has come where it should.
  void answered();
  /// No more calls: what is written after the run may wait for its reader.
  void stop_watching();

  double elapsed_s() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }
  /// Whether the run has to end.
  bool reached();
  /// As it was when it was last asked.
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
