#pragma once

#include <gtest/gtest.h>
#include <tlm_utils/simple_initiator_socket.h>

#include <cstdint>
#include <systemc>

#include "../kit/bus_access.h"
#include "capsoc_registers.h"
#include "coprocessor/tlm/coprocessor_tlm.h"
#include "kit/clock_domain.h"
#include "peripherals/adc_front_end.h"
#include "peripherals/clock_controller.h"

namespace capsoc::test {

/// The three devices on one clock. The kernel elaborates once in a process, so the tests share it:
/// each starts with a system reset at whatever time it is.
struct TestBench : sc_core::sc_module {
  explicit TestBench(const sc_core::sc_module_name& name);

  kit::ClockDomain clock;
  peripherals::ClockController clock_controller{"clock_controller", clock};
  peripherals::AdcFrontEnd adc{"adc", clock};
  coprocessor::CoprocessorTlm coprocessor{"coprocessor", clock};

  /// Lets `cycles` of HCLK pass, including all that happens on the last edge.
  void run(uint64_t cycles);

  uint64_t cycle() const { return clock.cycles_at(sc_core::sc_time_stamp()); }

  void reset();

 private:
  tlm_utils::simple_initiator_socket<TestBench> to_clock_controller_{"to_clock_controller"};
  tlm_utils::simple_initiator_socket<TestBench> to_adc_{"to_adc"};
  tlm_utils::simple_initiator_socket<TestBench> to_coprocessor_{"to_coprocessor"};
};

TestBench& test_bench();

class DeviceTest : public testing::Test {
 protected:
  void SetUp() override { bench.reset(); }

  TestBench& bench = test_bench();
  BusAccess clock_controller{bench.clock_controller.socket};
  BusAccess adc{bench.adc.socket};
  BusAccess coprocessor{bench.coprocessor.socket};
};

}  // namespace capsoc::test
