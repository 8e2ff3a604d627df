#include "run/run_settings.h"

#include <fmt/format.h>

namespace capsoc::run {
namespace {

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
    if (setting.bearing == Bearing::place) continue;
    text += fmt::format(" -C {}", quoted(setting.path + "=" + setting.value));
  }
  return text;
}

}  // namespace capsoc::run
