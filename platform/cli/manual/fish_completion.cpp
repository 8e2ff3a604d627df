#include <fmt/format.h>

#include "manual/pages.h"

namespace capsoc::manual {
namespace {

/// Inside single quotes of fish, where a backslash escapes a quote and itself.
std::string quoted(const std::string& text) {
  return "'" + replaced(replaced(text, "\\", "\\\\"), "'", "\\'") + "'";
}

/// -x: a value and no files; -r -F: a value that is a file.
std::string value_flags(const Option& option, const std::string& program) {
  if (!option.takes_value) return "";
  if (option.value.setting) return fmt::format(" -x -a '(__{}_settings)'", program);
  std::string choices =
      option.value.choices.empty() ? "" : " -a " + quoted(joined(option.value.choices, " "));
  if (option.may_lack_value) return choices;
  return (option.value.file ? " -r -F" : " -x") + choices;
}

std::string name_flags(const Option& option) {
  std::string text;
  for (const std::string& name : option.names)
    text += name.rfind("--", 0) == 0 ? " -l " + name.substr(2) : " -s " + name.substr(1);
  return text;
}

std::string completions(const Command& command, const std::string& program) {
  const std::string begin =
      fmt::format("complete -c {} -n '__{}_at {}'", program, program, joined(command.path, " "));
  std::string text;
  for (const Command& inner : command.commands)
    text += begin + " -a " + inner.path.back() + " -d " + quoted(inner.help) + "\n";
  for (const Option& option : command.options) {
    if (option.names.empty() && option.value.file)
      text += begin + " -F\n";
    else if (!option.names.empty())
      text += begin + name_flags(option) + value_flags(option, program) + " -d " +
              quoted(option.help) + "\n";
  }
  return text;
}

/// Candidates for the word path=value under the cursor.
std::string settings_for_fish(const CommandLine& line, const std::string& program) {
  std::string text = fmt::format(
      "\nfunction __{}_settings\n  set -l word (commandline -ct)\n  switch $word\n", program);
  std::string paths;
  for (const Setting& setting : line.settings) {
    const Value value = value_of(setting);
    if (value.file)
      text += fmt::format(
          "    case '{0}=*'\n      for file in (__fish_complete_path (string replace {0}= '' -- "
          "$word))\n        echo {0}=$file\n      end\n",
          setting.path);
    else
      text += fmt::format("    case '{}=*'\n", setting.path);
    for (const std::string& choice : value.choices)
      text += fmt::format("      echo {}\n", quoted(setting.path + "=" + choice));
    paths += fmt::format("      printf '%s\\t%s\\n' {}= {}\n", setting.path, quoted(setting.help));
  }
  return text + "    case '*'\n" + paths + "  end\nend\n";
}

/// Which command the words before the cursor name.
std::string command_finder(const CommandLine& line, const std::string& program) {
  std::string cases;
  for (const Command* command : all_commands(line.program))
    if (command->path.size() > 1) cases += " " + quoted(joined(command->path, " "));
  return fmt::format(
      "\nfunction __{0}_at\n  set -l words (commandline -opc)\n  set -l command {0}\n  for word in "
      "$words[2..-1]\n    switch \"$command $word\"\n      case{1}\n        set command \"$command "
      "$word\"\n    end\n  end\n  test \"$command\" = \"$argv\"\nend\n\n",
      program, cases);
}

}  // namespace

Page fish_completion(const CommandLine& line) {
  const std::string& program = line.program.path.front();
  std::string text =
      fmt::format("# Completion of fish, made by {} from its command line.\n", program) +
      settings_for_fish(line, program) + command_finder(line, program) +
      fmt::format("complete -c {} -f\n", program);
  for (const Command* command : all_commands(line.program)) text += completions(*command, program);
  return {fmt::format("fish/vendor_completions.d/{}.fish", program), text};
}

}  // namespace capsoc::manual
