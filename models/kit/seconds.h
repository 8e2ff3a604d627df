// Simulated time in seconds.
#pragma once

#include <sysc/kernel/sc_time.h>

namespace capsoc::kit {

/// As SystemC 2.3.4 computes it with its resolution of 1 ps, to the last bit. Version 3.0 rounds
/// otherwise (0.1 s becomes 0.09999999999999999 s), and results would depend on it.
inline double to_seconds(const sc_core::sc_time& time) {
  constexpr double resolution_fs = 1000;
  return static_cast<double>(time.value()) * resolution_fs * 1e-15;
}

}  // namespace capsoc::kit
