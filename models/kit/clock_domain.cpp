#include "kit/clock_domain.h"

#include <limits>

namespace capsoc::kit {
namespace {

// Edge number times resolution exceeds 64 bits after 12 minutes at 25 MHz and 1 ps.
__extension__ typedef unsigned __int128 Wide;

constexpr uint64_t farthest = std::numeric_limits<uint64_t>::max();

}  // namespace

ClockDomain::ClockDomain(uint64_t hz)
    : ticks_per_second_(sc_core::sc_time(1, sc_core::SC_SEC).value()) {
  take_frequency(hz);
}

/// A whole period spares the wide division: 30 instructions for 100, six times an access to a
/// device.
void ClockDomain::take_frequency(uint64_t hz) {
  frequency_hz_ = hz == 0 ? 1 : hz;
  latest_ticks_ = epoch_ticks_;
  latest_cycle_ = epoch_cycle_;
  whole_period_ = ticks_per_second_ % frequency_hz_ == 0 ? ticks_per_second_ / frequency_hz_ : 0;
  for (uint64_t n = 0; n < durations_.size(); ++n)
    durations_[n] = sc_core::sc_time::from_value(n * whole_period_);
}

/// After the epoch; where the period is no whole number of ticks, or the number is too large.
uint64_t ClockDomain::edge_at_fraction(uint64_t ticks) const {
  const Wide edges = Wide{ticks - epoch_ticks_} * frequency_hz_ / ticks_per_second_;
  const Wide cycle = edges + epoch_cycle_;
  return cycle > farthest ? farthest : static_cast<uint64_t>(cycle);
}

sc_core::sc_time ClockDomain::time_of(uint64_t cycle) const {
  if (cycle <= epoch_cycle_) return sc_core::sc_time::from_value(epoch_ticks_);
  if (uint64_t ticks = 0; whole_period_ != 0 &&
                          !__builtin_mul_overflow(cycle - epoch_cycle_, whole_period_, &ticks) &&
                          !__builtin_add_overflow(ticks, epoch_ticks_, &ticks)) {
    latest_ticks_ = ticks;
    latest_cycle_ = cycle;
    return sc_core::sc_time::from_value(ticks);
  }
  const Wide ticks =
      (Wide{cycle - epoch_cycle_} * ticks_per_second_ + frequency_hz_ - 1) / frequency_hz_ +
      epoch_ticks_;
  return ticks > farthest ? sc_core::sc_max_time()
                          : sc_core::sc_time::from_value(static_cast<uint64_t>(ticks));
}

sc_core::sc_time ClockDomain::duration(uint64_t cycles, const sc_core::sc_time& time) const {
  if (uint64_t ticks = 0;
      whole_period_ != 0 && !__builtin_mul_overflow(cycles, whole_period_, &ticks))
    return sc_core::sc_time::from_value(ticks);
  const uint64_t edge = cycles_at(time);
  return time_of(edge + cycles) - time_of(edge);
}

void ClockDomain::set_frequency(uint64_t hz) {
  const sc_core::sc_time now = sc_core::sc_time_stamp();
  epoch_cycle_ = cycles_at(now);
  epoch_ticks_ = now.value();
  take_frequency(hz);
  for (const auto& listener : listeners_) listener();
}

void ClockDomain::visit(Archive& archive) {
  archive("frequency_hz", frequency_hz_);
  archive("epoch_ticks", epoch_ticks_);
  archive("epoch_cycle", epoch_cycle_);
  if (frequency_hz_ == 0) archive.refuse("stands still");
  take_frequency(frequency_hz_);
  if (epoch_ticks_ > archive.time()) archive.refuse("begins in the future");
}

}  // namespace capsoc::kit
