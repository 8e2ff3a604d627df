// capsoc run: the firmware on the SoC, with a sensor.
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <memory>

#include "cli/commands.h"
#include "cli/refuse.h"
#include "host/file_uses.h"
#include "host/files.h"
#include "run/program_values.h"
#include "run/run_files.h"
#include "run/run_settings.h"
#include "run/session.h"
#include "support/printable.h"

namespace capsoc::cli {
namespace {

/// What an option of the command line said, as text; Settings checks it.
struct Given {
  std::string setting, value;
  std::string option = "command line";  ///< that gave it, as sentences name it
  Given(std::string path, std::string text) : setting(std::move(path)), value(std::move(text)) {}
  Given(std::string path, std::string text, std::string name)
      : setting(std::move(path)), value(std::move(text)), option(std::move(name)) {}
};

struct RunArguments {
  std::vector<Given> options;
  std::vector<std::string> assignments;
  std::string config;
  std::vector<std::string> program_assignments;
  bool list = false, list_program = false;
};

void list_settings(const Settings& settings) {
  for (const Setting& setting : settings.all())
    host::print("{:<26} {:<22} {:<13} {}\n", setting.path, setting.value, name_of(setting.source),
                setting.help);
  for (const SettingGroup& group : settings.groups())
    host::print("{:<26} {:<22} {:<13} {}\n", group.prefix + "NAME", "", "", group.help);
}

std::optional<Error> set_program_setting(Settings& settings, const std::string& assignment) {
  const std::string origin = "-P " + printable(assignment, 80);
  const auto equals = assignment.find('=');
  const std::string path = run::program_prefix + assignment.substr(0, equals);
  if (equals == std::string::npos || equals == 0)
    return Error{fmt::format("{}: write name=value, for instance -P step=0.001", origin)};
  if (auto error =
          settings.set(path, assignment.substr(equals + 1), SettingSource::command_line, origin);
      error && settings.source(path) == SettingSource::built_in)
    return Error{
        fmt::format("{}: names are lower-case letters, digits and '_'; "
                    "--list-program-settings lists them",
                    origin)};
  return std::nullopt;
}

/// The settings file, or "".
std::string config_of(const RunArguments& arguments) {
  const char* named = std::getenv("CAPSOC_CONFIG");
  return arguments.config.empty() && named != nullptr ? named : arguments.config;
}

std::optional<Error> collect(const RunArguments& arguments, Settings& settings) {
  const std::string config = config_of(arguments);
  if (!config.empty())
    if (auto error = settings.read_file(config)) return error;
  if (auto error = settings.read_environment(environ)) return error;
  for (const Given& given : arguments.options)
    if (auto error =
            settings.set(given.setting, given.value, SettingSource::command_line, given.option))
      return error;
  for (const std::string& assignment : arguments.assignments)
    if (auto error = settings.set_assignment(assignment)) return error;
  for (const std::string& assignment : arguments.program_assignments)
    if (auto error = set_program_setting(settings, assignment)) return error;
  return std::nullopt;
}

/// Before anything is opened: no output is another file of the run, and what is written at the end
/// can be.
std::optional<Error> check_files(const RunArguments& arguments, const Settings& settings) {
  std::vector<host::FileUse> uses = run::files_of(settings);
  uses.push_back({host::FileUse::Kind::input, "--config", config_of(arguments)});
  if (auto error = host::check_uses(uses)) return error;
  for (const char* place : {"results.json", "results.record"})
    if (const std::string& path = settings.text(place); !path.empty())
      if (auto error = host::check_writable(path)) return error;
  return std::nullopt;
}

int run_command(const RunArguments& arguments) {
  Settings settings = run::make_settings();
  if (auto error = collect(arguments, settings)) return refuse(error->text);
  if (arguments.list) {
    list_settings(settings);
    return run::exit_code::pass;
  }
  if (arguments.list_program) {
    const auto text = run::list_program_settings(settings);
    if (!text) return refuse(text.error());
    host::print("{}", text.value());
    return run::exit_code::pass;
  }
  spdlog::set_level(spdlog::level::from_str(settings.text("log.level")));

  if (auto error = check_files(arguments, settings)) return refuse(error->text);
  auto result = run::run(settings);
  if (!result) return refuse(result.error());
  const run::RunResult& r = result.value();
  if (!r.divergence.empty()) host::say("\n{}", r.divergence);
  if (!r.fault_report.empty()) host::say("\n{}", r.fault_report);
  for (const std::string& sentence : r.lost) host::say("capsoc: {}\n", sentence);
  host::say("{}", run::to_table(r));
  if (const std::string& json = settings.text("results.json"); !json.empty())
    if (auto error = host::write_whole(json, run::to_text(run::to_json(r, settings))))
      return refuse(error->text, r.code == run::exit_code::pass ? run::exit_code::lost : r.code);
  return r.code;
}

}  // namespace

void add_run(CLI::App& app, int& code) {
  auto arguments = std::make_shared<RunArguments>();
  CLI::App* run = app.add_subcommand(
      "run", "Run firmware on the SoC; without arguments: calibrate the sensor of Eq (21)");
  const auto option = [&](const std::string& names, const std::string& setting,
                          const std::string& help) {
    return run->add_option_function<std::string>(
        names,
        [arguments, setting, names](const std::string& value) {
          arguments->options.emplace_back(setting, value, names == "elf" ? "ELF" : names);
        },
        help);
  };
  // May be repeated; the setting has all, separated by commas.
  const auto list = [&](const std::string& name, const std::string& setting,
                        const std::string& help) {
    return run->add_option_function<std::vector<std::string>>(
        name,
        [arguments, setting, name](const std::vector<std::string>& places) {
          std::string all;
          for (const std::string& place : places) all += (all.empty() ? "" : ",") + place;
          arguments->options.emplace_back(setting, all, name);
        },
        help);
  };
  option("elf", "firmware.elf", "Program for the Cortex-M3, ELF or Intel HEX (default: selfcal)")
      ->type_name("ELF");
  list("--load", "firmware.load",
       "Further images: raw bytes at an address, ELF or Intel HEX; may be repeated")
      ->type_name("FILE[@ADDR]")
      ->allow_extra_args(false);
  option("--sensor", "sensor.file",
         "Sensor description (TOML) or recording (CSV); -: standard input")
      ->type_name("FILE");
  option("--arithmetic", "coprocessor.arithmetic", "Arithmetic of the coprocessor")
      ->type_name("paper|precise");
  option("--coprocessor", "coprocessor.backend", "The model, the Verilated RTL, or both compared")
      ->type_name("tlm|rtl|lockstep");
  option("--rtl-library", "coprocessor.rtl_library", "Verilated coprocessor (default: the build's)")
      ->type_name("FILE.so");
  option("--rtl-clock", "coprocessor.rtl_clock", "Clocks of the idle RTL; changes speed only")
      ->type_name("skip|every");
  option("--waves", "results.waves",
         "Waves of the SoC, of the RTL's inside, or with lockstep of both around a difference")
      ->type_name("FILE.fst");
  option("--quantum", "cpu.quantum_ns", "How far the processor may run ahead; changes speed only")
      ->type_name("NS");
  option("--simlimit", "run.simlimit_s", "End after so many simulated seconds with exit 124")
      ->type_name("S");
  option("--timelimit", "run.timelimit_s", "End after so many seconds of the host with exit 124")
      ->type_name("S");
  for (const char number : {'0', '1', '2', '3', '4'})
    option(fmt::format("--uart{}", number), fmt::format("uart{}.backend", number),
           fmt::format("Where UART {} goes; stdio reads stdin, too", number))
        ->type_name("stdout|stdio|null|file:PATH|pty[:LINK]|tcp[:PORT]");
  run->add_flag_callback(
      "--uart-wait", [arguments] { arguments->options.emplace_back("run.uart_wait", "true"); },
      "Hold the first byte of a pty or tcp UART until somebody listens");
  option("--until-uart", "run.until_uart", "End with 0 when a line of a UART matches")
      ->type_name("REGEX");
  option("--fail-uart", "run.fail_uart", "End with 1 when a line of a UART matches")
      ->type_name("REGEX");
  option("--semihosting-dir", "semihosting.directory",
         "Directory that the program's semihosting files are in; without it there are none")
      ->type_name("DIR");
  option("--semihosting-console", "semihosting.console", "Where :tt goes; as --uart0 (stderr)")
      ->type_name("BACKEND");
  option("--semihosting-args", "semihosting.arguments", "The program's command line")
      ->type_name("TEXT");
  option("--vector-table", "firmware.vector_table",
         "Where the vector table is (auto: 0, or where the program has it)")
      ->type_name("ADDR");
  option("--itm", "itm.backend", "Where the text on the ITM's stimulus port goes")
      ->type_name("stdout|null|log|file:PATH");
  option("--json", "results.json", "Write the results as JSON")->type_name("FILE");
  option("--record", "results.record", "Write the samples that the coprocessor saw as a recording")
      ->type_name("FILE.csv");
  option("--record-columns", "results.record_columns",
         "What that recording has of each sample (a wrong name lists all)")
      ->type_name("NAME,...");
  option("--parameters", "firmware.parameters",
         "Start in calibration mode with the parameters that capsoc fit or run --json wrote")
      ->type_name("FILE.json");
  run->add_flag_callback(
      "--golden", [arguments] { arguments->options.emplace_back("run.golden", "true"); },
      "Fit the samples that the coprocessor saw by the CSFN, too, and print both answers");
  run->add_option_function<std::string>(
         "--gdb",
         [arguments](const std::string& port) {
           arguments->options.emplace_back("gdb.port", port.empty() ? "3333" : port);
         },
         "GDB server on the loopback interface (default port 3333; 0: a free one)")
      ->type_name("[PORT]")
      ->expected(0, 1);
  run->add_flag_callback(
      "--halt", [arguments] { arguments->options.emplace_back("gdb.halt", "true"); },
      "Wait for a debugger before the first instruction");
  option("--trace-instructions", "trace.instructions",
         "A line for each instruction: time, place, disassembly, changed registers")
      ->type_name("FILE");
  option("--trace-bus", "trace.bus", "A line for each access of the processor and the debugger")
      ->type_name("FILE");
  option("--trace-waves", "trace.waves",
         "Waves of the SoC, whatever the coprocessor is: interrupts, bus, nodes; and FILE.gtkw")
      ->type_name("FILE.fst");
  option("--profile", "trace.profile",
         "Cycles of functions and calls, for kcachegrind or, as FILE.folded, for a flame graph")
      ->type_name("FILE");
  option("--log-level", "log.level", "What the simulator says on stderr")
      ->type_name("trace|debug|info|warn|error|off");
  list("--save", "checkpoint.save",
       "Save the whole state at a simulated time in s; may be repeated")
      ->type_name("FILE@S")
      ->allow_extra_args(false);
  option("--save-every", "checkpoint.every_s",
         "Save it every so many simulated seconds, in checkpoint-<seconds>.capsoc")
      ->type_name("S");
  option("--restore", "checkpoint.restore", "Go on from a state that --save wrote")
      ->type_name("FILE");
  run->add_option("--config", arguments->config, "Settings from a TOML file")->type_name("FILE");
  run->add_option("-C", arguments->assignments, "Set any setting")
      ->type_name("PATH=VALUE")
      ->allow_extra_args(false);
  run->add_option("-P", arguments->program_assignments,
                  "Change a setting of the program in its image; may be repeated")
      ->type_name("NAME=VALUE")
      ->allow_extra_args(false);
  run->add_flag("--list-program-settings", arguments->list_program,
                "List the settings that the program has, with units and ranges");
  run->add_flag("--list-params", arguments->list,
                "List all settings with their values and where these come from");
  run->callback([arguments, &code] { code = run_command(*arguments); });
}

}  // namespace capsoc::cli
