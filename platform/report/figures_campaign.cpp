// The figures of `capsoc campaign`: distributions, what depends on what, any two columns.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "report/figure.h"

namespace capsoc::report {
namespace {

constexpr std::size_t most_metrics = 8;

/// Shares of the runs that are done: those that met each criterion, then those that passed, with
/// the interval.
Data yield(const Figure&, const Json& result) {
  const auto done = number_at(result, {"done"}), share = number_at(result, {"yield"});
  if (!done || !share || *done <= 0) return {};
  Data data;
  Series series{"runs", {}};
  const auto add = [&](const std::string& name, double value, double low, double high) {
    series.curve.add(static_cast<double>(data.labels.size()), 100 * value);
    series.low.push_back(100 * low);
    series.high.push_back(100 * high);
    data.labels.push_back(name);
  };
  for (const Json* each : elements_at(result, {"criteria"})) {
    const double met = number_at(*each, {"met"}).value_or(0) / *done;
    add(text_at(*each, {"name"}), met, met, met);
  }
  const auto ends = elements_at(result, {"yield_interval"});
  const auto end = [&](std::size_t i) {
    return i < ends.size() ? number_at(*ends[i], {}).value_or(*share) : *share;
  };
  add("all of them", *share, end(0), end(1));
  data.series.push_back(std::move(series));
  if (const auto wanted = number_at(result, {"least_yield"}))
    data.marks.push_back({"wanted", 100 * *wanted});
  return data;
}

/// "campaign-metric-3" is the third one.
Data distribution(const Figure& figure, const Json& result) {
  const auto metrics = elements_at(result, {"metrics"});
  const std::size_t number = std::stoul(figure.name.substr(figure.name.rfind('-') + 1));
  if (number > metrics.size()) return {};
  const Json& metric = *metrics[number - 1];
  const auto least = number_at(metric, {"histogram", "least"});
  const auto greatest = number_at(metric, {"histogram", "greatest"});
  const auto bins = elements_at(metric, {"histogram", "bins"});
  if (!least || !greatest || bins.empty()) return {};
  const bool wide = shown_at(metric, {"histogram", "logarithmic"}) == "true" && *least > 0;
  Data data;
  Series series{text_at(metric, {"name"}), {}};
  data.title = series.name + ": distribution";
  for (std::size_t i = 0; i < bins.size(); ++i) {
    const double part = static_cast<double>(i) / static_cast<double>(bins.size());
    const double from =
        wide ? *least * std::pow(*greatest / *least, part) : *least + (*greatest - *least) * part;
    data.labels.push_back(fmt::format("{:.3g}", from));
    series.curve.add(static_cast<double>(i), number_at(*bins[i], {}).value_or(0));
  }
  data.series.push_back(std::move(series));
  return data;
}

/// Shares of the variance, a set of bars for each metric.
Data dependence(const Figure&, const Json& result) {
  Data data;
  for (const Json* metric : elements_at(result, {"metrics"})) {
    const Json* axes = find(*metric, {"sensitivity"});
    if (axes == nullptr || !axes->is_object() || data.series.size() == most_metrics) continue;
    Series series{text_at(*metric, {"name"}), {}};
    for (const auto& [axis, values] : axes->items()) {
      const auto found = std::find(data.labels.begin(), data.labels.end(), axis);
      const auto place = found - data.labels.begin();
      if (found == data.labels.end()) data.labels.push_back(axis);
      if (const auto share = number_at(values, {"share"}))
        series.curve.add(static_cast<double>(place), 100 * *share);
    }
    if (!series.curve.x.empty()) data.series.push_back(std::move(series));
  }
  return data;
}

Column column_of(const std::string& name, const Json& values) {
  Column column{name, {}};
  const bool is_text = std::any_of(values.begin(), values.end(),
                                   [](const Json& value) { return value.is_string(); });
  for (const Json& value : values) {
    double number = std::numeric_limits<double>::quiet_NaN();
    if (is_text && !value.is_null()) {
      const std::string text = shown_at(value, {});
      const auto found = std::find(column.labels.begin(), column.labels.end(), text);
      number = static_cast<double>(found - column.labels.begin());
      if (found == column.labels.end()) column.labels.push_back(text);
    } else if (value.is_boolean()) {
      number = value.get<bool>() ? 1 : 0;
    } else if (const auto finite = number_at(value, {})) {
      number = *finite;
    }
    column.values.push_back(number);
  }
  return column;
}

void add_columns(const Json& result, const char* kind, Columns& columns) {
  const Json* those = find(result, {"sample", kind});
  if (those == nullptr || !those->is_object()) return;
  for (const auto& [name, values] : those->items())
    if (values.is_array() && values.size() == columns.passed.size())
      columns.all.push_back(column_of(name, values));
}

/// The axis that explains most of the metric that orders the runs, and that metric.
void choose_first(const Json& result, Columns& columns) {
  const std::string worst = text_at(result, {"worst_metric"});
  const auto named = [&](const std::string& name, std::size_t otherwise) {
    for (std::size_t i = 0; i < columns.all.size(); ++i)
      if (columns.all[i].name == name) return i;
    return otherwise;
  };
  columns.up = named(worst, columns.axes < columns.all.size() ? columns.axes : 0);
  double greatest = -1;
  for (const Json* metric : elements_at(result, {"metrics"})) {
    const Json* axes = find(*metric, {"sensitivity"});
    if (text_at(*metric, {"name"}) != worst || axes == nullptr || !axes->is_object()) continue;
    for (const auto& [axis, values] : axes->items())
      if (const double share = number_at(values, {"share"}).value_or(-1); share > greatest) {
        greatest = share;
        columns.across = named(axis, columns.across);
      }
  }
}

/// By whether the run passed.
Series points_of(const Columns& columns, bool passed) {
  Series series{passed ? "passed" : "not passed", {}};
  const std::vector<double>&x = columns.all[columns.across].values,
        &y = columns.all[columns.up].values;
  for (std::size_t i = 0; i < x.size(); ++i)
    if (columns.passed[i] == passed && std::isfinite(x[i]) && std::isfinite(y[i]))
      series.curve.add(x[i], y[i]);
  return series;
}

Data any_two(const Figure&, const Json& result) {
  Data data;
  Columns& columns = data.columns;
  for (const Json* passed : elements_at(result, {"sample", "passed"}))
    columns.passed.push_back(shown_at(*passed, {}) == "true");
  add_columns(result, "axes", columns);
  columns.axes = columns.all.size();
  add_columns(result, "metrics", columns);
  if (columns.all.size() < 2 || columns.passed.empty()) return {};
  choose_first(result, columns);
  data.series = {points_of(columns, true), points_of(columns, false)};
  return data;
}

}  // namespace

void add_campaign_figures(std::vector<Figure>& list) {
  list.push_back({"campaign-yield", "campaign", "Yield", "Runs that met the criteria",
                  "Of the runs that are done; a line shows the 95 % interval of the yield by "
                  "Wilson.",
                  "", "criterion", "runs, %", Kind::bars, false, yield});
  for (std::size_t i = 1; i <= most_metrics; ++i)
    list.push_back({fmt::format("campaign-metric-{}", i), "campaign", "Distributions",
                    fmt::format("Metric {}: distribution", i),
                    "Runs by the value of the metric: each class is named by its lower end. Where "
                    "the values span decades, so do the classes.",
                    "", "value", "runs", Kind::bars, false, distribution});
  list.push_back({"campaign-dependence", "campaign", "What depends on what",
                  "Share of the variance that an axis explains",
                  "Of the ranks of each metric over all finished runs, by classes of the axis.", "",
                  "axis", "share, %", Kind::bars, false, dependence});
  list.push_back({"campaign-any-two", "campaign", "Any two", "One over another, by run",
                  "A point for each run, at most 2,000 of them, evenly taken; where a column's "
                  "values are positive and span decades its axis is logarithmic.",
                  "", "first", "second", Kind::points, false, any_two});
}

}  // namespace capsoc::report
