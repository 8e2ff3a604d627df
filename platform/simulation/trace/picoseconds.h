#pragma once

#include <cmath>
#include <cstdint>
#include <systemc>

namespace capsoc::trace {

/// Simulated time in picoseconds.
inline uint64_t picoseconds(const sc_core::sc_time& time) {
  static const auto resolution =
      static_cast<uint64_t>(std::llround(sc_core::sc_get_time_resolution().to_seconds() * 1e12));
  return time.value() * resolution;
}

}  // namespace capsoc::trace
