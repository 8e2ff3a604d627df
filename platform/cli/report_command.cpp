// capsoc report: results as a page for a browser.
#include <fmt/format.h>

#include <memory>

#include "cli/commands.h"
#include "cli/refuse.h"
#include "cli/whole_number.h"
#include "host/console.h"
#include "host/file_uses.h"
#include "host/files.h"
#include "report/page.h"
#include "run/results.h"

namespace capsoc::cli {
namespace {

struct ReportArguments {
  std::vector<std::string> results;
  std::string html;
  bool list = false;
};

void list_figures() {
  for (const report::Figure& figure : report::figures())
    host::print("{:<24} {:<10} {}{}\n", figure.name, figure.command, figure.title,
                figure.papers.empty() ? "" : " (" + figure.papers + ")");
}

/// No output is one of the results, and all of them can be written.
std::optional<Error> check_files(const ReportArguments& arguments) {
  using Kind = host::FileUse::Kind;
  std::vector<host::FileUse> uses = {{Kind::output, "--html", arguments.html}};
  for (const std::string& result : arguments.results)
    uses.push_back({Kind::input, "RESULT", result});
  if (auto error = host::check_uses(uses)) return error;
  return arguments.html.empty() ? std::nullopt : host::check_writable(arguments.html);
}

int report_command(const ReportArguments& arguments) {
  if (arguments.list) {
    list_figures();
    return run::exit_code::pass;
  }
  if (arguments.results.empty())
    return refuse("report needs a RESULT.json that a command wrote by --json; try --help");
  if (arguments.html.empty()) return refuse("report: name a place, --html FILE");
  if (auto error = check_files(arguments)) return refuse(error->text);
  std::vector<report::ResultFile> results;
  for (const std::string& path : arguments.results) {
    auto result = report::read_result(path);
    if (!result) return refuse(result.error());
    results.push_back(std::move(result.value()));
  }
  // Alone it needs no name: then the page is the one that the command itself writes.
  if (results.size() == 1) results.front().label.clear();
  if (!arguments.html.empty())
    if (auto error = host::write_whole(arguments.html, report::page_of(results)))
      return refuse(error->text, run::exit_code::lost);
  return run::exit_code::pass;
}

}  // namespace

void add_report(CLI::App& app, int& code) {
  auto arguments = std::make_shared<ReportArguments>();
  CLI::App* report = app.add_subcommand(
      "report", "Draw results as one HTML file that a browser shows without a network");
  report
      ->add_option("results", arguments->results,
                   "Files that commands wrote by --json; several of one command side by side")
      ->type_name("RESULT.json");
  report->add_option("--html", arguments->html, "Where the report goes")
      ->type_name("FILE")
      ->check(not_empty());
  report->add_flag("--list-figures", arguments->list,
                   "List the figures, whose results have them, and which of the papers' they are");
  report->callback([arguments, &code] { code = report_command(*arguments); });
}

}  // namespace capsoc::cli
