// The core alone, without a simulation kernel, on the programs of firmware/bench: millions of
// instructions a second and cycles per instruction.
#include <benchmark/benchmark.h>

#include <memory>
#include <string>

#include "board.h"

namespace capsoc::armv7m {
namespace {

using test::Board;

void run_program(benchmark::State& state, const std::string& path, Executor executor) {
  constexpr uint64_t slice = 20'000'000;  // cycles
  uint64_t instructions = 0, cycles = 0;
  auto board = std::make_unique<Board>(path);
  for (auto _ : state) {
    if (board->exited) {
      state.PauseTiming();
      board = std::make_unique<Board>(path);
      state.ResumeTiming();
    }
    board->core.set_executor(executor);
    const uint64_t before = board->core.instructions(), start = board->core.cycles();
    board->core.run(start + slice);
    instructions += board->core.instructions() - before;
    cycles += board->core.cycles() - start;
  }
  state.counters["MIPS"] =
      benchmark::Counter(static_cast<double>(instructions) / 1e6, benchmark::Counter::kIsRate);
  state.counters["CPI"] = static_cast<double>(cycles) / static_cast<double>(instructions);
}

}  // namespace
}  // namespace capsoc::armv7m

int main(int argc, char** argv) {
  using namespace capsoc::armv7m;
  for (const char* kernel : {"list_search", "matrix", "state_machine", "crc", "sort", "strings"}) {
    const std::string path = std::string(CAPSOC_BENCH_PROGRAMS) + "/bench_" + kernel + ".elf";
    for (Executor executor : {Executor::blocks, Executor::stepping}) {
      const std::string name =
          std::string(kernel) + (executor == Executor::blocks ? "/blocks" : "/stepping");
      benchmark::RegisterBenchmark(name.c_str(), run_program, path, executor)
          ->Unit(benchmark::kMillisecond);
    }
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
