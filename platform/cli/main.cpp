// capsoc: the command line. stdout carries UART 0 and what was asked for; everything else goes to
// stderr.
#include <fmt/format.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <systemc>
#include <vector>

#include "base/nearest.h"
#include "cli/commands.h"
#include "cli/exit_codes.h"
#include "cli/refuse.h"
#include "host/console.h"
#include "host/end_signals.h"
#include "results/results.h"
#include "version/version.h"

namespace {

using namespace capsoc;

/// The log on standard error, which may be closed, full or left by its reader.
class LogSink final : public spdlog::sinks::base_sink<std::mutex> {
  void sink_it_(const spdlog::details::log_msg& message) override {
    spdlog::memory_buf_t text;
    formatter_->format(message, text);
    host::say(std::string_view(text.data(), text.size()));
  }
  void flush_() override {}
};

/// SystemC's own words, which it would print on standard output.
void report(const sc_core::sc_report& words, const sc_core::sc_actions& actions) {
  if ((actions & sc_core::SC_DISPLAY) != 0)
    host::say("{}\n", sc_core::sc_report_compose_message(words));
  sc_core::sc_report_handler::default_handler(words, actions & ~sc_core::SC_DISPLAY);
}

/// CLI11's complaint as one sentence, with the nearest known names for an unknown word.
std::string sentence(const CLI::App& app, const CLI::ParseError& error) {
  std::string text = error.what();
  for (char& c : text)
    if (c == '\n') c = ' ';
  while (!text.empty() && text.back() == ' ') text.pop_back();
  const CLI::App* active = &app;
  for (const CLI::App* sub : app.get_subcommands()) active = sub;
  const auto unknown = active->remaining(true);
  const auto all_unknown = app.remaining(true);
  if (!all_unknown.empty() && !all_unknown.front().empty()) {
    std::vector<std::string> known;
    for (const CLI::Option* option : active->get_options())
      for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
    for (const CLI::App* sub : app.get_subcommands([](const CLI::App*) { return true; }))
      if (active == &app && !sub->get_group().empty()) known.push_back(sub->get_name());
    if (!known.empty())
      return fmt::format("there is no '{}' here; did you mean {}?", all_unknown.front(),
                         nearest_names(all_unknown.front(), known));
  }
  return text + "; try --help";
}

std::string exit_code_text() {
  std::string text = "Exit codes:";
  for (const cli::ExitCodeText& exit : cli::exit_codes())
    text += fmt::format("\n  {:<7} {}", exit.code, exit.meaning);
  return text;
}

/// A command in the order of --help.
struct Command {
  std::string_view name;
  void (*add)(CLI::App& app, int& code);
  bool of_all = false;  ///< reads what the others declare
};

constexpr Command commands[] = {
    {"run", cli::add_run},
    {"view", cli::add_view},
    {"fit", cli::add_fit},
    {"info", cli::add_info},
    {"reproduce", cli::add_reproduce},
    {"accuracy", cli::add_accuracy},
    {"bench", cli::add_bench},
    {"regress", cli::add_regress},
    {"campaign", cli::add_campaign},
    {"report", cli::add_report},
    {"serve", cli::add_serve},
    {"replay", cli::add_replay},
    {"new", cli::add_new},
    {"generate", cli::add_generate, true},
};

void add_all(CLI::App& app, int& code) {
  for (const Command& command : commands) command.add(app, code);
}

/// What a line needs that is right: the options of the command that it begins with, and of the many
/// of `run` those that it names.
void add_needed(CLI::App& app, const std::vector<std::string>& words, int& code) {
  if (words.empty()) return add_all(app, code);
  if (words.front() == "run") return cli::add_run(app, code, words);
  for (const Command& command : commands)
    if (command.name == words.front() && !command.of_all) return command.add(app, code);
  add_all(app, code);
}

enum class Declared { needed, all };

/// What the command line asks for, as an exit code; none if that takes all declarations: help and
/// complaints.
std::optional<int> perform(int argc, char* argv[], Declared declared) {
  CLI::App app{
      "capsoc: a virtual prototype of a system-on-chip that calibrates angle sensors by itself",
      "capsoc"};
  app.set_version_flag("--version", fmt::format("capsoc {} (commit {})", version(), commit()));
  app.require_subcommand(1);
  app.footer(exit_code_text());
  int code = run::exit_code::internal;
  if (declared == Declared::all)
    add_all(app, code);
  else
    add_needed(app, {argv + std::min(argc, 1), argv + argc}, code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) {
    if (declared == Declared::needed) return std::nullopt;
    return app.exit(success);  // --help and --version
  } catch (const CLI::ParseError& error) {
    if (declared == Declared::needed) return std::nullopt;
    return cli::refuse(sentence(app, error));
  } catch (const std::exception& error) {
    return cli::refuse(
        fmt::format("internal error: {}; please report it with the command line", error.what()),
        run::exit_code::internal);
  }
  return code;
}

/// As an exit code. All options of all commands would take longer to declare than a short run.
int perform(int argc, char* argv[]) {
  const std::optional<int> code = perform(argc, argv, Declared::needed);
  return code ? *code : perform(argc, argv, Declared::all).value();
}

}  // namespace

int sc_main(int argc, char* argv[]) {
  spdlog::set_default_logger(
      std::make_shared<spdlog::logger>("capsoc", std::make_shared<LogSink>()));
  spdlog::set_pattern("%l: %v");
  spdlog::set_level(spdlog::level::warn);
  sc_core::sc_report_handler::set_handler(report);
  const int code = perform(argc, argv);
  // 74 says that only this failed; any other code says more.
  if (const auto error = host::finish_output())
    return cli::refuse(error->text, code == run::exit_code::pass ? run::exit_code::lost : code);
  return code;
}

int main(int argc, char* argv[]) {
  host::reserve_standard_streams();
  host::catch_end_signals(run::exit_code::lost);
  setenv("SYSTEMC_DISABLE_COPYRIGHT_MESSAGE", "1", 1);
  return sc_core::sc_elab_and_sim(argc, argv);
}
