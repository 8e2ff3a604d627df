// The main of tests that share one bench of SystemC modules.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <systemc>

namespace capsoc::test {

/// Makes the bench, elaborates, runs all tests and ends the simulation. Returns their status.
template <typename Bench>
int run_on_bench(int argc, char** argv, std::unique_ptr<Bench>& bench) {
  testing::InitGoogleTest(&argc, argv);
  bench = std::make_unique<Bench>();
  sc_core::sc_start(sc_core::SC_ZERO_TIME);
  const int result = RUN_ALL_TESTS();
  sc_core::sc_stop();
  return result;
}

}  // namespace capsoc::test
