#include "bench.h"

#include <gtest/gtest.h>

#include <memory>

#include "../kit/bench_main.h"

namespace capsoc::test {
namespace {

std::unique_ptr<Bench> the_bench;

}  // namespace

Bench::Bench()
    : uart("uart", clock),
      timer("timer", clock),
      gpio("gpio", clock),
      dual_timer("dual_timer", clock),
      watchdog("watchdog", clock),
      to_uart("to_uart"),
      to_timer("to_timer"),
      to_gpio("to_gpio"),
      to_dual_timer("to_dual_timer"),
      to_watchdog("to_watchdog") {
  to_uart.socket.bind(uart.socket);
  to_timer.socket.bind(timer.socket);
  to_gpio.socket.bind(gpio.socket);
  to_dual_timer.socket.bind(dual_timer.socket);
  to_watchdog.socket.bind(watchdog.socket);
}

Bench& bench() {
  return *the_bench;
}

}  // namespace capsoc::test

int sc_main(int argc, char** argv) {
  return capsoc::test::run_on_bench(argc, argv, capsoc::test::the_bench);
}
