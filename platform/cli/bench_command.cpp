// capsoc bench cpu: the processor's speed beside QEMU's.
#include <fmt/format.h>

#include <filesystem>
#include <iostream>
#include <memory>

#include "bench/cpu_bench.h"
#include "cli/commands.h"
#include "host/places.h"
#include "run/results.h"

namespace capsoc::cli {
namespace {

std::vector<std::string> kernels() {
  std::vector<std::string> files;
  for (const char* kernel : {"list_search", "matrix", "state_machine", "crc", "sort", "strings"})
    files.push_back(host::data_path(std::string("firmware/bench_") + kernel + ".elf"));
  return files;
}

}  // namespace

void add_bench(CLI::App& app, int& code) {
  CLI::App* bench = app.add_subcommand("bench", "Measure the simulator's speed");
  bench->require_subcommand(1);
  auto settings = std::make_shared<bench::CpuBench>();
  CLI::App* cpu = bench->add_subcommand(
      "cpu",
      "Integer kernels: million instructions a second of processor time, cycles per instruction, "
      "and the ratio to qemu-system-arm on the same ELF, plain and with -icount");
  cpu->add_option("elf", settings->firmware, "Programs that end by themselves (default: kernels)")
      ->check(CLI::ExistingFile)
      ->type_name("ELF");
  cpu->add_option("--repeat", settings->repeat, "The best of so many runs counts")
      ->check(CLI::Range(1, 100))
      ->type_name("N");
  cpu->add_option("--quantum", settings->quantum_ns, "How far the processor may run ahead")
      ->check(CLI::PositiveNumber)
      ->type_name("NS");
  cpu->add_option("--require", settings->least_ratio,
                  "Exit 1 if the mean ratio to QEMU with -icount is less")
      ->type_name("RATIO");
  cpu->callback([settings, &code] {
    settings->program = host::program_path();
    if (settings->firmware.empty()) settings->firmware = kernels();
    for (const std::string& program : settings->firmware)
      if (std::error_code ignored; !std::filesystem::exists(program, ignored)) {
        fmt::print(stderr,
                   "capsoc: {}: there is no such program; name others (capsoc bench cpu FILE.elf), "
                   "or keep the folder firmware/ beside capsoc\n",
                   program);
        code = run::exit_code::usage;
        return;
      }
    const bool good = bench::run_cpu_bench(*settings, std::cout) == 0;
    code = good ? run::exit_code::pass : run::exit_code::failed;
  });
}

}  // namespace capsoc::cli
