#include "test_bench.h"

#include "kit/guest_error.h"

namespace capsoc::test {
namespace {

TestBench* the_bench = nullptr;

}  // namespace

TestBench::TestBench(const sc_core::sc_module_name& name) : sc_module(name) {
  to_clock_controller_.bind(clock_controller.socket);
  to_adc_.bind(adc.socket);
  to_coprocessor_.bind(coprocessor.socket);
}

void TestBench::run(uint64_t cycles) {
  const sc_core::sc_time end = clock.time_of(cycle() + cycles);
  if (end > sc_core::sc_time_stamp()) sc_core::sc_start(end - sc_core::sc_time_stamp());
  while (sc_core::sc_pending_activity_at_current_time()) sc_core::sc_start(sc_core::SC_ZERO_TIME);
}

void TestBench::reset() {
  clock_controller.reset();
  adc.reset();
  coprocessor.reset();
  adc.set_source({});
  adc.set_sink([this](const peripherals::SensorSample& sample) { coprocessor.sample(sample); });
  kit::clear_guest_errors();
  run(8);  // an access or two may have carried the coprocessor ahead
}

TestBench& test_bench() {
  return *the_bench;
}

}  // namespace capsoc::test

int sc_main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  sc_core::sc_report_handler::set_actions(sc_core::SC_WARNING, sc_core::SC_THROW);
  capsoc::test::TestBench bench("bench");
  capsoc::test::the_bench = &bench;
  sc_core::sc_start(sc_core::SC_ZERO_TIME);
  return RUN_ALL_TESTS();
}
