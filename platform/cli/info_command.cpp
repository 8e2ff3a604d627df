// capsoc info: what this build is and where everything lies.
#include <fmt/format.h>

#include "bus/address_map.h"
#include "bus/apb_bridge.h"
#include "cli/commands.h"
#include "cli/refuse.h"
#include "host/console.h"
#include "host/files.h"
#include "results/results.h"
#include "session/run_settings.h"
#include "soc/board_map.h"
#include "soc/board_registers.h"

namespace capsoc::cli {
namespace {

const char* name_of(bus::TargetKind kind) {
  switch (kind) {
    case bus::TargetKind::memory:
      return "memory";
    case bus::TargetKind::device:
      return "device";
    case bus::TargetKind::unimplemented:
      return "unimplemented";
  }
  return "";
}

unsigned waits_of(const bus::MapEntry& entry) {
  return entry.wait_states + (entry.bus == bus::BusKind::apb ? bus::apb_transfer_cycles : 0);
}

int info_command() {
  const auto versions = run::versions();
  for (const auto& [name, version] : versions.items())
    host::print("{:<16} {}\n", name, version.get<std::string>());
  host::print("\n{:<12} {:<12} {:<24} {:<14} {:>4}  {}\n", "from", "to", "what", "kind", "wait",
              "interrupts");
  for (const bus::MapEntry& entry : soc::board_map()) {
    std::string lines;
    for (const bus::InterruptWire& wire : entry.interrupts)
      lines += wire.line == bus::nmi_line ? " NMI" : fmt::format(" {}", wire.line);
    host::print("{:#010x}   {:#010x}   {:<24} {:<14} {:>4} {}\n", entry.base, entry.last(),
                entry.name, name_of(entry.kind), waits_of(entry), lines);
  }
  host::print(
      "\nwait: cycles of a transfer beyond its own. Of a memory: once a word, a setting of a run\n"
      "(-C memory.psram.wait_states=3). On the APB: the {} cycles of the bridge among them.\n",
      bus::apb_transfer_cycles);
  return run::exit_code::pass;
}

int write_svd(const std::string& file, const std::string& profile) {
  Settings all;
  const run::CpuSettings cpu{all};
  if (!profile.empty())
    if (const auto error =
            all.set("cpu.profile", profile, SettingSource::command_line, "--profile"))
      return refuse(error->text);
  // SystemC prints its own notes on stdout.
  sc_core::sc_report_handler::set_actions(sc_core::SC_INFO, sc_core::SC_DO_NOTHING);
  soc::Config config;
  config.processor = cpu.profile();
  const soc::Soc soc("soc", config);
  if (const auto error = host::write_whole(file, soc::board_svd(soc))) return refuse(error->text);
  return run::exit_code::pass;
}

}  // namespace

void add_info(CLI::App& app, int& code) {
  CLI::App* const info = app.add_subcommand("info", "Versions and the memory map");
  auto file = std::make_shared<std::string>(), profile = std::make_shared<std::string>();
  info->add_option("--svd", *file, "Write the registers of the whole board there (CMSIS-SVD)")
      ->type_name("FILE");
  info->add_option("--profile", *profile, "Of another processor than the Cortex-M3, as cpu.profile")
      ->type_name("NAME")
      ->needs("--svd");
  info->callback([file, profile, &code] {
    code = file->empty() ? info_command() : write_svd(*file, *profile);
  });
}

}  // namespace capsoc::cli
