// Named settings with one precedence for all: command line, environment, file, built-in.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"

namespace capsoc {

/// Where a setting's value comes from; a later one wins.
enum class SettingSource { built_in, file, environment, command_line };

/// What a value must look like. Files are told apart by what the run does with them, so that no
/// output can be one of its inputs; a backend is a UART's (file:PATH, pty:LINK, ...).
enum class SettingKind { text, input, output, directory, backend, number, integer, choice, flag };

/// What a setting decides on.
enum class Bearing {
  result,  ///< what comes out
  host,    ///< how fast the host gets there, when it ends, what it is compared with
  place,   ///< where something goes
};

/// The option of the command line that sets a setting.
struct SettingOption {
  enum class Form {
    value,
    list,           ///< may be repeated; the setting has all, separated by commas
    flag,           ///< takes no value: `implied` is set
    optional_value  ///< without one, `implied` is set
  };
  std::string name;      ///< "--json"; without dashes: a positional argument; "": there is none
  std::string argument;  ///< as the help shows it: "FILE.csv"
  std::string help;
  Form form = Form::value;
  std::string implied = {};
};

/// One setting of the platform, for instance `coprocessor.arithmetic`, and its declaration.
struct Setting {
  std::string path;
  SettingKind kind;
  std::string value;  ///< as text; numbers in the unit that `help` names
  std::string help;
  std::vector<std::string> choices;  ///< for SettingKind::choice
  double minimum = 0, maximum = 0;   ///< for numbers, both inclusive
  SettingSource source = SettingSource::built_in;
  bool optional = false;    ///< without a value unless it is set: then no part of results
  std::string option = {};  ///< that gave the value, "--json"; "" unless an option of its own did
  std::string origin = {};  ///< what set it, as error sentences begin: "-C a=b", a file and line
  Bearing bearing = Bearing::result;
  SettingOption command = {};

  // For declarations (setting_fields.h).
  Setting in(double least, double most) &&;
  Setting is_place() &&;
  Setting is_host_side() &&;
  Setting by(SettingOption declared) &&;

  bool is_path() const {
    return kind == SettingKind::input || kind == SettingKind::output ||
           kind == SettingKind::directory;
  }
  /// As a sentence names it.
  const std::string& name() const { return option.empty() ? path : option; }
};

/// Settings whose names are known only later: every `prefix` followed by a name (lower-case
/// letters, digits, '_'). They are texts here and checked by the part that knows them.
struct SettingGroup {
  std::string prefix;  ///< with its last dot
  std::string help;
};

/// Turns the text of one setting into its value, where it is set: a field (setting_fields.h).
class SettingParser {
 public:
  /// What is wrong with a text, as the end of a sentence that begins with the setting's path. A
  /// text that is right is taken if `take`, else only looked at.
  virtual std::optional<std::string> parse(const std::string& text, bool take) = 0;
  /// What a text that is taken stands for, which becomes the value.
  virtual std::string meaning(const std::string& text) const { return text; }

 protected:
  SettingParser() = default;
  SettingParser(const SettingParser&) = default;
  SettingParser& operator=(const SettingParser&) = default;
  ~SettingParser() = default;
};

/// The settings of a run. Every refused value is a sentence that names where it came from.
class Settings {
 public:
  Settings() = default;
  Settings(const Settings&) = delete;  // the fields of what is made from it point into it
  Settings& operator=(const Settings&) = delete;

  /// Returns its number in all(). The parser lives as long as the settings; without one the setting
  /// is a text that its user reads.
  std::size_t add(Setting setting, SettingParser* parser = nullptr);
  void add(SettingGroup group) { groups_.push_back(std::move(group)); }

  /// Sets a value if nothing of higher precedence has set it. `origin` begins the error sentence
  /// ("-C", a file and line).
  std::optional<Error> set(const std::string& path, const std::string& value, SettingSource source,
                           const std::string& origin);
  /// As if nothing had been set since all of them were declared. For many runs in turn: to
  /// declare them again takes far longer.
  void forget_values();
  /// "path=value" as `-C` takes it.
  std::optional<Error> set_assignment(const std::string& assignment);
  /// CAPSOC_<PATH> with dots as underscores, for instance CAPSOC_SENSOR_FILE. Unknown CAPSOC_ names
  /// are errors.
  std::optional<Error> read_environment(char** environment);
  /// A TOML file whose tables and keys are the paths.
  std::optional<Error> read_file(const std::string& file);

  /// By a name that the user gave; null if there is none. A part that knows the setting has its
  /// field (setting_fields.h).
  const Setting* find(const std::string& path) const;
  const std::vector<Setting>& all() const { return settings_; }
  const std::vector<SettingGroup>& groups() const { return groups_; }
  /// Those of a group that were set, in the order in which they first were.
  std::vector<Setting> of_group(const std::string& prefix) const;

 private:
  /// The setting of a group that a variable names.
  std::optional<std::string> path_in_group(const std::string& environment) const;
  /// Makes a place for a setting of a group; false if the path is none.
  bool add_of_group(const std::string& path);

  std::vector<Setting> settings_;
  std::vector<SettingParser*> parsers_;  // next to settings_
  std::vector<std::string> built_in_;    // values of those that are declared, which come first
  std::vector<SettingGroup> groups_;
};

/// The name of a source, as results and listings print it.
const char* name_of(SettingSource source);

}  // namespace capsoc
