// What skipping idle clocks is worth: samples at 250 Hz on a 25 MHz clock (one per 100,000 cycles).
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <memory>

#include "coprocessor/coprocessor.h"
#include "coprocessor/register_map.h"
#include "rtl/coprocessor_rtl.h"

namespace {

using namespace capsoc;
using coprocessor::Arithmetic;

constexpr uint64_t cycles_per_sample = 100'000;
constexpr double sample_seconds = 1.0 / 250;

rtl::RtlLibrary::Handle open(Arithmetic arithmetic) {
  coprocessor::Options options;
  options.arithmetic = arithmetic;
  auto library = rtl::RtlLibrary::open(rtl::RtlLibrary::file_name(arithmetic), options);
  if (library) return library.value();
  fmt::print(stderr, "{}\n", library.error());
  std::exit(2);
}

// One sample and the idle time after it; as firmware would, three accesses.
void sample(coprocessor::Device& device, uint64_t& cycle) {
  cycle += cycles_per_sample;
  device.submit(cycle, static_cast<int32_t>(cycle * 1234567), 1 << 30, false);
  const uint64_t result = cycle + coprocessor::latency_cycles;
  benchmark::DoNotOptimize(device.read(result, coprocessor::reg_angle, false).value);
  device.write(result + 10, coprocessor::reg_flags, coprocessor::flags_all);
  benchmark::DoNotOptimize(device.interrupt());
}

void run(benchmark::State& state, coprocessor::Device& device) {
  uint64_t cycle = 10;
  device.write(cycle, coprocessor::reg_ctrl,
               coprocessor::ctrl_adc | coprocessor::ctrl_demod | coprocessor::ctrl_calib);
  for (auto _ : state) sample(device, cycle);
  state.counters["times_real_time"] = benchmark::Counter(
      static_cast<double>(state.iterations()) * sample_seconds, benchmark::Counter::kIsRate);
}

void model(benchmark::State& state) {
  coprocessor::Coprocessor device({});
  run(state, device);
}

void skipping(benchmark::State& state, Arithmetic arithmetic) {
  rtl::CoprocessorRtl device(open(arithmetic), rtl::Clocking::skip);
  run(state, device);
}

void every_clock(benchmark::State& state, Arithmetic arithmetic) {
  rtl::CoprocessorRtl device(open(arithmetic), rtl::Clocking::every);
  run(state, device);
}

double seconds_a_sample(Arithmetic arithmetic, rtl::Clocking clocking, int samples) {
  rtl::CoprocessorRtl device(open(arithmetic), clocking);
  uint64_t cycle = 10;
  device.write(cycle, coprocessor::reg_ctrl, coprocessor::ctrl_adc | coprocessor::ctrl_demod);
  const auto start = std::chrono::steady_clock::now();
  for (int i = 0; i < samples; ++i) sample(device, cycle);
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() / samples;
}

void print_ratio(const char* name, Arithmetic arithmetic) {
  const double skip = seconds_a_sample(arithmetic, rtl::Clocking::skip, 5000);
  const double every = seconds_a_sample(arithmetic, rtl::Clocking::every, 20);
  fmt::print("{}: skipping {:.1f} us a sample, every clock {:.0f} us: {:.0f} times faster\n", name,
             skip * 1e6, every * 1e6, every / skip);
}

BENCHMARK(model)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(skipping, precise, Arithmetic::precise)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(skipping, paper, Arithmetic::paper)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(every_clock, precise, Arithmetic::precise)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(every_clock, paper, Arithmetic::paper)->Unit(benchmark::kMicrosecond);

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  print_ratio("precise", Arithmetic::precise);
  print_ratio("paper", Arithmetic::paper);
  return 0;
}
