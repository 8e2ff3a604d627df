#include "campaign/report.h"

#include <algorithm>
#include <utility>

#include "campaign/stored_campaign.h"

namespace capsoc::campaign {
namespace {

constexpr std::size_t shown = 10;

/// What the statistics need of all finished runs.
struct Columns {
  std::vector<uint64_t> runs;
  std::vector<bool> passed;
  std::vector<std::vector<std::optional<double>>> metrics;
  std::vector<std::vector<std::string>> axes;
};

class Collector {
 public:
  explicit Collector(const StoredCampaign& campaign) : judge_(*campaign.judge) {
    report_.name = campaign.description.name;
    report_.kind = campaign.description.kind;
    report_.version = campaign.plan.program.version;
    report_.least_yield = campaign.description.least_yield;
    report_.planned = campaign.plan.runs;
    report_.axes = judge_.axes();
    for (const Named& each : judge_.criteria())
      report_.criteria.push_back({each.name, each.expression.text(), 0});
    for (const Named& each : judge_.metrics())
      report_.metrics.push_back({each.name, each.expression.text(), 0, {}, {}});
    for (const Named& each : judge_.by())
      report_.by.push_back({each.name, each.expression.text(), {}});
    if (judge_.worst()) report_.worst_metric = judge_.metrics()[*judge_.worst()].name;
    columns_.metrics.resize(report_.metrics.size());
    columns_.axes.resize(report_.axes.size());
  }

  void add(const StoredRun& run, const Judged& judged) {
    ++report_.done;
    report_.wall_s += run.row->wall_s;
    ++report_.exits[judged.exit];
    if (judged.pass) ++report_.passed;
    for (std::size_t i = 0; i < judged.criteria.size(); ++i)
      if (judged.criteria[i]) ++report_.criteria[i].met;
    if (!judged.pass && report_.failures.size() < shown)
      report_.failures.push_back(example(run, judged));
    if (!judged.finished) return;
    ++report_.finished;
    columns_.runs.push_back(run.number);
    columns_.passed.push_back(judged.pass);
    for (std::size_t i = 0; i < judged.metrics.size(); ++i)
      columns_.metrics[i].push_back(judged.metrics[i]);
    for (std::size_t i = 0; i < columns_.axes.size(); ++i)
      columns_.axes[i].push_back(i < run.values.size() ? run.values[i] : "");
    add_worst(run, judged);
    add_to_groups(judged);
  }

  Report finish() {
    if (report_.done > 0) report_.interval = wilson(report_.passed, report_.done);
    for (std::size_t i = 0; i < report_.metrics.size(); ++i)
      finish(report_.metrics[i], columns_.metrics[i]);
    take_sample();
    return std::move(report_);
  }

 private:
  void add_to_groups(const Judged& judged) {
    for (std::size_t i = 0; i < judged.by.size(); ++i) {
      GroupReport& group = report_.by[i].groups[judged.by[i]];
      ++group.runs;
      if (judged.pass) ++group.passed;
      ++group.exits[judged.exit];
    }
  }

  /// The result's own, where it has one: of a run that was drawn it says what.
  static std::string command_of(const StoredRun& run) {
    const auto result = nlohmann::ordered_json::parse(run.row->result, nullptr, false);
    const auto own = result.is_object() ? result.find("command") : result.end();
    return own != result.end() && own->is_string() ? own->get<std::string>() : run.row->command;
  }

  Example example(const StoredRun& run, const Judged& judged) const {
    Example example{run.number, run.values, judged.exit, {}, {}, command_of(run)};
    for (std::size_t i = 0; i < judged.criteria.size(); ++i)
      if (!judged.criteria[i]) example.unmet.push_back(report_.criteria[i].name);
    if (judge_.worst()) example.worst = judged.metrics[*judge_.worst()];
    return example;
  }

  void add_worst(const StoredRun& run, const Judged& judged) {
    if (!judge_.worst() || !judged.metrics[*judge_.worst()]) return;
    std::vector<Example>& worst = report_.worst;
    const double value = *judged.metrics[*judge_.worst()];
    const auto place = std::find_if(worst.begin(), worst.end(),
                                    [&](const Example& other) { return *other.worst < value; });
    if (place == worst.end() && worst.size() == shown) return;
    worst.insert(place, example(run, judged));
    if (worst.size() > shown) worst.pop_back();
  }

  void finish(MetricReport& metric, const std::vector<std::optional<double>>& column) {
    std::vector<double> values;
    for (const auto& value : column)
      if (value) values.push_back(*value);
    metric.missing = column.size() - values.size();
    metric.summary = summarise(values);
    for (const std::vector<std::string>& axis : columns_.axes) {
      std::vector<std::string> those;
      for (std::size_t i = 0; i < column.size(); ++i)
        if (column[i]) those.push_back(axis[i]);
      metric.to_axes.push_back(sensitivity(those, values));
    }
  }

  void take_sample() {
    Sample& sample = report_.sample;
    sample.of = columns_.runs.size();
    sample.axes.resize(columns_.axes.size());
    sample.metrics.resize(columns_.metrics.size());
    const std::size_t step = (columns_.runs.size() + Sample::most - 1) / Sample::most;
    for (std::size_t i = 0; i < columns_.runs.size(); i += step) {
      sample.runs.push_back(columns_.runs[i]);
      sample.passed.push_back(columns_.passed[i]);
      for (std::size_t a = 0; a < sample.axes.size(); ++a)
        sample.axes[a].push_back(columns_.axes[a][i]);
      for (std::size_t m = 0; m < sample.metrics.size(); ++m)
        sample.metrics[m].push_back(columns_.metrics[m][i]);
    }
  }

  const Judge& judge_;
  Report report_;
  Columns columns_;
};

}  // namespace

std::vector<std::string> ByReport::order() const {
  std::vector<std::string> values;
  for (const auto& [value, group] : groups) values.push_back(value);
  const auto failures = [this](const std::string& value) {
    const GroupReport& group = groups.at(value);
    return group.runs - group.passed;
  };
  std::stable_sort(values.begin(), values.end(), [&](const auto& one, const auto& other) {
    return failures(one) > failures(other);
  });
  return values;
}

Result<Report> make_report(const Store& store) {
  const auto campaign = StoredCampaign::of(store);
  if (!campaign) return Error{campaign.error()};
  Collector collector(campaign.value());
  const auto take = [&](const StoredRun& run, const Judged& judged) { collector.add(run, judged); };
  if (auto error = campaign.value().each_done(store, take)) return *error;
  return collector.finish();
}

}  // namespace capsoc::campaign
