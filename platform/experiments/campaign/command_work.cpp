// A command of the user's own as a kind of work.
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <map>

#include "base/printable.h"
#include "base/setting_fields.h"
#include "base/shell.h"
#include "base/split.h"
#include "campaign/flat.h"
#include "campaign/kinds.h"
#include "campaign/work_settings.h"
#include "results/results.h"
#include "workers/command.h"

namespace capsoc::campaign {
namespace {

constexpr const char* value_prefix = "value.";
constexpr const char* output_key = "output";

/// Without the spaces around them, and without empty ones.
std::vector<std::string> words_of(const std::string& list) {
  std::vector<std::string> words;
  for (const std::string& part : split(list, ',')) {
    const std::size_t first = part.find_first_not_of(' ');
    if (first == std::string::npos) continue;
    words.push_back(part.substr(first, part.find_last_not_of(' ') + 1 - first));
  }
  return words;
}

/// Of a file its contents; of a folder all files with their names in it, in order.
std::string identity_of(const std::string& input) {
  namespace fs = std::filesystem;
  std::error_code none;
  if (!fs::is_directory(input, none)) return input_identity(input);
  std::vector<std::string> files;
  for (auto it = fs::recursive_directory_iterator(input, none); it != fs::end(it);
       it.increment(none))
    if (it->is_regular_file(none)) files.push_back(it->path().string());
  std::sort(files.begin(), files.end());
  std::string identity;
  for (const std::string& file : files)
    identity += file.substr(input.size()) + " " + input_identity(file);
  return identity;
}

class CommandSettings : public Settings {
 public:
  TextField line{*this, setting("command.line", SettingKind::text, "",
                                "what /bin/sh runs; it finds value.NAME in its variable NAME")};
  TextField inputs{*this, setting("command.inputs", SettingKind::text, "",
                                  "files and folders that decide on it, separated by commas: "
                                  "with other contents it is another run")};
  TextField results{*this, setting("command.results", SettingKind::text, "",
                                   "keys of the JSON object that it prints, separated by commas; "
                                   "empty: it prints none")};

  CommandSettings() { add(SettingGroup{value_prefix, "a variable of the command's"}); }

  workers::Variables variables() const {
    workers::Variables all;
    for (const Setting& value : of_group(value_prefix))
      all.emplace_back(value.path.substr(std::strlen(value_prefix)), value.value);
    return all;
  }
};

std::string command_of(const CommandSettings& settings) {
  std::string text;
  for (const auto& [name, value] : settings.variables())
    text += name + "=" + shell_word(value) + " ";
  return text + "/bin/sh -c " + shell_word(settings.line());
}

std::string first_line(const std::string& text) {
  return text.substr(0, text.find('\n'));
}

/// As a sentence begins.
std::string file_of(const std::vector<Assignment>& assignments) {
  if (assignments.empty()) return "";
  const std::string& origin = assignments.front().origin;
  return origin.substr(0, origin.rfind(':')) + ": ";
}

std::string reason_of(int code) {
  constexpr int signalled = 128;
  if (code == 0) return "success";
  return code > signalled ? fmt::format("signal {}", code - signalled) : "failure";
}

class CommandWork final : public Work {
 public:
  explicit CommandWork(std::vector<std::string> results) : results_(std::move(results)) {}

  Result<Job> prepare(const std::vector<Assignment>& assignments) override {
    settings_.forget_values();
    if (auto error = set_all(assignments, settings_)) return *error;
    if (settings_.line.empty())
      return Error{fmt::format("{}command.line is missing; write what to run in [settings]",
                               file_of(assignments))};
    if (words_of(settings_.results()) != results_)
      return Error{
          fmt::format("{}: command.results is the same in every run; move it to [settings]",
                      settings_.results.about().origin)};
    Job job;
    job.identity = settings_identity(settings_);
    for (const std::string& input : words_of(settings_.inputs()))
      job.identity += known_identity(input);
    job.command = command_of(settings_);
    return job;
  }

  std::optional<Error> check(const std::vector<Assignment>& assignments, const Keep&) override {
    CommandSettings settings;
    if (auto error = set_all(assignments, settings)) return error;
    const auto wrong = [](const TextField& field, const std::string& what) {
      return Error{fmt::format("{}: {}: {}", field.about().origin, field.about().path, what)};
    };
    for (const std::string& input : words_of(settings.inputs()))
      if (std::error_code none; !std::filesystem::exists(input, none))
        return wrong(settings.inputs,
                     "there is no " + printable(input) + "; make it first, or leave it out");
    if (auto error = workers::check_command(settings.line()))
      return wrong(settings.line, error->text);
    return std::nullopt;
  }

  Result<nlohmann::ordered_json> perform(const std::vector<Assignment>& assignments,
                                         const Keep&) override {
    CommandSettings settings;
    if (auto error = set_all(assignments, settings)) return *error;
    const auto end = workers::run_command(settings.line(), settings.variables());
    if (!end) return Error{end.error()};
    nlohmann::ordered_json j;
    j["exit"] = {{"code", end.value().code}, {"reason", reason_of(end.value().code)}};
    j["versions"] = run::versions();
    j["command"] = command_of(settings);
    j[output_key] = nlohmann::ordered_json::object();
    if (results_.empty()) return j;
    auto output = nlohmann::ordered_json::parse(end.value().output, nullptr, false);
    const bool passed = end.value().code == 0;  // another may have come to no result
    if (output.is_object())
      j[output_key] = std::move(output);
    else if (passed)
      return Error{fmt::format(
          "the command's standard output is no JSON object, '{}'; print one and the rest to stderr",
          printable(first_line(end.value().output), longest_shown))};
    const FlatResult has = flatten(j[output_key]);
    for (const std::string& name : results_)
      if (passed && has.find(name) == has.end())
        return Error{fmt::format("the command printed no '{}', which command.results names",
                                 printable(name))};
    return j;
  }

  nlohmann::ordered_json example() const override {
    nlohmann::ordered_json j;
    j["exit"] = {{"code", 0}, {"reason", "success"}};
    j["versions"] = run::versions();
    j["command"] = "some";
    for (const std::string& name : results_) j[output_key][name] = 0.0;
    return j;
  }

  const std::vector<std::string>& host_keys() const override {
    static const std::vector<std::string> none;
    return none;
  }

 private:
  /// All runs have the same inputs, as a rule.
  const std::string& known_identity(const std::string& input) {
    auto known = identities_.find(input);
    if (known == identities_.end()) known = identities_.emplace(input, identity_of(input)).first;
    return known->second;
  }

  static constexpr std::size_t longest_shown = 80;
  std::vector<std::string> results_;               // of every run
  std::map<std::string, std::string> identities_;  // of inputs
  CommandSettings settings_;                       // of one run after the other
};

}  // namespace

std::unique_ptr<Work> make_command_work(const std::vector<Assignment>& settings) {
  std::string results;
  for (const Assignment& each : settings)
    if (each.path == "command.results") results = each.value;
  return std::make_unique<CommandWork>(words_of(results));
}

}  // namespace capsoc::campaign
