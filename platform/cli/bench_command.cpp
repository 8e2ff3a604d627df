// capsoc bench cpu: the processor's speed and QEMU's.
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "bench/cpu_bench.h"
#include "cli/commands.h"
#include "cli/refuse.h"
#include "cli/table_output.h"
#include "cli/whole_number.h"
#include "host/places.h"
#include "loader/program_file.h"
#include "results/results.h"

namespace capsoc::cli {
namespace {

/// Those that a profile has a use for.
std::vector<std::string> kernels(const std::string& profile) {
  std::vector<std::string> files;
  if (profile == "m4f")
    for (const char* kernel : {"float_matrix", "float_filter", "float_control"})
      files.push_back(host::data_path(fmt::format("firmware/bench_{}_m4f.elf", kernel)));
  for (const char* kernel :
       {"list_search", "matrix", "state_machine", "crc", "sort", "strings", "sha256", "aes", "md5",
        "soft_float", "long_division", "function_pointers", "copy", "interpreter", "tasks",
        "polling", "device", "unaligned", "exclusives"})
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
      "Kernels: million instructions a second of processor time, cycles per instruction, "
      "and the ratio to qemu-system-arm on the same ELF, plain and with -icount");
  cpu->add_option("elf", settings->firmware, "Programs that end by themselves (default: kernels)")
      ->type_name("ELF");
  cpu->add_option("--profile", settings->profile,
                  "Of the processor, as cpu.profile (m4f: kernels with its FPU, too)")
      ->check(CLI::IsMember({"m3", "m4", "m4f"}))
      ->type_name("PROFILE");
  cpu->add_option("--repeat", settings->repeat, "The best of N runs counts")
      ->transform(whole_number(1, 100))
      ->type_name("N");
  cpu->add_option("--quantum", settings->quantum_ns, "How far the processor may run ahead")
      ->check(real_number(1, 1e9))
      ->type_name("NS");
  cpu->add_option("--require", settings->least_ratio,
                  "Exit 1 if the mean ratio to QEMU with -icount is less")
      ->check(real_number(0, 1e6))
      ->type_name("RATIO");
  auto output = std::make_shared<TableOutput>();
  output->add_to(*cpu, {{"cpu", "Million instructions a second beside QEMU"}});
  cpu->callback([settings, output, &code] {
    if (output->listed()) {
      code = run::exit_code::pass;
      return;
    }
    settings->program = host::program_path();
    if (settings->firmware.empty()) settings->firmware = kernels(settings->profile);
    for (const std::string& program : settings->firmware) {
      if (std::error_code ignored; !std::filesystem::exists(program, ignored)) {
        code = refuse(program +
                      ": there is no such program; name others (capsoc bench cpu FILE.elf), or "
                      "keep the folder firmware/ next to capsoc");
        return;
      }
      if (const auto image = loader::load_program(program); !image) {
        code = refuse(image.error());
        return;
      }
    }
    std::vector<host::FileUse> programs;
    for (const std::string& program : settings->firmware)
      programs.push_back({host::FileUse::Kind::input, "the program", program});
    if (auto error = output->check(programs)) {
      code = refuse(error->text);
      return;
    }
    DataTable table;
    const bool good = bench::run_cpu_bench(*settings, output->text(), &table) == 0;
    code = output->finish({table}, "capsoc bench cpu",
                          good ? run::exit_code::pass : run::exit_code::failed);
  });
}

}  // namespace capsoc::cli
