// A command line as man pages and shells' completions need it: what every command takes, as data.
#pragma once

#include <string>
#include <vector>

#include "base/settings.h"

namespace capsoc::manual {

/// What a value may be, as far as its declaration says so.
struct Value {
  std::string name;                  ///< as the help shows it: "FILE.csv", "paper|precise"
  std::string range;                 ///< "1 to 100", or ""
  std::vector<std::string> choices;  ///< words; one that ends with ':' continues with a path
  bool file = false;
  std::string suffix;    ///< of the file's name, or "" for any
  bool setting = false;  ///< path=value of a setting
};

/// An option, or a positional argument when it has no names.
struct Option {
  std::vector<std::string> names;  ///< with their dashes
  std::string group, help, built_in;
  Value value;
  bool takes_value = false, may_lack_value = false, repeats = false;
};

/// A command with its subcommands.
struct Command {
  std::vector<std::string> path;  ///< {"capsoc", "bench", "cpu"}
  std::string help;
  std::vector<Option> options;
  std::vector<Command> commands;
};

/// An exit code, or several in words, and what it says.
struct ExitCode {
  std::string code, meaning;
};

/// Everything that the pages are made from.
struct CommandLine {
  std::string version;
  Command program;
  std::vector<Setting> settings;
  std::vector<ExitCode> exit_codes;
};

/// What a type name ("FILE.csv", "paper|precise", "PATH=VALUE") and a validator's description
/// ("{paper,precise}", "INT in [1 - 100]", "FILE", or "") say.
Value read_value(const std::string& type_name, const std::string& description);

/// The same of a setting.
Value value_of(const Setting& setting);

/// The words of a command with `between` between them.
std::string joined(const std::vector<std::string>& words, const std::string& between);

/// `command` and all below it, the outer before the inner.
std::vector<const Command*> all_commands(const Command& command);

/// `text` with `to` wherever `from` was.
std::string replaced(std::string text, const std::string& from, const std::string& to);

/// `text` inside single quotes of a POSIX shell.
std::string in_quotes(const std::string& text);

}  // namespace capsoc::manual
