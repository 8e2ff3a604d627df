#pragma once

#include <cstdint>
#include <functional>
#include <systemc>
#include <utility>

#include "base/archive.h"

namespace capsoc::armv7m {

/// Detects a program that has nothing left to do (run.end_on_idle): for a given time neither
/// program nor hardware did any work, and the program slept for at least nine tenths of that time.
/// The time is simulated, so the run ends at the same cycle for every quantum and executor.
class EndOnIdle {
 public:
  /// What counts as work on this board.
  struct Work {
    /// Whether a program's access to this address outside the memories is work.
    std::function<bool(uint32_t address)> is_access;
    /// Whether the hardware is working now.
    std::function<bool()> is_running;
    /// A number that changes with each work step of the hardware.
    std::function<uint64_t()> steps;
  };
  EndOnIdle(const sc_core::sc_time& limit, Work work) : limit_(limit), work_(std::move(work)) {}

  bool is_work(uint32_t address) const { return work_.is_access(address); }
  /// Call when work was done: restarts the time.
  void begin(const sc_core::sc_time& now) {
    since_ = asleep_since_ = now;
    slept_ = sc_core::SC_ZERO_TIME;
    steps_ = work_.steps();
  }
  void fall_asleep(const sc_core::sc_time& now) { asleep_since_ = now; }
  void wake_up(const sc_core::sc_time& now) {
    slept_ += now - asleep_since_;
    asleep_since_ = now;
  }
  void visit(Archive& archive) {
    for (sc_core::sc_time* time : {&since_, &slept_, &asleep_since_}) {
      uint64_t ticks = time->value();
      archive("time", ticks);
      *time = sc_core::sc_time::from_value(ticks);
    }
    archive("steps", steps_);
  }
  /// When to ask is_over() again, if nothing happens.
  sc_core::sc_time deadline() const { return since_ + limit_; }
  /// Whether the program is idle; called while asleep. If the time is over and the program was not
  /// idle, the time restarts.
  bool is_over(const sc_core::sc_time& now) {
    if (now < deadline()) return false;
    wake_up(now);
    const uint64_t elapsed = (now - since_).value(), awake = elapsed - slept_.value();
    const bool idle = !work_.is_running() && work_.steps() == steps_;
    if (idle && awake <= elapsed / longest_awake) return true;
    begin(now);
    return false;
  }

 private:
  static constexpr uint64_t longest_awake = 10;  ///< of the time, as one part in this number

  sc_core::sc_time limit_, since_, slept_, asleep_since_;
  Work work_;
  uint64_t steps_ = 0;
};

}  // namespace capsoc::armv7m
