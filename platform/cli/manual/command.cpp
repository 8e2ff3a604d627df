#include "manual/command.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "base/split.h"

namespace capsoc::manual {
namespace {

bool starts_with(const std::string& text, const std::string& start) {
  return text.compare(0, start.size(), start) == 0;
}

/// FILE, FILE.csv, FILE[@ADDR] and the like.
bool names_file(const std::string& type_name) {
  static const std::vector<std::string> words = {"FILE", "ELF", "TRACE", "DIR", "PATH"};
  return std::any_of(words.begin(), words.end(), [&](const std::string& word) {
    const char after = type_name[std::min(word.size(), type_name.size())];
    return starts_with(type_name, word) && std::isalnum(static_cast<unsigned char>(after)) == 0 &&
           after != '=';
  });
}

/// One of the words between bars: "file:PATH" is the word "file:", "tcp[:PORT]" may also be "tcp".
void add_choice(Value& value, const std::string& word) {
  const auto bracket = word.find('['), colon = word.find(':');
  if (names_file(word)) {
    value.file = true;
    return;
  }
  if (word.empty()) return;
  if (bracket != std::string::npos) value.choices.push_back(word.substr(0, bracket));
  if (colon != std::string::npos)
    value.choices.push_back(word.substr(0, std::min(bracket, colon)) + ":");
  else if (bracket == std::string::npos)
    value.choices.push_back(word);
}

std::string range_of(const std::string& description) {
  const auto begin = description.find(" in [");
  if (begin == std::string::npos || description.back() != ']') return "";
  std::string range = description.substr(begin + 5, description.size() - begin - 6);
  if (const auto dash = range.find(" - "); dash != std::string::npos)
    range.replace(dash, 3, " to ");
  return range;
}

}  // namespace

Value read_value(const std::string& type_name, const std::string& description) {
  Value value;
  value.name = type_name;
  value.range = range_of(description);
  value.setting = type_name == "PATH=VALUE";
  if (description.size() > 2 && description.front() == '{' && description.back() == '}') {
    value.choices = split(description.substr(1, description.size() - 2), ',');
    value.name = joined(value.choices, "|");
  } else if (type_name.find('|') != std::string::npos) {
    for (const std::string& word : split(type_name, '|')) add_choice(value, word);
  } else if (names_file(type_name) || names_file(description)) {
    value.file = true;
    const auto dot = type_name.find('.');
    if (dot != std::string::npos) value.suffix = type_name.substr(dot);
  }
  return value;
}

Value value_of(const Setting& setting) {
  Value value;
  value.choices = setting.choices;
  value.file = setting.is_path();
  switch (setting.kind) {
    case SettingKind::choice:
      value.name = joined(setting.choices, "|");
      break;
    case SettingKind::flag:
      value.choices = {"true", "false"};
      value.name = "true|false";
      break;
    case SettingKind::input:
    case SettingKind::output:
    case SettingKind::directory:
      value.name = "FILE";
      break;
    case SettingKind::number:
    case SettingKind::integer:
      value.name = "NUMBER";
      value.range = fmt::format("{} to {}", setting.minimum, setting.maximum);
      break;
    case SettingKind::text:
    case SettingKind::backend:
      value.name = "TEXT";
      break;
  }
  return value;
}

std::string joined(const std::vector<std::string>& words, const std::string& between) {
  std::string text;
  for (const std::string& word : words) text += (&word == words.data() ? "" : between) + word;
  return text;
}

std::vector<const Command*> all_commands(const Command& command) {
  std::vector<const Command*> all = {&command};
  for (const Command& inner : command.commands)
    for (const Command* each : all_commands(inner)) all.push_back(each);
  return all;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
  return text;
}

std::string in_quotes(const std::string& text) {
  return "'" + replaced(text, "'", "'\\''") + "'";
}

}  // namespace capsoc::manual
