#include "inputs/input_settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "base/number.h"
#include "base/printable.h"
#include "host/places.h"
#include "sensor/description_keys.h"

namespace capsoc::run {
namespace {

/// The default sensor as a file that can be edited, or else what is built in.
std::string default_sensor() {
  const std::string file = host::data_path("traces/soc_eq21.toml");
  std::error_code ignored;
  return std::filesystem::exists(file, ignored) ? file : std::string(sensor::built_in_default);
}

}  // namespace

std::string ProgramField::meaning(const std::string& text) const {
  std::error_code ignored;
  if (text.find('/') != std::string::npos || std::filesystem::exists(text, ignored)) return text;
  // A campaign asks for one program hundreds of thousands of times, and to look for it takes dozens
  // of calls of the system.
  struct Known {
    std::string text, path;
    std::filesystem::path folder;
  };
  thread_local Known last;
  const std::filesystem::path folder = std::filesystem::current_path(ignored);
  if (text == last.text && folder == last.folder &&
      std::filesystem::is_regular_file(last.path, ignored))
    return last.path;
  for (const char* ending : {"", ".elf"})
    if (std::string known = host::data_path("firmware/" + text + ending);
        std::filesystem::is_regular_file(known, ignored)) {
      last = {text, known, folder};
      return known;
    }
  return text;
}

FirmwareSettings::FirmwareSettings(Settings& settings)
    : all(settings),
      elf(all,
          setting("firmware.elf", SettingKind::input, host::data_path("firmware/selfcal.elf"),
                  "program for the Cortex-M3: a file, or the name of one that comes with capsoc")
              .by({"elf", "ELF",
                   "Program for the Cortex-M3: ELF, Intel HEX, or the name of one that comes with "
                   "capsoc (default: selfcal)"})) {
  all.add(SettingGroup{program_prefix, "a setting of the program (--list-program-settings)"});
}

SensorSettings::SensorSettings(Settings& settings)
    : all(settings),
      file(all, setting("sensor.file", SettingKind::input, default_sensor(),
                        "sensor description or recording; -: standard input")
                    .by({"--sensor", "FILE",
                         "Sensor description (TOML) or recording (text, WAV, MAT, SDS); -: "
                         "standard input"})) {
  for (const sensor::DescriptionKey& key : sensor::description_keys()) {
    Setting declared = setting("sensor." + key.name(), SettingKind::text, "", key.help);
    declared.optional = true;
    all.add(std::move(declared));
  }
  all.add(SettingGroup{std::string("sensor.") + sensor::harmonics_prefix,
                       "a harmonic of the description: u3_amplitude, v12_phase_rad"});
}

std::vector<sensor::KeyValue> SensorSettings::keys() const {
  std::vector<sensor::KeyValue> keys;
  const std::string prefix = "sensor.";
  const std::vector<const SettingField*> own = {&file, &adc_bits, &columns, &full_scale,
                                                &zero, &scale,    &further};
  const auto is_own = [&own](const Setting& setting) {
    return std::any_of(own.begin(), own.end(), [&](const SettingField* field) {
      return setting.path == field->about().path;
    });
  };
  for (const Setting& setting : all.of_group(prefix))
    if (setting.source != SettingSource::built_in && !is_own(setting))
      keys.push_back({setting.path.substr(prefix.size()), setting.value, setting.origin});
  return keys;
}

Result<sensor::RecordingOptions> SensorSettings::recording() const {
  sensor::RecordingOptions options;
  options.columns = columns();
  options.automatic_scale = scale() == "auto";
  if (!scale.empty() && !options.automatic_scale)
    return Error{fmt::format("{} cannot be '{}'; give auto, or a unit by --full-scale and --zero",
                             scale.name(), printable(scale()))};
  for (const auto& [field, number] :
       {std::pair(&full_scale, &options.full_scale), std::pair(&zero, &options.zero)}) {
    if (field->empty()) continue;
    *number = finite_number(field->text());
    if (!*number)
      return Error{
          fmt::format("{} cannot be '{}'; give a number", field->name(), printable(field->text()))};
  }
  return options;
}

}  // namespace capsoc::run
