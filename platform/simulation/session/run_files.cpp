#include "session/run_files.h"

#include <fmt/format.h>

#include <utility>

#include "backend/coprocessor_backend.h"
#include "inputs/run_inputs.h"
#include "metrics/begin_recording.h"
#include "session/checkpoints.h"
#include "session/run_settings.h"
#include "trace/save_file.h"

namespace capsoc::run {
namespace {

using Kind = host::FileUse::Kind;

/// The file or the link in "file:PATH" or "pty:LINK", or "".
std::string path_of_backend(const std::string& backend) {
  for (const char* kind : {"file:", "pty:"})
    if (backend.rfind(kind, 0) == 0) return backend.substr(std::string(kind).size());
  return "";
}

/// Where the waves of the SoC go, and GTKWave's save file next to them.
void add_save_file(const RunSettings& settings, std::vector<host::FileUse>& uses) {
  const auto add = [&](const TextField& waves) {
    const std::string save = trace::save_file(waves());
    // Waves of the save file's own name are refused with a better sentence.
    if (!waves.empty() && save != waves())
      uses.push_back({Kind::output, "the save file of " + waves.name(), save});
  };
  add(settings.trace.waves);
  if (settings.coprocessor.backend() == Backend::model) add(settings.coprocessor.waves);
}

}  // namespace

Result<RunInputs> read_inputs(const RunSettings& settings) {
  std::vector<const TextField*> console_readers = {&settings.semihosting.console};
  for (const UartSettings::Line& line : settings.uarts.lines)
    console_readers.push_back(&line.backend);
  return read_inputs(settings.firmware, settings.sensor, console_readers);
}

std::vector<Input> input_files(const RunSettings& settings, const RunInputs& inputs) {
  std::vector<std::pair<std::string, std::string>> received;
  for (unsigned n = 0; n < soc::Soc::uart_count; ++n)
    if (const std::string& input = settings.uarts.lines[n].input(); !input.empty())
      received.emplace_back(fmt::format("uart{}", n), input);
  return inputs.files(settings.firmware, received);
}

std::vector<host::FileUse> files_of(const RunSettings& settings) {
  std::vector<host::FileUse> uses;
  for (const Setting& setting : settings.all()) {
    if (setting.kind == SettingKind::input && setting.path != settings.sensor.file.about().path)
      uses.push_back({Kind::input, setting.name(), setting.value});
    if (setting.kind == SettingKind::output)
      uses.push_back({Kind::output, setting.name(), setting.value});
    if (setting.path == settings.results.record.about().path)
      for (const std::string& file : metrics::files_of_recording(setting.value))
        if (file != setting.value) uses.push_back({Kind::output, "the metadata of --record", file});
    if (setting.kind == SettingKind::backend)
      uses.push_back({Kind::output, setting.name(), path_of_backend(setting.value)});
    if (setting.kind == SettingKind::backend && setting.value.rfind("script:", 0) == 0)
      uses.push_back({Kind::input, setting.name(), setting.value.substr(7)});
  }
  if (const auto points = save_points(settings))
    for (const SavePoint& point : points.value())
      uses.push_back({Kind::output, settings.checkpoint.save.name(), point.file});
  // What the settings' values do not say as they are.
  for (const std::string& file : sensor::files_of(settings.sensor.file()))
    uses.push_back({Kind::input, settings.sensor.file.name(), file});
  uses.push_back({Kind::input, "the program", program_of(settings.firmware)});
  for (const std::string& place : places_to_load(settings.firmware))
    uses.push_back({Kind::input, settings.firmware.load.name(), place.substr(0, place.rfind('@'))});
  uses.push_back({Kind::input, "the coprocessor's RTL", rtl_library(settings.coprocessor)});
  if (settings.coprocessor.backend() == Backend::lockstep && settings.coprocessor.waves.empty())
    uses.push_back({Kind::output, "the waves of --coprocessor lockstep",
                    lockstep_waves(settings.coprocessor)});
  add_save_file(settings, uses);
  return uses;
}

}  // namespace capsoc::run
