#pragma once

#include <functional>
#include <systemc>

#include "../bench.h"
#include "kit/clock_domain.h"

namespace capsoc::armv7m::test {

/// A core whose cycle is the kernel's present one. Simulated time continues from test to test.
struct Aligned {
  kit::ClockDomain clock;
  Bench bench;
  Core& core = bench.core;
  const sc_core::sc_time begin = sc_core::sc_time_stamp();
  const uint64_t first = clock.next_edge(begin);

  explicit Aligned(std::initializer_list<uint16_t> code = {0xE7FE}) {
    bench.start(code);
    core.skip_to(first);
  }
  sc_core::sc_time after(uint64_t cycles) const { return clock.time_of(first + cycles); }
};

/// Runs a function as a SystemC process, and the kernel until nothing is left.
inline void in_process(const std::function<void()>& body) {
  sc_core::sc_spawn(body);
  sc_core::sc_start();
}

/// Runs a function as a process at a time.
inline void at(const sc_core::sc_time& time, const std::function<void()>& body) {
  sc_core::sc_spawn([time, body] {
    sc_core::wait(time - sc_core::sc_time_stamp());
    body();
  });
}

}  // namespace capsoc::armv7m::test
