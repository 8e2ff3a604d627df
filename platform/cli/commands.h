// The subcommands. Each adds itself to the application and leaves its exit code in `code` when it
// was chosen.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace capsoc::cli {

void add_run(CLI::App& app, int& code);
/// With those options of settings alone that are among the command line's words.
void add_run(CLI::App& app, int& code, const std::vector<std::string>& words);
/// run with a page for a browser.
void add_view(CLI::App& app, int& code);
void add_fit(CLI::App& app, int& code);
void add_info(CLI::App& app, int& code);
void add_reproduce(CLI::App& app, int& code);
void add_accuracy(CLI::App& app, int& code);
void add_bench(CLI::App& app, int& code);
void add_regress(CLI::App& app, int& code);
void add_campaign(CLI::App& app, int& code);
void add_report(CLI::App& app, int& code);
void add_serve(CLI::App& app, int& code);
void add_replay(CLI::App& app, int& code);
void add_new(CLI::App& app, int& code);
void add_generate(CLI::App& app, int& code);

}  // namespace capsoc::cli
