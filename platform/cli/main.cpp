// capsoc: the command line. stdout carries UART 0 and what was asked for; everything else goes to
// stderr.
#include <fmt/format.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <systemc>

#include "cli/commands.h"
#include "cli/exit_codes.h"
#include "run/results.h"
#include "support/nearest.h"
#include "version/version.h"

namespace {

using namespace capsoc;

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
  for (const cli::ExitCodeText& exit : cli::exit_codes)
    text += fmt::format("\n  {:<7} {}", exit.code, exit.meaning);
  return text;
}

}  // namespace

int sc_main(int argc, char* argv[]) {
  spdlog::set_default_logger(spdlog::stderr_logger_mt("capsoc"));
  spdlog::set_pattern("%l: %v");
  spdlog::set_level(spdlog::level::warn);

  CLI::App app{
      "capsoc: a virtual prototype of a system-on-chip that calibrates angle sensors by itself",
      "capsoc"};
  app.set_version_flag("--version", fmt::format("capsoc {} (commit {})", version(), commit()));
  app.require_subcommand(1);
  app.footer(exit_code_text());
  int code = run::exit_code::internal;
  cli::add_run(app, code);
  cli::add_fit(app, code);
  cli::add_info(app, code);
  cli::add_reproduce(app, code);
  cli::add_accuracy(app, code);
  cli::add_bench(app, code);
  cli::add_regress(app, code);
  cli::add_generate(app, code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) {
    return app.exit(success);  // --help and --version
  } catch (const CLI::ParseError& error) {
    fmt::print(stderr, "capsoc: {}\n", sentence(app, error));
    return run::exit_code::usage;
  } catch (const std::exception& error) {
    fmt::print(stderr, "capsoc: internal error: {}; please report it with the command line\n",
               error.what());
    return run::exit_code::internal;
  }
  return code;
}

int main(int argc, char* argv[]) {
  setenv("SYSTEMC_DISABLE_COPYRIGHT_MESSAGE", "1", 1);
  return sc_core::sc_elab_and_sim(argc, argv);
}
