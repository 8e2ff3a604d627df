// The CMSDK peripherals, each with its own initiator. SystemC elaborates once, so every test
// of this program shares them and begins with a reset.
#pragma once

#include <cstdint>

#include "../bus/initiator.h"
#include "cmsdk/dual_timer.h"
#include "cmsdk/gpio.h"
#include "cmsdk/timer.h"
#include "cmsdk/uart.h"
#include "cmsdk/watchdog.h"
#include "kit/clock_domain.h"
#include "kit/guest_error.h"

namespace capsoc::test {

struct Bench {
  Bench();

  uint64_t cycle() const { return clock.cycles_at(sc_core::sc_time_stamp()); }
  /// Simulates up to the edge `n` cycles from the present one and everything that happens at it:
  /// sc_start stops when that time is reached, before its events.
  void run(uint64_t n) {
    sc_core::sc_start(clock.time_of(cycle() + n) - sc_core::sc_time_stamp());
    while (sc_core::sc_time_to_pending_activity() == sc_core::SC_ZERO_TIME)
      sc_core::sc_start(sc_core::SC_ZERO_TIME);
  }

  kit::ClockDomain clock;  // 25 MHz
  cmsdk::Uart uart;
  cmsdk::Timer timer;
  cmsdk::Gpio gpio;
  cmsdk::DualTimer dual_timer;
  cmsdk::Watchdog watchdog;
  Initiator to_uart, to_timer, to_gpio, to_dual_timer, to_watchdog;
};

/// The one of this program.
Bench& bench();

}  // namespace capsoc::test
