#include <fmt/format.h>

#include "manual/pages.h"

namespace capsoc::manual {
namespace {

/// A part of a specification of _arguments, in which colons and brackets mean something.
std::string part(std::string text) {
  for (const char* special : {"\\", ":", "[", "]"})
    text = replaced(text, special, std::string("\\") + special);
  return text;
}

/// What completes a value: the third part of a specification.
std::string action(const Value& value, const std::string& program) {
  if (value.setting) return "_" + program + "_settings";
  if (!value.choices.empty()) return "(" + part(joined(value.choices, " ")) + ")";
  if (value.file)
    return value.suffix.empty() ? "_files" : fmt::format("_files -g \"*{}\"", value.suffix);
  return "";
}

std::string value_part(const Option& option, const std::string& program) {
  return fmt::format("{}:{}:{}", option.may_lack_value ? ":" : "", part(option.value.name),
                     action(option.value, program));
}

/// The specifications of one option, one for each of its names.
std::string specification(const Option& option, const std::string& program) {
  if (option.names.empty())
    return "    " +
           in_quotes((option.repeats ? "*" : "") + value_part(option, program) +
                     (option.value.file ? "" : " ")) +
           " \\\n";
  std::string text;
  for (const std::string& name : option.names) {
    const std::string once = option.repeats ? "*" : "(" + part(joined(option.names, " ")) + ")";
    const bool is_long = name.rfind("--", 0) == 0;
    text += "    " +
            in_quotes(once + name + (option.takes_value && is_long ? "=" : "") + "[" +
                      part(option.help) + "]" +
                      (option.takes_value ? value_part(option, program) : "")) +
            " \\\n";
  }
  return text;
}

std::string function_name(const Command& command) {
  return "_" + joined(command.path, "_");
}

std::string function(const Command& command, const std::string& program) {
  const bool outer = !command.commands.empty();
  std::string text = fmt::format("\n{}() {{\n", function_name(command));
  if (outer)
    text +=
        "  local context state state_descr line curcontext=$curcontext\n"
        "  typeset -A opt_args\n";
  text += fmt::format("  _arguments{} \\\n", outer ? " -C" : "");
  for (const Option& option : command.options) text += specification(option, program);
  if (!outer) return text.substr(0, text.size() - 3) + "\n}\n";
  text += "    '1:command:->command' '*::argument:->argument'\n  case $state in\n    command)\n";
  text += "      local -a commands=(\n";
  for (const Command& inner : command.commands)
    text +=
        "        " + in_quotes(replaced(inner.path.back(), ":", "\\:") + ":" + inner.help) + "\n";
  text +=
      "      )\n      _describe command commands\n      ;;\n    argument)\n      case $words[1] "
      "in\n";
  for (const Command& inner : command.commands)
    text += fmt::format("        {}) {} ;;\n", inner.path.back(), function_name(inner));
  return text + "      esac\n      ;;\n  esac\n}\n";
}

std::string settings_for_zsh(const CommandLine& line, const std::string& program) {
  std::string text = fmt::format("\n_{}_settings() {{\n  _values setting \\\n", program);
  for (const Setting& setting : line.settings) {
    const Value value = value_of(setting);
    text += "    " +
            in_quotes(setting.path + "[" + part(setting.help) + "]:" + part(value.name) + ":" +
                      action(value, program)) +
            " \\\n";
  }
  return text.substr(0, text.size() - 3) + "\n}\n";
}

}  // namespace

Page zsh_completion(const CommandLine& line) {
  const std::string& program = line.program.path.front();
  std::string text = fmt::format(
      "#compdef {0}\n# Completion of zsh, made by {0} from its command line.\n", program);
  for (const Command* command : all_commands(line.program)) text += function(*command, program);
  text += settings_for_zsh(line, program);
  text += fmt::format("\n_{} \"$@\"\n", program);
  return {"zsh/site-functions/_" + program, text};
}

}  // namespace capsoc::manual
