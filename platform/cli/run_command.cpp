// capsoc run: the firmware on the SoC, with a sensor.
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "base/printable.h"
#include "cli/commands.h"
#include "cli/refuse.h"
#include "cli/session_end.h"
#include "cli/setting_option.h"
#include "host/end_signals.h"
#include "host/file_uses.h"
#include "host/files.h"
#include "inject/places.h"
#include "inputs/program_values.h"
#include "report/page.h"
#include "service/session_run.h"
#include "session/run_files.h"
#include "session/run_settings.h"
#include "session/simulation.h"
#include "view/view.h"

namespace capsoc::cli {
namespace {

/// What an option of the command line said, as text; Settings checks it.
struct Given {
  std::string setting, value;
  std::string option = "command line";  ///< that gave it, as sentences name it
  Given(std::string path, std::string text) : setting(std::move(path)), value(std::move(text)) {}
  Given(std::string path, std::string text, std::string name)
      : setting(std::move(path)), value(std::move(text)), option(std::move(name)) {}
};

/// The command `view`, as the origin of what it sets.
constexpr const char* viewed = "view";

struct RunArguments {
  std::vector<Given> options;
  std::vector<std::string> assignments;
  std::string config;
  std::vector<std::string> program_assignments;
  bool list = false, list_program = false, list_places = false;
  std::string story;  ///< of the page; "": none
};

void list_settings(const Settings& settings) {
  for (const Setting& setting : settings.all())
    host::print("{:<26} {:<22} {:<13} {}\n", setting.path, setting.value, name_of(setting.source),
                setting.help);
  for (const SettingGroup& group : settings.groups())
    host::print("{:<26} {:<22} {:<13} {}\n", group.prefix + "NAME", "", "", group.help);
}

std::optional<Error> set_program_setting(Settings& settings, const std::string& assignment) {
  const std::string origin = "-P " + printable(assignment, 80);
  const auto equals = assignment.find('=');
  const std::string path = run::program_prefix + assignment.substr(0, equals);
  if (equals == std::string::npos || equals == 0)
    return Error{fmt::format("{}: write name=value, for instance -P step=0.001", origin)};
  if (auto error =
          settings.set(path, assignment.substr(equals + 1), SettingSource::command_line, origin);
      error && settings.find(path) == nullptr)
    return Error{
        fmt::format("{}: names are lower-case letters, digits and '_'; "
                    "--list-program-settings lists them",
                    origin)};
  return std::nullopt;
}

/// The settings file, or "".
std::string config_of(const RunArguments& arguments) {
  const char* named = std::getenv("CAPSOC_CONFIG");
  return arguments.config.empty() && named != nullptr ? named : arguments.config;
}

/// What a story sets, between what its command gives and what the user does.
std::optional<Error> set_options(const RunArguments& arguments, const view::Story* story,
                                 Settings& settings) {
  const auto set = [&](const Given& given) {
    return settings.set(given.setting, given.value, SettingSource::command_line, given.option);
  };
  const auto own = std::find_if(arguments.options.begin(), arguments.options.end(),
                                [](const Given& given) { return given.option != viewed; });
  for (auto given = arguments.options.begin(); given != own; ++given)
    if (auto error = set(*given)) return error;
  if (story != nullptr) {
    if (auto error = set({"run.realtime", fmt::format("{}", story->speed), "--story"}))
      return error;
    for (const auto& [path, value] : story->settings)
      if (auto error = set({path, value, "--story"})) return error;
  }
  for (auto given = own; given != arguments.options.end(); ++given)
    if (auto error = set(*given)) return error;
  return std::nullopt;
}

std::optional<Error> collect(const RunArguments& arguments, const view::Story* story,
                             Settings& settings) {
  const std::string config = config_of(arguments);
  if (!config.empty())
    if (auto error = settings.read_file(config)) return error;
  if (auto error = settings.read_environment(environ)) return error;
  if (auto error = set_options(arguments, story, settings)) return error;
  for (const std::string& assignment : arguments.assignments)
    if (auto error = settings.set_assignment(assignment)) return error;
  for (const std::string& assignment : arguments.program_assignments)
    if (auto error = set_program_setting(settings, assignment)) return error;
  return std::nullopt;
}

/// Before anything is opened: no output is another file of the run, and what is written at the end
/// can be.
std::optional<Error> check_files(const RunArguments& arguments, const run::RunSettings& settings) {
  std::vector<host::FileUse> uses = run::files_of(settings);
  uses.push_back({host::FileUse::Kind::input, "--config", config_of(arguments)});
  if (auto error = host::check_uses(uses)) return error;
  for (const TextField* place : {&settings.results.json, &settings.results.html,
                                 &settings.results.record, &settings.results.session})
    if (!place->empty())
      if (auto error = host::check_writable(place->text())) return error;
  return std::nullopt;
}

/// The result file and the report that is drawn from it: both or neither.
std::optional<Error> write_results(nlohmann::ordered_json result,
                                   const run::RunSettings& settings) {
  const std::string &json_file = settings.results.json(), &html_file = settings.results.html();
  if (json_file.empty() && html_file.empty()) return std::nullopt;
  std::vector<host::TextFile> files;
  std::vector<report::ResultFile> results(1);
  results.front().json = std::move(result);
  if (!json_file.empty()) files.push_back({json_file, run::to_text(results.front().json)});
  if (!html_file.empty()) files.push_back({html_file, report::page_of(results)});
  return host::write_together(files);
}

/// With a page, a debugger that can go back, or a session that can be simulated again.
int run_in_session(const run::RunSettings& settings, const view::Choices* choices,
                   const view::Story* story) {
  const bool is_on_failure = settings.gdb.on_failure() >= 0;
  if (is_on_failure && (settings.gdb.port() >= 0 || settings.view.port() >= 0))
    return refuse(fmt::format("{} waits where the run fails: leave {} out",
                              settings.gdb.on_failure.about().name(),
                              settings.gdb.port() >= 0 ? settings.gdb.port.about().name()
                                                       : settings.view.port.about().name()));
  if (settings.gdb.history_mb() > 0 && settings.gdb.port() < 0 && !is_on_failure)
    return refuse(
        fmt::format("{} is for a debugger: add --gdb", settings.gdb.history_mb.about().name()));
  const bool is_viewed = settings.view.port() >= 0;
  const auto finished =
      is_viewed ? view::run_in_view(settings, choices, story) : service::run_in_session(settings);
  if (!finished) return refuse(finished.error(), code_of_refusal());
  service::Json answer = finished.value();
  const int code = tell_end(answer);
  if (!answer.contains("result")) return code;
  if (auto error = write_results(answer.at("result"), settings))
    return refuse(error->text, code == run::exit_code::pass ? run::exit_code::lost : code);
  return code;
}

/// What a campaign of faults draws from.
int list_fault_places(const run::RunSettings& settings) {
  const auto simulation = run::Simulation::construct(settings);
  if (!simulation) return refuse(simulation.error());
  nlohmann::ordered_json places = nlohmann::ordered_json::array();
  uint64_t bits = 0;
  for (const inject::ListedPlace& place : simulation.value()->fault_places()) {
    places.push_back(inject::to_json(place));
    bits += place.bits;
  }
  host::print("{}", run::to_text({{"bits", bits}, {"places", std::move(places)}}));
  return run::exit_code::pass;
}

int run_command(const RunArguments& arguments, run::RunSettings& settings) {
  const view::Story* story = nullptr;
  if (!arguments.story.empty()) {
    const auto found = view::find_story(arguments.story);
    if (!found) return refuse("--story: " + found.error());
    story = found.value();
  }
  if (auto error = collect(arguments, story, settings)) return refuse(error->text);
  if (arguments.list) {
    list_settings(settings);
    return run::exit_code::pass;
  }
  if (arguments.list_program) {
    const auto text = run::list_program_settings(settings.firmware);
    if (!text) return refuse(text.error());
    host::print("{}", text.value());
    return run::exit_code::pass;
  }
  spdlog::set_level(settings.log_level());
  if (arguments.list_places) return list_fault_places(settings);

  if (auto error = check_files(arguments, settings)) return refuse(error->text);
  if (settings.results.keep_last_s() > 0 && settings.results.session.empty())
    return refuse(fmt::format("{} is the end of a recorded session; add {} FILE",
                              settings.results.keep_last_s.about().name(),
                              settings.results.session.about().command.name));
  if (settings.view.port() >= 0) {
    run::RunSettings plain;
    if (auto error = collect(arguments, nullptr, plain)) return refuse(error->text);
    const view::Choices choices(plain);
    return run_in_session(settings, &choices, story);
  }
  if (settings.gdb.memory_mb() > 0 || !settings.results.session.empty())
    return run_in_session(settings, nullptr, nullptr);
  auto result = run::run(settings);
  if (!result) return refuse(result.error(), code_of_refusal());
  const run::RunResult& r = result.value();
  if (!r.divergence.empty()) host::say("\n{}", r.divergence);
  if (!r.fault_report.empty()) host::say("\n{}", r.fault_report);
  if (!r.place_report.empty()) host::say("\n{}", r.place_report);
  for (const std::string& sentence : r.lost) host::say("capsoc: {}\n", sentence);
  host::say("{}", run::to_table(r));
  if (auto error = write_results(run::to_json(r, settings), settings))
    return refuse(error->text, r.code == run::exit_code::pass ? run::exit_code::lost : r.code);
  return r.code;
}

/// True if the command line may set it: it is no option, or one of the words.
bool may_be_set(const SettingOption& option, const std::vector<std::string>& words) {
  if (option.name.rfind('-', 0) != 0) return true;
  return std::any_of(words.begin(), words.end(), [&](const std::string& word) {
    return word.compare(0, word.find('='), option.name) == 0;
  });
}

/// A command that runs firmware, and what it has given before the command line is read.
struct RunCommand {
  const char *name, *help;
  std::vector<Given> given = {};
};

const RunCommand plain_run = {
    "run", "Run firmware on the SoC; without arguments: calibrate the sensor of Eq (21)"};

/// Ten times as fast as the shaft turns: a person sees it learn, and the main job takes 42 s.
const RunCommand viewed_run = {
    viewed,
    "As run --view --realtime 10: show the run live on a page for a browser",
    {{"view.port", "0", viewed}, {"run.realtime", "10", viewed}}};

/// Declares the command with the options of those settings that `is_needed`.
void declare_run(CLI::App& app, int& code, const RunCommand& command,
                 const std::function<bool(const SettingOption&)>& is_needed) {
  auto arguments = std::make_shared<RunArguments>();
  arguments->options = command.given;
  CLI::App* run = app.add_subcommand(command.name, command.help);
  auto settings = std::make_shared<run::RunSettings>();
  for (const Setting& setting : settings->all())
    if (!setting.command.name.empty() && is_needed(setting.command))
      add_setting_option(
          *run, setting,
          [arguments](const std::string& path, const std::string& value, const std::string& given) {
            arguments->options.emplace_back(path, value, given);
          });
  run->add_option("--config", arguments->config, "Settings from a TOML file")->type_name("FILE");
  run->add_option("-C", arguments->assignments, "Set any setting")
      ->type_name("PATH=VALUE")
      ->allow_extra_args(false);
  run->add_option("-P", arguments->program_assignments,
                  "Change a setting of the program in its image; may be repeated")
      ->type_name("NAME=VALUE")
      ->allow_extra_args(false);
  if (std::string_view(command.name) == viewed)
    run->add_option("--story", arguments->story,
                    "Tell a story: text at some times of a run (docs/guide/view.md lists them)")
        ->type_name("NAME");
  run->add_flag("--list-program-settings", arguments->list_program,
                "List the settings that the program has, with units and ranges");
  run->add_flag("--list-fault-places", arguments->list_places,
                "List what --inject can change, as JSON: places, bits, units");
  run->add_flag("--list-params", arguments->list,
                "List all settings with their values and where these come from");
  run->callback([arguments, settings, &code] { code = run_command(*arguments, *settings); });
}

}  // namespace

void add_run(CLI::App& app, int& code) {
  declare_run(app, code, plain_run, [](const SettingOption&) { return true; });
}

void add_view(CLI::App& app, int& code) {
  declare_run(app, code, viewed_run, [](const SettingOption&) { return true; });
}

void add_run(CLI::App& app, int& code, const std::vector<std::string>& words) {
  declare_run(app, code, plain_run,
              [&words](const SettingOption& option) { return may_be_set(option, words); });
}

}  // namespace capsoc::cli
