#include "session/real_time.h"

#include <algorithm>
#include <thread>

#include "kit/seconds.h"

namespace capsoc::run {
namespace {

using Seconds = std::chrono::duration<double>;

constexpr Seconds most_behind{1};
/// A sleep shorter than this is not worth its system call; one longer would keep a signal waiting
/// that another thread took.
constexpr Seconds shortest_sleep{0.0005}, longest_sleep{0.01};

}  // namespace

sc_core::sc_time RealTime::slice() const {
  return {longest_sleep.count() * factor_, sc_core::SC_SEC};
}

void RealTime::pace(const sc_core::sc_time& now, const std::function<bool()>& give_up) {
  if (!on()) return;
  const auto due =
      std::chrono::duration_cast<Clock::duration>(Seconds(kit::to_seconds(now) / factor_));
  if (!start_) start_ = Clock::now() - due;
  const Seconds behind = Clock::now() - (*start_ + due);
  if (behind > most_behind) {
    *start_ += std::chrono::duration_cast<Clock::duration>(behind - most_behind);
    lost_s_ += (behind - most_behind).count();
  }
  for (;;) {
    const Seconds ahead = *start_ + due - Clock::now();
    if (ahead < shortest_sleep || give_up()) return;
    std::this_thread::sleep_for(std::min(ahead, longest_sleep));
  }
}

}  // namespace capsoc::run
