#include "inputs/program_values.h"

#include <fmt/format.h>

#include <cstring>

#include "base/printable.h"
#include "inputs/run_inputs.h"

namespace capsoc::run {
namespace {

using loader::ProgramSetting;
using loader::ProgramSettings;

std::string names_of(const ProgramSettings& program) {
  std::string names;
  for (const ProgramSetting& setting : program.all())
    names += (names.empty() ? "" : ", ") + setting.name;
  return names;
}

Error unknown(const Setting& wanted, const std::string& name, const std::string& file,
              const ProgramSettings& program) {
  if (program.all().empty())
    return Error{
        fmt::format("{}: {} has no settings; firmware/common/program_settings.h makes some",
                    wanted.origin, file)};
  return Error{fmt::format("{}: {} has no setting '{}'; it has {}", wanted.origin, file,
                           printable(name), names_of(program))};
}

}  // namespace

Result<ProgramSettings> change_program(const FirmwareSettings& settings, loader::ElfImage& image) {
  const std::vector<Setting> wanted = settings.all.of_group(program_prefix);
  auto read = ProgramSettings::read(image);
  // Without a setting of the program, an unreadable table is no reason to refuse the program.
  if (!read && wanted.empty()) return ProgramSettings();
  if (!read) return Error{read.error()};
  ProgramSettings& program = read.value();
  for (const Setting& setting : wanted) {
    const std::string name = setting.path.substr(std::strlen(program_prefix));
    const ProgramSetting* found = program.find(name);
    if (found == nullptr) return unknown(setting, name, image.path, program);
    if (auto error = program.set(*found, setting.value, setting.origin)) return *error;
  }
  program.write(image);
  return std::move(program);
}

Result<std::string> list_program_settings(const FirmwareSettings& settings) {
  auto image = read_program(settings);
  if (!image) return Error{image.error()};
  const auto damage = ProgramSettings::read(image.value());
  if (!damage) return Error{damage.error()};
  const auto program = change_program(settings, image.value());
  if (!program) return Error{program.error()};
  if (program.value().all().empty())
    return Error{fmt::format("{} has no settings; firmware/common/program_settings.h makes some",
                             image.value().path)};
  std::string text;
  for (const ProgramSetting& setting : program.value().all()) {
    const Setting* given = settings.all.find(program_prefix + setting.name);
    const SettingSource source = given != nullptr ? given->source : SettingSource::built_in;
    text += fmt::format("{:<21} {:<11} {:<8} {:<26} {:<13} {}\n", setting.name,
                        printable(program.value().value(setting), 200), setting.unit,
                        program.value().range(setting), name_of(source), setting.help);
  }
  return text;
}

}  // namespace capsoc::run
