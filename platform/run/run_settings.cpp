#include "run/run_settings.h"

#include <fmt/format.h>

#include <filesystem>

#include "host/places.h"
#include "run/checkpoints.h"
#include "run/coprocessor_backend.h"
#include "run/idle.h"
#include "run/program_values.h"
#include "run/results.h"
#include "run/semihosting_port.h"
#include "run/trace_settings.h"
#include "run/uart_lines.h"
#include "sensor/description_keys.h"
#include "sensor/load.h"

namespace capsoc::run {
namespace {

/// The default sensor as a file that can be edited, or else what is built in.
std::string default_sensor() {
  const std::string file = host::data_path("traces/soc_eq21.toml");
  std::error_code ignored;
  return std::filesystem::exists(file, ignored) ? file : std::string(sensor::built_in_default);
}

/// As a shell takes it for one word.
std::string quoted(const std::string& word) {
  static constexpr const char* plain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789=._-/,:@+%";
  if (word.find_first_not_of(plain) == std::string::npos) return word;
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

}  // namespace

std::string reproducing_command(const Settings& settings) {
  std::string text = "capsoc run";
  for (const Setting& setting : settings.all()) {
    if (setting.source == SettingSource::built_in) continue;
    if (is_place(setting.path)) continue;  // where it goes, not what it is
    text += fmt::format(" -C {}", quoted(setting.path + "=" + setting.value));
  }
  return text;
}

Settings make_settings() {
  Settings s;
  const auto add = [&](const char* path, SettingKind kind, std::string value, const char* help,
                       std::vector<std::string> choices = {}, double minimum = 0,
                       double maximum = 0) {
    s.add({path, kind, std::move(value), help, std::move(choices), minimum, maximum});
  };
  add("firmware.elf", SettingKind::input, host::data_path("firmware/selfcal.elf"),
      "program for the Cortex-M3");
  add("firmware.load", SettingKind::text, "",
      "further images, FILE@ADDRESS (raw), ELF or Intel HEX, separated by commas");
  add("firmware.vector_table", SettingKind::text, "auto",
      "address of the vector table; auto: 0, or where the program has it");
  add("firmware.parameters", SettingKind::input, "",
      "JSON with parameters to write in the program; empty: none");
  s.add(SettingGroup{program_prefix, "a setting of the program (--list-program-settings)"});
  add("sensor.file", SettingKind::input, default_sensor(),
      "sensor description or recording; -: standard input");
  add("sensor.adc_bits", SettingKind::integer, "0",
      "width of the converter at reset; 0: as the sensor says", {}, 0, 32);
  for (const sensor::DescriptionKey& key : sensor::description_keys())
    s.add({"sensor." + key.name(),
           SettingKind::text,
           "",
           key.help,
           {},
           0,
           0,
           SettingSource::built_in,
           true});
  s.add(SettingGroup{std::string("sensor.") + sensor::harmonics_prefix,
                     "a harmonic of the description: u3_amplitude, v12_phase_rad"});
  add("coprocessor.arithmetic", SettingKind::choice, "precise", "paper or precise",
      {"paper", "precise"});
  add_backend_settings(s);
  add_trace_settings(s);
  add("cpu.quantum_ns", SettingKind::number, "1000000", "how far the processor may run ahead, ns",
      {}, 1, 1e9);
  add("cpu.executor", SettingKind::choice, "blocks", "blocks (fast) or stepping; same results",
      {"blocks", "stepping"});
  add("cpu.priority_bits", SettingKind::integer, "3",
      "implemented bits of each priority: 3 as the AN385, 8 as QEMU's board", {}, 3, 8);
  add("run.simlimit_s", SettingKind::number, "0", "limit of simulated time, s; 0: none", {}, 0,
      1e6);
  add("run.timelimit_s", SettingKind::number, "0", "limit of the host's time, s; 0: none", {}, 0,
      1e6);
  add_idle_settings(s);
  add_uart_settings(s);
  add_semihosting_settings(s);
  add("run.stop_in_fault", SettingKind::flag, "true",
      "a fault handler that branches to itself is a crash, if nothing can interrupt it");
  add("itm.backend", SettingKind::backend, "null",
      "where the processor's ITM text goes: stdout, null, log (level info) or file:PATH");
  add("itm.port", SettingKind::integer, "0", "stimulus port of that text", {}, 0, 31);
  add("run.golden", SettingKind::flag, "false", "fit the coprocessor's samples by the CSFN, too");
  add("gdb.port", SettingKind::integer, "-1", "port of the GDB server; 0: a free one, -1: none", {},
      -1, 65535);
  add("gdb.halt", SettingKind::flag, "false", "wait for a debugger before the first instruction");
  add_checkpoint_settings(s);
  add("results.json", SettingKind::output, "", "where the results go; empty: nowhere");
  add("results.record", SettingKind::output, "",
      "where the coprocessor's samples go (CSV); empty: nowhere");
  add("results.record_columns", SettingKind::text, "",
      "columns of that file, separated by commas; empty: t,u,v,angle_deg");
  add("log.level", SettingKind::choice, "warn", "trace, debug, info, warn, error, off",
      {"trace", "debug", "info", "warn", "error", "off"});
  return s;
}

}  // namespace capsoc::run
