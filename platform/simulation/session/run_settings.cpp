#include "session/run_settings.h"

#include <fmt/format.h>

#include "base/shell.h"

namespace capsoc::run {
std::string reproducing_command(const Settings& settings) {
  std::string text = "capsoc run";
  for (const Setting& setting : settings.all()) {
    if (setting.source == SettingSource::built_in) continue;
    if (setting.bearing == Bearing::place) continue;
    text += fmt::format(" -C {}", shell_word(setting.path + "=" + setting.value));
  }
  return text;
}

}  // namespace capsoc::run
