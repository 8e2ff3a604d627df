#include "base/settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <utility>

#include "base/input_file.h"
#include "base/nearest.h"
#include "base/printable.h"
#include "base/toml.h"

namespace capsoc {
namespace {

constexpr std::size_t usual_count = 160;  // that a run declares, and some
constexpr uint64_t largest_file = 1U << 20U;

std::string environment_name(const std::string& path) {
  std::string name = "CAPSOC_";
  for (char c : path)
    name += c == '.' ? '_' : static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return name;
}

/// A TOML value as the text that the command line would carry.
std::optional<std::string> text_of(const toml::node& node) {
  if (const auto* text = node.as_string()) return text->get();
  if (const auto* integer = node.as_integer()) return fmt::format("{}", integer->get());
  if (const auto* number = node.as_floating_point()) return fmt::format("{}", number->get());
  if (const auto* flag = node.as_boolean()) return std::string(flag->get() ? "true" : "false");
  return std::nullopt;
}

/// Calls `take` with path and value of everything below a table until it finds an error.
using Take = std::function<std::optional<Error>(const std::string&, const toml::node&)>;
std::optional<Error> each_value(const toml::table& table, const std::string& path,
                                const Take& take) {
  for (auto&& [key, value] : table) {
    const std::string inner = fmt::format("{}.{}", path, key.str());
    const toml::table* deeper = value.as_table();
    if (auto error = deeper != nullptr ? each_value(*deeper, inner, take) : take(inner, value))
      return error;
  }
  return std::nullopt;
}

}  // namespace

const char* name_of(SettingSource source) {
  switch (source) {
    case SettingSource::built_in:
      return "built-in";
    case SettingSource::file:
      return "file";
    case SettingSource::environment:
      return "environment";
    case SettingSource::command_line:
      return "command line";
  }
  return "";
}

Setting Setting::in(double least, double most) && {
  minimum = least;
  maximum = most;
  return std::move(*this);
}

Setting Setting::is_place() && {
  bearing = Bearing::place;
  return std::move(*this);
}

Setting Setting::is_host_side() && {
  bearing = Bearing::host;
  return std::move(*this);
}

Setting Setting::by(SettingOption declared) && {
  command = std::move(declared);
  return std::move(*this);
}

std::size_t Settings::add(Setting setting, SettingParser* parser) {
  if (settings_.empty()) settings_.reserve(usual_count);
  built_in_.push_back(setting.value);
  settings_.push_back(std::move(setting));
  parsers_.push_back(parser);
  return settings_.size() - 1;
}

void Settings::forget_values() {
  settings_.erase(settings_.begin() + static_cast<std::ptrdiff_t>(built_in_.size()),
                  settings_.end());
  parsers_.resize(built_in_.size());
  for (std::size_t i = 0; i < settings_.size(); ++i) {
    Setting& setting = settings_[i];
    if (setting.source == SettingSource::built_in) continue;
    setting.value = built_in_[i];
    setting.source = SettingSource::built_in;
    setting.option.clear();
    setting.origin.clear();
    if (parsers_[i] != nullptr) parsers_[i]->parse(setting.value, true);
  }
}

const Setting* Settings::find(const std::string& path) const {
  for (const Setting& setting : settings_)
    if (setting.path == path) return &setting;
  return nullptr;
}

std::optional<Error> Settings::set(const std::string& path, const std::string& value,
                                   SettingSource source, const std::string& origin) {
  for (std::size_t i = 0; i < settings_.size(); ++i) {
    Setting& setting = settings_[i];
    if (setting.path != path) continue;
    const bool wins = source >= setting.source;
    if (parsers_[i] != nullptr)
      if (const auto wrong = parsers_[i]->parse(value, wins))
        return Error{fmt::format("{}: {} {}", origin, path, *wrong)};
    if (wins) {
      setting.value = parsers_[i] != nullptr ? parsers_[i]->meaning(value) : value;
      setting.source = source;
      // These take any setting: its path says more.
      const bool general =
          origin == "command line" || origin == "settings" || origin.rfind("-C ", 0) == 0;
      setting.option = source == SettingSource::command_line && !general ? origin : "";
      setting.origin = origin;
    }
    return std::nullopt;
  }
  if (add_of_group(path)) return set(path, value, source, origin);
  std::vector<std::string> known;
  for (const Setting& setting : settings_) known.push_back(setting.path);
  return Error{
      fmt::format("{}: there is no setting '{}'; did you mean {}? (--list-params lists all)",
                  origin, printable(path), nearest_names(path, known))};
}

std::optional<std::string> Settings::path_in_group(const std::string& environment) const {
  for (const SettingGroup& group : groups_) {
    const std::string prefix =
        environment_name(group.prefix.substr(0, group.prefix.size() - 1)) + "_";
    if (environment.rfind(prefix, 0) != 0 || environment.size() == prefix.size()) continue;
    std::string path = group.prefix + environment.substr(prefix.size());
    for (char& c : path) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return path;
  }
  return std::nullopt;
}

bool Settings::add_of_group(const std::string& path) {
  const auto is_part_of_name = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
  };
  for (const SettingGroup& group : groups_) {
    if (path.rfind(group.prefix, 0) != 0 || path.size() == group.prefix.size()) continue;
    const auto name = path.begin() + static_cast<std::ptrdiff_t>(group.prefix.size());
    if (!std::all_of(name, path.end(), is_part_of_name)) return false;
    settings_.push_back({path, SettingKind::text, "", group.help, {}});
    parsers_.push_back(nullptr);
    return true;
  }
  return false;
}

std::vector<Setting> Settings::of_group(const std::string& prefix) const {
  std::vector<Setting> members;
  for (const Setting& setting : settings_)
    if (setting.path.rfind(prefix, 0) == 0) members.push_back(setting);
  return members;
}

std::optional<Error> Settings::set_assignment(const std::string& assignment) {
  const auto equals = assignment.find('=');
  if (equals == std::string::npos || equals == 0)
    return Error{fmt::format(
        "-C {}: write path=value, for instance -C coprocessor.arithmetic=paper", assignment)};
  return set(assignment.substr(0, equals), assignment.substr(equals + 1),
             SettingSource::command_line, "-C " + assignment);
}

std::optional<Error> Settings::read_environment(char** environment) {
  for (char** entry = environment; entry != nullptr && *entry != nullptr; ++entry) {
    if (std::strncmp(*entry, "CAPSOC_", 7) != 0) continue;
    const std::string text = *entry;
    const auto equals = text.find('=');
    const std::string name = text.substr(0, equals);
    if (name == "CAPSOC_CONFIG") continue;  // names the settings file itself
    const auto it = std::find_if(settings_.begin(), settings_.end(), [&](const Setting& s) {
      return environment_name(s.path) == name;
    });
    if (it == settings_.end()) {
      if (const auto path = path_in_group(name)) {
        if (auto error = set(*path, text.substr(equals + 1), SettingSource::environment,
                             "environment " + name))
          return error;
        continue;
      }
      std::vector<std::string> known;
      for (const Setting& setting : settings_) known.push_back(environment_name(setting.path));
      return Error{fmt::format("environment: there is no setting {}; did you mean {}?", name,
                               nearest_names(name, known))};
    }
    if (auto error = set(it->path, text.substr(equals + 1), SettingSource::environment,
                         "environment " + name))
      return error;
  }
  return std::nullopt;
}

std::optional<Error> Settings::read_file(const std::string& file) {
  const auto text = read_input(file, {"name a TOML file with settings", largest_file});
  if (!text) return Error{text.error()};
  const toml::parse_result parsed = toml::parse(text.value(), file);
  if (!parsed)
    return Error{fmt::format("{}:{}: {}; mend the TOML", file, parsed.error().source().begin.line,
                             printable(parsed.error().description(), 120))};
  const toml::table& root = parsed.table();
  for (auto&& [table_name, node] : root) {
    const auto line = [&](const toml::node& n) {
      return fmt::format("{}:{}", file, n.source().begin.line);
    };
    const toml::table* table = node.as_table();
    if (table == nullptr)
      return Error{fmt::format("{}: '{}' stands outside a table; write [{}] and keys below it",
                               line(node), printable(table_name.str()), "section")};
    const auto take = [&](const std::string& path, const toml::node& value) {
      const auto given = text_of(value);
      if (given) return set(path, *given, SettingSource::file, line(value));
      return std::optional<Error>(Error{fmt::format("{}: {} must be a text, a number or true/false",
                                                    line(value), printable(path))});
    };
    if (auto error = each_value(*table, std::string(table_name.str()), take)) return error;
  }
  return std::nullopt;
}

}  // namespace capsoc
