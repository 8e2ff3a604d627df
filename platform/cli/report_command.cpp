// capsoc report: results as a page for a browser.
#include <fmt/format.h>

#include <memory>

#include "base/ends_with.h"
#include "base/nearest.h"
#include "base/printable.h"
#include "cli/commands.h"
#include "cli/refuse.h"
#include "cli/whole_number.h"
#include "host/console.h"
#include "host/file_uses.h"
#include "host/files.h"
#include "report/comparison.h"
#include "report/page.h"
#include "report/picture.h"
#include "results/results.h"

namespace capsoc::cli {
namespace {

struct ReportArguments {
  std::vector<std::string> results;
  std::string html, figure, plot;
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
  std::vector<host::FileUse> uses = {{Kind::output, "--html", arguments.html},
                                     {Kind::output, "--plot", arguments.plot}};
  for (const std::string& result : arguments.results)
    uses.push_back({Kind::input, "RESULT", result});
  if (auto error = host::check_uses(uses)) return error;
  for (const std::string& place : {arguments.html, arguments.plot})
    if (!place.empty())
      if (auto error = host::check_writable(place)) return error;
  return std::nullopt;
}

/// What is wrong with --figure and --plot, before anything is read.
std::optional<Error> check_plot(const ReportArguments& arguments) {
  if (arguments.plot.empty() && arguments.figure.empty()) return std::nullopt;
  if (arguments.plot.empty() || arguments.figure.empty())
    return Error{"--plot FILE and --figure NAME belong together; --list-figures names them"};
  if (report::figure_named(arguments.figure) == nullptr) {
    std::vector<std::string> known;
    for (const report::Figure& figure : report::figures()) known.push_back(figure.name);
    return Error{fmt::format("--figure {}: there is no such figure; did you mean {}?",
                             printable(arguments.figure), nearest_names(arguments.figure, known))};
  }
  if (!ends_with(arguments.plot, ".svg") && !ends_with(arguments.plot, ".png"))
    return Error{
        fmt::format("--plot {}: name a file .svg or .png", printable(arguments.plot, 200))};
  return std::nullopt;
}

std::optional<Error> plot(const ReportArguments& arguments,
                          const std::vector<report::ResultFile>& results) {
  const report::Figure& figure = *report::figure_named(arguments.figure);
  return report::write_picture(arguments.plot,
                               report::svg_of(figure, report::data_of(figure, results)));
}

/// The figure that was asked for has something to draw.
std::optional<Error> check_data(const ReportArguments& arguments,
                                const std::vector<report::ResultFile>& results) {
  if (arguments.figure.empty()) return std::nullopt;
  const report::Figure& figure = *report::figure_named(arguments.figure);
  if (!report::data_of(figure, results).series.empty()) return std::nullopt;
  return Error{fmt::format(
      "--figure {}: no result has anything for it; it is of capsoc {}, with --curves where it is "
      "a curve",
      figure.name, figure.command)};
}

/// What tells the results apart: the files' names, or the paths where these are the same.
void set_labels(std::vector<report::ResultFile>& results, const std::vector<std::string>& paths) {
  // Alone it needs no name: then the page is the one that the command itself writes.
  if (results.size() == 1) results.front().label.clear();
  if (results.size() != 2 || results[0].label != results[1].label) return;
  for (std::size_t i = 0; i < 2; ++i)
    results[i].label = paths[0] == paths[1] ? results[i].label + (i == 0 ? " (A)" : " (B)")
                                            : printable(paths[i], 200);
}

/// Files, or two results to compare: one of them is asked for.
std::optional<Error> check_wanted(const ReportArguments& arguments) {
  if (arguments.results.empty())
    return Error{"report needs a RESULT.json that a command wrote by --json; try --help"};
  if (!arguments.html.empty() || !arguments.plot.empty() || arguments.results.size() == 2)
    return std::nullopt;
  return Error{
      "report: name a place for the page, --html FILE, or for one figure, --figure NAME --plot "
      "FILE.svg; only two results of one command are compared without these"};
}

/// What differs between two results of one command, on standard output.
std::optional<Error> print_comparison(const ReportArguments& arguments,
                                      const std::vector<report::ResultFile>& results) {
  if (const auto comparison = report::compared(results)) {
    host::print("{}", report::text_of(*comparison));
    return std::nullopt;
  }
  if (!arguments.html.empty() || !arguments.plot.empty()) return std::nullopt;
  return Error{"report: " + report::reason_not_compared(results) +
               "; --html FILE makes one page of all"};
}

int report_command(const ReportArguments& arguments) {
  if (arguments.list) {
    list_figures();
    return run::exit_code::pass;
  }
  if (auto error = check_wanted(arguments)) return refuse(error->text);
  if (auto error = check_plot(arguments)) return refuse(error->text);
  if (auto error = check_files(arguments)) return refuse(error->text);
  std::vector<report::ResultFile> results;
  for (const std::string& path : arguments.results) {
    auto result = report::read_result(path);
    if (!result) return refuse(result.error());
    results.push_back(std::move(result.value()));
  }
  set_labels(results, arguments.results);
  if (auto error = check_data(arguments, results)) return refuse(error->text);
  if (auto error = print_comparison(arguments, results)) return refuse(error->text);
  if (!arguments.plot.empty())
    if (auto error = plot(arguments, results)) return refuse(error->text, run::exit_code::lost);
  if (!arguments.html.empty())
    if (auto error = host::write_whole(arguments.html, report::page_of(results)))
      return refuse(error->text, run::exit_code::lost);
  return run::exit_code::pass;
}

}  // namespace

void add_report(CLI::App& app, int& code) {
  auto arguments = std::make_shared<ReportArguments>();
  CLI::App* report = app.add_subcommand(
      "report",
      "Draw results as one HTML file that a browser shows without a network; of two results of one "
      "command, print what differs");
  report
      ->add_option(
          "results", arguments->results,
          "Files that commands wrote by --json; of two of one command what differs comes first")
      ->type_name("RESULT.json");
  report->add_option("--html", arguments->html, "Where the report goes")
      ->type_name("FILE")
      ->check(not_empty());
  report->add_option("--figure", arguments->figure, "A figure for --plot")->type_name("NAME");
  report->add_option("--plot", arguments->plot, "Where that figure goes alone, as SVG or PNG")
      ->type_name("FILE.svg|FILE.png")
      ->check(not_empty());
  report->add_flag("--list-figures", arguments->list,
                   "List the figures, whose results have them, and which of the papers' they are");
  report->callback([arguments, &code] { code = report_command(*arguments); });
}

}  // namespace capsoc::cli
