// A report: one HTML file that needs nothing else, drawn from results alone.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "report/comparison.h"
#include "report/figure.h"

namespace capsoc::report {

/// One page of all results, side by side where they are of one command; of two of one command what
/// differs comes first. The same results give the
/// same bytes. No script runs in it but its own, whatever the results hold.
std::string page_of(const std::vector<ResultFile>& results);

/// What a command adds to the page: sections as HTML, with `figure_section(name)` where the
/// figures of a section belong.
class Page {
 public:
  explicit Page(const std::vector<ResultFile>& results);

  const std::vector<ResultFile>& results() const { return results_; }
  /// Nothing unless these are two results of one command.
  const std::optional<Comparison>& comparison() const { return comparison_; }

  /// The figures of a section that the results have anything for, as HTML; their data goes into the
  /// page.
  std::string figures_of(const std::string& command, const std::string& section);

  /// One figure by its name. No figure is in the page twice.
  std::string figure(const std::string& name);
  void leave_out(const std::vector<std::string>& figures);

  /// Nothing if there is nothing below it.
  void add(const std::string& title, const std::string& body);
  /// The same piece of every result of a command, side by side, each below its file's name.
  std::string of_each(const std::string& command, std::string (*piece)(const Json& result)) const;

  std::string text() const;

 private:
  std::string place(const Figure& figure);

  const std::vector<ResultFile>& results_;
  std::optional<Comparison> comparison_;
  std::set<std::string> done_;  ///< figures that are in the page, or not to be
  std::string body_, contents_, data_;
  int sections_ = 0;
};

/// Sentence and figures of the first screen.
std::string html_of(const Comparison& comparison);
void add_comparison_sections(Page& page, const Comparison& comparison);

// The sections of each command.
void add_run_sections(Page& page);
void add_fit_sections(Page& page);
void add_reproduce_sections(Page& page);
void add_accuracy_sections(Page& page);
void add_bench_sections(Page& page);
void add_regress_sections(Page& page);
void add_mutation_sections(Page& page);
void add_campaign_sections(Page& page);

/// Command, versions, inputs: what every result says of where it comes from.
std::string origin_of(const Json& result);

}  // namespace capsoc::report
