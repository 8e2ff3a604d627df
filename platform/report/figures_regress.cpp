// The figures of `capsoc regress`, and of the mutation score next to it.
#include <fmt/format.h>

#include <algorithm>

#include "report/figure.h"

namespace capsoc::report {
namespace {

constexpr std::size_t most_waves = 8;
/// Clocks by scenario, over all seeds.
Data scenarios(const Figure&, const Json& result) {
  Data data;
  for (const char* arithmetic : arithmetics) {
    const auto runs = elements_at(result, {"arithmetics", arithmetic, "runs"});
    if (runs.empty()) continue;
    std::vector<double> cycles(data.labels.size(), 0);
    for (const Json* run : runs) {
      const std::string name = text_at(*run, {"scenario"});
      const auto found = std::find(data.labels.begin(), data.labels.end(), name);
      const auto place = static_cast<std::size_t>(found - data.labels.begin());
      if (found == data.labels.end()) data.labels.push_back(name);
      cycles.resize(data.labels.size(), 0);
      cycles[place] += number_at(*run, {"cycles"}).value_or(0);
    }
    Series series{arithmetic, {}};
    for (std::size_t i = 0; i < cycles.size(); ++i)
      series.curve.add(static_cast<double>(i), cycles[i]);
    data.series.push_back(std::move(series));
  }
  return data;
}

Data rtl_coverage(const Figure&, const Json& result) {
  Data data;
  for (const char* arithmetic : arithmetics) {
    const Json* kinds = find(result, {"arithmetics", arithmetic, "rtl_coverage"});
    if (kinds == nullptr || !kinds->is_object()) continue;
    Series series{arithmetic, {}};
    for (const auto& [kind, points] : kinds->items()) {
      const auto all = number_at(points, {"points"}), covered = number_at(points, {"covered"});
      const double excepted = number_at(points, {"excepted"}).value_or(0);
      if (!all || !covered || *all <= excepted) continue;
      const auto found = std::find(data.labels.begin(), data.labels.end(), kind);
      const auto place = found - data.labels.begin();
      if (found == data.labels.end()) data.labels.push_back(kind);
      series.curve.add(static_cast<double>(place), 100 * *covered / (*all - excepted));
    }
    if (!series.curve.x.empty()) data.series.push_back(std::move(series));
  }
  return data;
}

/// The difference of the first run that has one.
const Json* first_difference(const Json& result) {
  for (const char* arithmetic : arithmetics)
    for (const Json* run : elements_at(result, {"arithmetics", arithmetic, "runs"}))
      if (const Json* difference = find(*run, {"difference"}); difference != nullptr)
        return difference;
  return nullptr;
}

/// One node on both sides, clock by clock.
Data wave(const Figure& figure, const Json& result) {
  const Json* difference = first_difference(result);
  if (difference == nullptr) return {};
  const auto waves = elements_at(*difference, {"waves"});
  const auto number = static_cast<std::size_t>(figure.name.back() - '1');
  if (number >= waves.size()) return {};
  const double first = number_at(*difference, {"first_cycle"}).value_or(0);
  const double cycle = number_at(*difference, {"cycle"}).value_or(0);
  const std::string node = text_at(*waves[number], {"node"});
  Data data;
  for (const char* side : {"model", "rtl"}) {
    Series series{node + (side == std::string("rtl") ? ", RTL" : ", model"), {}};
    for (const Json* value : elements_at(*waves[number], {side})) {
      const double at = first + static_cast<double>(series.curve.x.size()) - cycle;
      series.curve.add(at, number_at(*value, {}).value_or(0));
    }
    if (!series.curve.x.empty()) data.series.push_back(std::move(series));
  }
  return data;
}

Data mutation_score(const Figure&, const Json& result) {
  Data data;
  for (const char* arithmetic : arithmetics) {
    const Json* files = find(result, {"arithmetics", arithmetic, "files"});
    if (files == nullptr || !files->is_object()) continue;
    Series series{arithmetic, {}};
    for (const auto& [file, counts] : files->items()) {
      const double killed = number_at(counts, {"killed"}).value_or(0);
      const double decided = killed + number_at(counts, {"survived"}).value_or(0);
      const auto found = std::find(data.labels.begin(), data.labels.end(), file);
      const auto place = found - data.labels.begin();
      if (found == data.labels.end()) data.labels.push_back(file);
      if (decided > 0) series.curve.add(static_cast<double>(place), 100 * killed / decided);
    }
    if (!series.curve.x.empty()) data.series.push_back(std::move(series));
  }
  if (!data.series.empty()) data.marks.push_back({"least", 95});
  return data;
}

}  // namespace

void add_regress_figures(std::vector<Figure>& list) {
  for (std::size_t i = 1; i <= most_waves; ++i)
    list.push_back({fmt::format("regress-wave-{}", i), "regress", "First difference",
                    fmt::format("Node {} around the first difference", i),
                    "The model's and the RTL's value clock by clock; 0 is the clock of the "
                    "difference. The first node is the one that went wrong first.",
                    "", "clocks from the difference", "value", Kind::steps, false, wave});
  list.push_back({"regress-scenarios", "regress", "Scenarios", "Clocks compared by scenario",
                  "Over all seeds, in both arithmetics.", "", "scenario", "clocks", Kind::bars,
                  true, scenarios});
  list.push_back({"regress-rtl-coverage", "regress", "Coverage of the RTL", "Coverage of the RTL",
                  "Covered points of those that can be reached.", "", "kind", "%", Kind::bars,
                  false, rtl_coverage});
  list.push_back({"mutation-score", "mutation", "Mutation score", "Mutation score by source file",
                  "Mutants of the RTL that the regression notices, of those that are no "
                  "equivalents.",
                  "", "file", "%", Kind::bars, false, mutation_score});
}

}  // namespace capsoc::report
