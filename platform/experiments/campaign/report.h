// What a campaign shows: yield, distributions, the worst runs, what depends on what.
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "campaign/statistics.h"
#include "campaign/store.h"

namespace capsoc::campaign {

struct CriterionReport {
  std::string name, expression;
  uint64_t met = 0;
};

struct MetricReport {
  std::string name, expression;
  uint64_t missing = 0;                             ///< finished runs that have no such number
  std::optional<Summary> summary;                   ///< nothing if all are missing
  std::vector<std::optional<Sensitivity>> to_axes;  ///< in the order of Report::axes
};

/// Runs of one value of what the report tells apart.
struct GroupReport {
  uint64_t runs = 0, passed = 0;
  std::map<std::string, uint64_t> exits;  ///< how many of them ended how
};
struct ByReport {
  std::string name, expression;
  std::map<std::string, GroupReport> groups;  ///< by value; finished runs

  /// The values, those with most failures first.
  std::vector<std::string> order() const;
};

/// A run to look at.
struct Example {
  uint64_t number = 0;
  std::vector<std::string> values;  ///< of the axes
  std::string exit;                 ///< Judged::exit
  std::vector<std::string> unmet;   ///< criteria
  std::optional<double> worst;      ///< of the metric that orders them
  std::string command;
};

/// Of at most `most` finished runs, evenly taken in the order of their numbers.
struct Sample {
  static constexpr std::size_t most = 2000;
  uint64_t of = 0;  ///< finished runs
  std::vector<uint64_t> runs;
  std::vector<bool> passed;
  std::vector<std::vector<std::string>> axes;               ///< by axis: what each run was given
  std::vector<std::vector<std::optional<double>>> metrics;  ///< by metric
};

struct Report {
  std::string name, kind, version;
  std::vector<std::string> axes;
  uint64_t planned = 0, done = 0, finished = 0, passed = 0;
  double least_yield = 1;
  double wall_s = 0;                 ///< of all workers together
  std::optional<Interval> interval;  ///< of the yield, 95 %; nothing without runs
  std::vector<CriterionReport> criteria;
  std::vector<MetricReport> metrics;
  std::vector<ByReport> by;
  std::map<std::string, uint64_t> exits;  ///< how many runs ended how
  std::string worst_metric;               ///< "" without
  std::vector<Example> worst;             ///< its largest values first
  std::vector<Example> failures;          ///< the first ones
  Sample sample;

  double yield() const {
    return done == 0 ? 0 : static_cast<double>(passed) / static_cast<double>(done);
  }
  /// All runs are done, and enough of them passed.
  bool reaches_yield() const { return done == planned && done > 0 && yield() >= least_yield; }
};

/// Error: the store has no plan, or is damaged.
Result<Report> make_report(const Store& store);

std::string to_text(const Report& report);
/// Its keys are documented in docs/guide/campaigns.md.
nlohmann::ordered_json to_json(const Report& report);
/// A test case for each run that is done.
Result<std::string> to_junit(const Store& store);

}  // namespace capsoc::campaign
