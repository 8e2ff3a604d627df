#include <fmt/format.h>

#include <string_view>

#include "manual/pages.h"

namespace capsoc::manual {

// completion.bash: asks the functions PROGRAM_commands, _options, _value and _setting, which are
// tables. A kind is "words ...", "files [.suffix]", "settings" or "text", after "maybe" when an
// option's value may be left out.
extern const std::string_view bash_driver;

namespace {

std::string kind_of(const Value& value) {
  if (value.setting) return "settings";
  if (!value.choices.empty()) return "words " + joined(value.choices, " ");
  if (value.file) return value.suffix.empty() ? "files" : "files " + value.suffix;
  return "text";
}

std::string kind_of(const Option& option) {
  return (option.may_lack_value ? "maybe " : "") + kind_of(option.value);
}

std::string function(const std::string& name, const std::string& body) {
  return fmt::format("\n{}() {{\n{}}}\n", name, body);
}

/// A function that prints what stands next to its argument in a table.
std::string table(const std::string& name,
                  const std::vector<std::pair<std::string, std::string>>& rows) {
  std::string body = "  case $1 in\n";
  for (const auto& [key, text] : rows)
    body += fmt::format("    {}) echo {} ;;\n", in_quotes(key), in_quotes(text));
  return function(name, body + "  esac\n");
}

}  // namespace

Page bash_completion(const CommandLine& line) {
  std::vector<std::pair<std::string, std::string>> commands, options, values, settings;
  for (const Command* command : all_commands(line.program)) {
    const std::string name = joined(command->path, " ");
    std::vector<std::string> inner, names;
    for (const Command& each : command->commands) inner.push_back(each.path.back());
    for (const Option& option : command->options) {
      names.insert(names.end(), option.names.begin(), option.names.end());
      if (option.names.empty()) values.emplace_back(name + " ", kind_of(option));
      if (option.takes_value)
        for (const std::string& each : option.names)
          values.emplace_back(joined({name, each}, " "), kind_of(option));
    }
    if (!inner.empty()) commands.emplace_back(name, joined(inner, " "));
    options.emplace_back(name, joined(names, " "));
  }
  std::string paths;
  for (const Setting& setting : line.settings) {
    paths += " " + setting.path;
    settings.emplace_back(setting.path, kind_of(value_of(setting)));
  }
  const std::string text =
      "# Completion of bash, made by PROGRAM from its command line.\n" +
      table("_PROGRAM_commands", commands) + table("_PROGRAM_options", options) +
      table("_PROGRAM_value", values) + table("_PROGRAM_setting", settings) +
      function("_PROGRAM_settings", "  echo" + paths + "\n") + std::string(bash_driver);
  const std::string& program = line.program.path.front();
  return {"bash-completion/completions/" + program, replaced(text, "PROGRAM", program)};
}

}  // namespace capsoc::manual
