// Reports as text, JSON and JUnit.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "base/curve.h"
#include "base/json.h"
#include "base/printable.h"
#include "base/xml.h"
#include "campaign/plan.h"
#include "campaign/report.h"
#include "campaign/stored_campaign.h"

namespace capsoc::campaign {
namespace {

using nlohmann::ordered_json;

constexpr int schema_version = 1;
constexpr std::size_t longest_exit = 100, longest_column = 24;
constexpr std::size_t most_values = 40;  // of what is told apart, as text

std::string percent(double share) {
  return fmt::format("{:.2f} %", 100 * share);
}

std::string count_line(const Report& r) {
  return fmt::format("{} of {} runs done, {} without a result; {:.0f} s of workers\n", r.done,
                     r.planned, r.done - r.finished, r.wall_s);
}

std::string yield_text(const Report& r) {
  if (!r.interval) return "no run is done\n";
  std::string text = fmt::format("yield {} ({} of {}), 95 % interval {} to {}; wanted {}\n",
                                 percent(r.yield()), r.passed, r.done, percent(r.interval->least),
                                 percent(r.interval->greatest), percent(r.least_yield));
  for (const CriterionReport& c : r.criteria)
    text += fmt::format("  {:<22}{:>10}  {}\n", c.name,
                        percent(static_cast<double>(c.met) / static_cast<double>(r.done)),
                        c.expression);
  text += "\nruns that ended with\n";
  for (const auto& [exit, count] : r.exits)
    text += fmt::format("  {:>8}  {}\n", count, printable(exit, longest_exit));
  return text;
}

std::string bars(const Histogram& h) {
  static constexpr const char* levels[] = {"_", "1", "2", "3", "4", "5", "6", "7", "8", "9"};
  uint64_t most = 1;
  for (const uint64_t bin : h.bins) most = std::max(most, bin);
  std::string text;
  for (const uint64_t bin : h.bins) text += bin == 0 ? levels[0] : levels[1 + (bin * 9 - 1) / most];
  return text;
}

std::string metrics_text(const Report& r) {
  std::string text = fmt::format("\n{:<24}", "metric");
  for (const char* title :
       {"mean", "least", "1 %", "5 %", "25 %", "median", "75 %", "95 %", "99 %", "greatest"})
    text += fmt::format("{:>11}", title);
  text += "  histogram (height 1 to 9, log: bins of equal ratio)\n";
  for (const MetricReport& m : r.metrics) {
    text += fmt::format("{:<24}", m.name);
    if (!m.summary) {
      text += "  no run has it\n";
      continue;
    }
    text += fmt::format("{:>11.4g}", m.summary->mean);
    for (const double value : m.summary->quantiles) text += fmt::format("{:>11.4g}", value);
    text += fmt::format("  {}{}{}\n", bars(m.summary->histogram),
                        m.summary->histogram.logarithmic ? " log" : "",
                        m.missing > 0 ? fmt::format(" ({} runs without)", m.missing) : "");
  }
  return text;
}

std::string sensitivity_text(const Report& r) {
  if (r.axes.empty()) return "";
  std::string text =
      "\nwhat depends on what: share of the variance of ranks, and rank correlation\n"
      "(without the axes below what chance gives one axis in a hundred)\n";
  for (const MetricReport& m : r.metrics) {
    std::vector<std::pair<double, std::string>> lines;
    for (std::size_t i = 0; i < r.axes.size(); ++i) {
      const auto& s = m.to_axes[i];
      if (!s || s->share < std::max(0.005, s->chance)) continue;
      lines.emplace_back(
          -s->share, fmt::format("  {:<24}{:<34}{:>9}{}\n", m.name, r.axes[i], percent(s->share),
                                 s->correlation ? fmt::format("{:>+8.2f}", *s->correlation) : ""));
    }
    std::sort(lines.begin(), lines.end());
    for (const auto& line : lines) text += line.second;
  }
  return text;
}

/// A row for each value, a column for each way to end.
std::string by_text(const ByReport& by) {
  std::map<std::string, std::size_t> exits;  // width of a column
  for (const auto& [value, group] : by.groups)
    for (const auto& [exit, count] : group.exits)
      exits[exit] = std::max<std::size_t>(8, printable(exit, longest_column).size()) + 2;
  std::string text = fmt::format("\n{:<32}{:>8}{:>10}", "by " + by.name, "runs", "passed");
  for (const auto& [exit, width] : exits)
    text += fmt::format("{:>{}}", printable(exit, longest_column), width);
  text += "\n";
  std::size_t rows = 0;
  for (const std::string& value : by.order()) {
    if (rows++ == most_values) {
      text += fmt::format("  and {} more, in the JSON report\n", by.groups.size() - most_values);
      break;
    }
    const GroupReport& group = by.groups.at(value);
    text +=
        fmt::format("  {:<30}{:>8}{:>10}", printable(value, 60), group.runs,
                    percent(static_cast<double>(group.passed) / static_cast<double>(group.runs)));
    for (const auto& [exit, width] : exits) {
      const auto found = group.exits.find(exit);
      text += fmt::format("{:>{}}", found == group.exits.end() ? 0 : found->second, width);
    }
    text += "\n";
  }
  return text;
}

std::string examples_text(const std::string& title, const std::vector<Example>& examples) {
  if (examples.empty()) return "";
  std::string text = "\n" + title + "\n";
  for (const Example& e : examples) {
    text += fmt::format("  run {}: ", e.number);
    if (e.worst) text += fmt::format("{:.6g}, ", *e.worst);
    text += printable(e.exit, longest_exit);
    if (!e.unmet.empty()) text += fmt::format("; not met: {}", fmt::join(e.unmet, ", "));
    text += "\n    " + e.command + "\n";
  }
  return text;
}

ordered_json example_json(const Report& r, const Example& e) {
  ordered_json j = {{"run", e.number}};
  for (std::size_t i = 0; i < r.axes.size() && i < e.values.size(); ++i)
    j["axes"][r.axes[i]] = e.values[i];
  j["exit"] = e.exit;
  j["unmet"] = e.unmet;
  j["worst"] = number_or_null(e.worst);
  j["command"] = e.command;
  return j;
}

ordered_json metric_json(const Report& r, const MetricReport& m) {
  ordered_json j = {{"name", m.name}, {"expression", m.expression}, {"missing", m.missing}};
  j["count"] = m.summary ? m.summary->count : 0;
  j["summary"] = nullptr;
  if (m.summary) {
    const Summary& s = *m.summary;
    j["summary"] = {{"mean", s.mean}, {"deviation", s.deviation}};
    for (std::size_t i = 0; i < s.quantiles.size(); ++i)
      j["summary"]["quantiles"][fmt::format("{}", quantile_shares[i])] = s.quantiles[i];
    j["histogram"] = {{"logarithmic", s.histogram.logarithmic},
                      {"least", s.histogram.least},
                      {"greatest", s.histogram.greatest},
                      {"bins", s.histogram.bins}};
  }
  for (std::size_t i = 0; i < r.axes.size(); ++i) {
    const auto& s = m.to_axes[i];
    j["sensitivity"][r.axes[i]] = nullptr;
    if (s)
      j["sensitivity"][r.axes[i]] = {{"share", s->share},
                                     {"chance", s->chance},
                                     {"correlation", number_or_null(s->correlation)}};
  }
  return j;
}

std::string test_case(const StoredCampaign& campaign, const StoredRun& run, const Judged& judged) {
  std::string name = fmt::format("run {}", run.number);
  for (std::size_t i = 0; i < run.values.size() && i < campaign.plan.axes.size(); ++i)
    name += fmt::format(" {}={}", campaign.plan.axes[i], run.values[i]);
  std::string text =
      fmt::format("    <testcase classname=\"campaign.{}\" name=\"{}\" time=\"{:.3f}\"",
                  xml_text(campaign.description.name), xml_text(name), run.row->wall_s);
  if (judged.pass) return text + "/>\n";
  std::string message = judged.exit;
  for (std::size_t i = 0; i < judged.criteria.size(); ++i)
    if (!judged.criteria[i] && judged.finished)
      message += "; not met: " + campaign.judge->criteria()[i].name;
  const std::string details = "again: " + run.row->command + "\n" + run.row->log;
  return text + fmt::format(">\n      <{} message=\"{}\">{}</{}>\n    </testcase>\n",
                            judged.finished ? "failure" : "error", xml_text(message),
                            xml_text(details), judged.finished ? "failure" : "error");
}

std::string failures_title(const Report& r) {
  const uint64_t all = r.done - r.passed;
  if (all == r.failures.size()) return "failures";
  return fmt::format("failures: the first {} of {}; capsoc campaign export has all",
                     r.failures.size(), all);
}

}  // namespace

std::string to_text(const Report& r) {
  std::string text = fmt::format("campaign {} ({}), capsoc {}\n", r.name, r.kind, r.version);
  text += count_line(r) + yield_text(r);
  for (const ByReport& by : r.by) text += by_text(by);
  if (r.finished > 0) text += metrics_text(r) + sensitivity_text(r);
  text += examples_text("worst: the largest " + r.worst_metric, r.worst);
  return text + examples_text(failures_title(r), r.failures);
}

namespace {

ordered_json by_json(const Report& r) {
  ordered_json all = ordered_json::array();
  for (const ByReport& by : r.by) {
    ordered_json rows = ordered_json::array();
    for (const std::string& value : by.order()) {
      const GroupReport& group = by.groups.at(value);
      rows.push_back({{"value", value}, {"runs", group.runs}, {"passed", group.passed}});
      for (const auto& [exit, count] : group.exits)
        rows.back()["exits"].push_back({{"exit", exit}, {"runs", count}});
    }
    all.push_back({{"name", by.name}, {"expression", by.expression}, {"values", std::move(rows)}});
  }
  return all;
}

/// Numbers as a plot needs them.
ordered_json sample_json(const Report& r) {
  constexpr int digits = 7;
  ordered_json j = {{"of", r.sample.of}, {"runs", r.sample.runs}, {"passed", r.sample.passed}};
  j["axes"] = j["metrics"] = ordered_json::object();
  for (std::size_t i = 0; i < r.sample.axes.size(); ++i) {
    ordered_json& column = j["axes"][r.axes[i]] = ordered_json::array();
    for (const std::string& text : r.sample.axes[i]) {
      const Value value = value_of(text);
      const auto* const number = std::get_if<double>(&value);
      column.push_back(number != nullptr ? ordered_json(rounded(*number, digits))
                                         : ordered_json(text));
    }
  }
  for (std::size_t i = 0; i < r.sample.metrics.size(); ++i) {
    ordered_json& column = j["metrics"][r.metrics[i].name] = ordered_json::array();
    for (const auto& value : r.sample.metrics[i])
      column.push_back(value ? ordered_json(rounded(*value, digits)) : ordered_json());
  }
  return j;
}

}  // namespace

ordered_json to_json(const Report& r) {
  ordered_json j = {
      {"schema", schema_version}, {"command", "capsoc campaign"}, {"name", r.name},
      {"kind", r.kind},           {"version", r.version},         {"runs", r.planned},
      {"done", r.done},           {"finished", r.finished},       {"passed", r.passed},
      {"yield", nullptr},         {"yield_interval", nullptr},    {"least_yield", r.least_yield}};
  if (r.interval) {
    j["yield"] = r.yield();
    j["yield_interval"] = {r.interval->least, r.interval->greatest};
  }
  j["wall_s"] = r.wall_s;
  j["criteria"] = j["exits"] = j["metrics"] = ordered_json::array();
  for (const CriterionReport& c : r.criteria)
    j["criteria"].push_back({{"name", c.name}, {"expression", c.expression}, {"met", c.met}});
  for (const auto& [exit, count] : r.exits) j["exits"].push_back({{"exit", exit}, {"runs", count}});
  for (const MetricReport& m : r.metrics) j["metrics"].push_back(metric_json(r, m));
  if (!r.by.empty()) j["by"] = by_json(r);
  j["worst_metric"] = r.worst_metric;
  j["worst"] = j["failures"] = ordered_json::array();
  for (const Example& e : r.worst) j["worst"].push_back(example_json(r, e));
  for (const Example& e : r.failures) j["failures"].push_back(example_json(r, e));
  j["sample"] = sample_json(r);
  return j;
}

Result<std::string> to_junit(const Store& store) {
  const auto campaign = StoredCampaign::of(store);
  if (!campaign) return Error{campaign.error()};
  std::string cases;
  uint64_t tests = 0, failures = 0, errors = 0;
  const auto take = [&](const StoredRun& run, const Judged& judged) {
    ++tests;
    if (!judged.pass) ++(judged.finished ? failures : errors);
    cases += test_case(campaign.value(), run, judged);
  };
  if (auto error = campaign.value().each_done(store, take)) return *error;
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n  <testsuite name=\"{}\" "
      "tests=\"{}\" failures=\"{}\" errors=\"{}\">\n{}  </testsuite>\n</testsuites>\n",
      xml_text(campaign.value().description.name), tests, failures, errors, cases);
}

}  // namespace capsoc::campaign
