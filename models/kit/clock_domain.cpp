#include "kit/clock_domain.h"

#include <limits>

namespace capsoc::kit {
namespace {

// Edge number times resolution exceeds 64 bits after 12 minutes at 25 MHz and 1 ps.
__extension__ typedef unsigned __int128 Wide;

constexpr uint64_t farthest = std::numeric_limits<uint64_t>::max();

}  // namespace

ClockDomain::ClockDomain(uint64_t hz)
    : frequency_hz_(hz == 0 ? 1 : hz),
      ticks_per_second_(sc_core::sc_time(1, sc_core::SC_SEC).value()) {}

uint64_t ClockDomain::cycles_at(const sc_core::sc_time& time) const {
  if (time.value() <= epoch_ticks_) return epoch_cycle_;
  const Wide edges = Wide{time.value() - epoch_ticks_} * frequency_hz_ / ticks_per_second_;
  const Wide cycle = edges + epoch_cycle_;
  return cycle > farthest ? farthest : static_cast<uint64_t>(cycle);
}

sc_core::sc_time ClockDomain::time_of(uint64_t cycle) const {
  if (cycle <= epoch_cycle_) return sc_core::sc_time::from_value(epoch_ticks_);
  const Wide ticks =
      (Wide{cycle - epoch_cycle_} * ticks_per_second_ + frequency_hz_ - 1) / frequency_hz_ +
      epoch_ticks_;
  return ticks > farthest ? sc_core::sc_max_time()
                          : sc_core::sc_time::from_value(static_cast<uint64_t>(ticks));
}

uint64_t ClockDomain::next_edge(const sc_core::sc_time& time) const {
  const uint64_t cycle = cycles_at(time);
  return time_of(cycle) < time ? cycle + 1 : cycle;
}

void ClockDomain::set_frequency(uint64_t hz) {
  const sc_core::sc_time now = sc_core::sc_time_stamp();
  epoch_cycle_ = cycles_at(now);
  epoch_ticks_ = now.value();
  frequency_hz_ = hz == 0 ? 1 : hz;
  for (const auto& listener : listeners_) listener();
}

void ClockDomain::visit(Archive& archive) {
  archive("frequency_hz", frequency_hz_);
  archive("epoch_ticks", epoch_ticks_);
  archive("epoch_cycle", epoch_cycle_);
  if (frequency_hz_ == 0) archive.refuse("stands still");
  if (epoch_ticks_ > archive.time()) archive.refuse("begins in the future");
}

}  // namespace capsoc::kit
