// A report: one HTML file that needs nothing else, drawn from results alone.
#pragma once

#include <string>
#include <vector>

#include "report/figure.h"

namespace capsoc::report {

/// One page of all results, side by side where they are of one command. The same results give the
/// same bytes. No script runs in it but its own two, whatever the results hold.
std::string page_of(const std::vector<ResultFile>& results);

/// What a command adds to the page: sections as HTML, with `figure_section(name)` where the
/// figures of a section belong.
class Page {
 public:
  explicit Page(const std::vector<ResultFile>& results);

  const std::vector<ResultFile>& results() const { return results_; }

  /// The figures of a section that the results have anything for, as HTML; their data goes into the
  /// page.
  std::string figures_of(const std::string& command, const std::string& section);

  /// Nothing if there is nothing below it.
  void add(const std::string& title, const std::string& body);
  /// The same piece of every result of a command, side by side, each below its file's name.
  std::string of_each(const std::string& command, std::string (*piece)(const Json& result)) const;

  std::string text() const;

 private:
  const std::vector<ResultFile>& results_;
  std::string body_, contents_, data_;
  int sections_ = 0;
};

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
