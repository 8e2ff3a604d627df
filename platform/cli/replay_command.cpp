// capsoc replay: a recorded session simulated again and compared (docs/reference/protocol.md).
#include <fmt/format.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/commands.h"
#include "cli/refuse.h"
#include "cli/session_end.h"
#include "cli/setting_option.h"
#include "host/console.h"
#include "host/end_signals.h"
#include "host/file_uses.h"
#include "results/results.h"
#include "service/part_traces.h"
#include "service/recording.h"
#include "service/session_run.h"
#include "session/run_settings.h"
#include "view/view.h"

namespace capsoc::cli {
namespace {

struct ReplayArguments {
  std::string file;
  std::optional<double> until_s;
  std::string gdb_port, view_port;  ///< "": no debugger, no page
  service::PartTraceSettings traces;
  std::optional<Error> wrong_trace;
};

/// A debugger or a page has it from its first instruction on, with a history.
int replay_in_session(const ReplayArguments& arguments) {
  const bool is_viewed = !arguments.view_port.empty();
  if (is_viewed && !arguments.gdb_port.empty())
    return refuse("--view: a debugger cannot steer the same run; leave out --gdb");
  if (arguments.until_s)
    return refuse(
        fmt::format("--until: {}; leave it out", is_viewed ? "a page stops where the user says"
                                                           : "a debugger stops where it wants"));
  for (const Setting& trace : arguments.traces.all.all())
    if (trace.source == SettingSource::command_line)
      return refuse(fmt::format("{}: {} goes back and forth; trace a replay without it",
                                trace.name(), is_viewed ? "a page" : "a debugger"));
  run::RunSettings settings;
  std::vector<std::pair<std::string, std::string>> values = {
      {settings.gdb.port.about().path, arguments.gdb_port},
      {settings.gdb.halt.about().path, "true"}};
  if (is_viewed)
    values = {{settings.view.port.about().path, arguments.view_port},
              {settings.limits.realtime.about().path, "10"}};
  const char* const option = is_viewed ? "--view" : "--gdb";
  for (const auto& [path, value] : values)
    if (auto error = settings.set(path, value, SettingSource::command_line, option))
      return refuse(error->text);
  if ((is_viewed ? settings.view.port : settings.gdb.port)() < 0)
    return refuse(fmt::format("{}: a port is 0 (a free one) to 65535", option));
  auto finished = is_viewed ? view::replay_in_view(settings, arguments.file)
                            : service::run_in_session(settings, arguments.file);
  if (!finished) return refuse(finished.error(), code_of_refusal());
  return tell_end(finished.value());
}

int replay(const ReplayArguments& arguments) {
  if (arguments.wrong_trace) return refuse(arguments.wrong_trace->text);
  std::vector<host::FileUse> uses = arguments.traces.outputs();
  uses.push_back({host::FileUse::Kind::input, "the session", arguments.file});
  if (auto error = host::check_uses(uses)) return refuse(error->text);
  if (!arguments.gdb_port.empty() || !arguments.view_port.empty())
    return replay_in_session(arguments);
  const auto session = service::read_session(arguments.file);
  if (!session) return refuse(session.error());
  host::note_end_signals();
  const auto replayed = service::replay(session.value(), arguments.until_s, arguments.traces,
                                        [](const std::string& text) { host::print("{}", text); });
  if (!replayed) return refuse(replayed.error());
  const service::Replayed& outcome = replayed.value();
  if (const int signal = host::noted_signal(); signal != 0)
    return run::exit_code::signal_base + signal;
  for (const std::string& sentence : outcome.lost) host::say("capsoc: {}\n", sentence);
  if (!outcome.difference.empty())
    return refuse(fmt::format("{}: {}", arguments.file, outcome.difference),
                  run::exit_code::failed);
  host::say(
      "capsoc: {}: the same until {:.12g} s: {} inputs, {} states compared, and what "
      "each UART sent\n",
      arguments.file, outcome.end_s, outcome.inputs, outcome.marks);
  return outcome.lost.empty() ? run::exit_code::pass : run::exit_code::lost;
}

}  // namespace

void add_replay(CLI::App& app, int& code) {
  auto arguments = std::make_shared<ReplayArguments>();
  CLI::App* command = app.add_subcommand(
      "replay", "Simulates a recorded session again and names the first difference");
  command->add_option("session", arguments->file, "A file that simulation.record wrote")
      ->type_name("FILE")
      ->required();
  command->add_option("--until", arguments->until_s, "Only to this simulated time, s")
      ->type_name("T")
      ->check(CLI::Range(0.0, 1e6));
  command
      ->add_option("--gdb", arguments->gdb_port,
                   "Wait for a debugger at this port of 127.0.0.1 (0: a free one); it can go back, "
                   "and each input comes at its instant")
      ->type_name("PORT");
  command
      ->add_option(
          "--view", arguments->view_port,
          "Show it live on a page for a browser, at this port of 127.0.0.1 (0: a free one)")
      ->type_name("PORT");
  for (const Setting& trace : arguments->traces.all.all())
    if (!trace.command.name.empty())
      add_setting_option(*command, trace,
                         [arguments](const std::string& path, const std::string& value,
                                     const std::string& option) {
                           auto error = arguments->traces.all.set(
                               path, value, SettingSource::command_line, option);
                           if (!arguments->wrong_trace) arguments->wrong_trace = std::move(error);
                         });
  command->callback([arguments, &code] { code = replay(*arguments); });
}

}  // namespace capsoc::cli
