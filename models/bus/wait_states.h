// Wait states as time: whole HCLK cycles added to the annotated delay of a transaction.
#pragma once

#include <cstdint>
#include <systemc>

#include "kit/clock_domain.h"

namespace capsoc::bus {

/// AHB and APB both answer an error over two cycles (AHB-Lite specification, ERROR response).
constexpr unsigned error_response_cycles = 1;

/// Adds `cycles` clock cycles to `delay`. They are measured between edges, not as a multiple of a
/// rounded period, so that a sum of wait states never drifts from the edges.
inline void add_cycles(const kit::ClockDomain& clock, uint64_t cycles, sc_core::sc_time& delay) {
  if (cycles == 0) return;
  if (const sc_core::sc_time* const fixed = clock.fixed_duration(cycles)) {
    delay += *fixed;
    return;
  }
  delay += clock.duration(cycles, sc_core::sc_time_stamp() + delay);
}

}  // namespace capsoc::bus
