#include "campaign/work_settings.h"

#include <fmt/format.h>

#include <map>

#include "base/printable.h"
#include "host/file_uses.h"
#include "host/sha256.h"
#include "session/run_files.h"

namespace capsoc::campaign {

std::optional<Error> set_all(const std::vector<Assignment>& assignments, Settings& settings) {
  for (const Assignment& each : assignments) {
    if (auto error = settings.set(each.path, each.value, SettingSource::command_line, each.origin))
      return error;
    // Runs side by side would write over each other.
    if (const Setting* setting = settings.find(each.path);
        setting != nullptr && setting->bearing == Bearing::place)
      return Error{fmt::format(
          "{}: {} says where something goes, and a campaign keeps results itself; remove it, or "
          "use [keep]",
          each.origin, printable(each.path))};
  }
  return std::nullopt;
}

std::string settings_identity(const Settings& settings) {
  std::string text;
  for (const Setting& setting : settings.all()) {
    const bool unset = setting.optional && setting.source == SettingSource::built_in;
    if (unset || setting.bearing == Bearing::place || setting.kind == SettingKind::input) continue;
    text += setting.path + "=" + setting.value + "\n";
  }
  return text;
}

std::string input_identity(const std::string& path) {
  static std::map<std::string, std::string> hashes;
  auto known = hashes.find(path);
  if (known == hashes.end()) known = hashes.emplace(path, host::sha256_of_file(path)).first;
  return "input=" + (known->second.empty() ? path : known->second) + "\n";
}

std::string run_identity(const run::RunSettings& settings) {
  std::string text = settings_identity(settings);
  for (const host::FileUse& use : run::files_of(settings))
    if (use.kind == host::FileUse::Kind::input && !use.path.empty())
      text += input_identity(use.path);
  return text;
}

}  // namespace capsoc::campaign
