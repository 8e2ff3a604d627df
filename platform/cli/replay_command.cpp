// capsoc replay: a recorded session simulated again and compared (docs/reference/protocol.md).
#include <fmt/format.h>

#include <memory>
#include <optional>
#include <string>

#include "base/input_file.h"
#include "cli/commands.h"
#include "cli/refuse.h"
#include "host/console.h"
#include "host/end_signals.h"
#include "results/results.h"
#include "service/recording.h"
#include "service/session_file.h"

namespace capsoc::cli {
namespace {

struct ReplayArguments {
  std::string file;
  std::optional<double> until_s;
};

int replay(const ReplayArguments& arguments) {
  const InputLimits limits{"name a file that simulation.record wrote",
                           service::SessionFile::largest, false};
  const auto bytes = read_input(arguments.file, limits);
  if (!bytes) return refuse(bytes.error());
  const auto session = service::unpack_session(bytes.value(), arguments.file);
  if (!session) return refuse(session.error());
  host::note_end_signals();
  const auto replayed = service::replay(session.value(), arguments.until_s,
                                        [](const std::string& text) { host::print("{}", text); });
  if (!replayed) return refuse(replayed.error());
  const service::Replayed& outcome = replayed.value();
  if (const int signal = host::noted_signal(); signal != 0)
    return run::exit_code::signal_base + signal;
  if (!outcome.difference.empty())
    return refuse(fmt::format("{}: {}", arguments.file, outcome.difference),
                  run::exit_code::failed);
  host::say(
      "capsoc: {}: the same until {:.12g} s: {} inputs, {} states compared, and what "
      "each UART sent\n",
      arguments.file, outcome.end_s, outcome.inputs, outcome.marks);
  return run::exit_code::pass;
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
  command->callback([arguments, &code] { code = replay(*arguments); });
}

}  // namespace capsoc::cli
