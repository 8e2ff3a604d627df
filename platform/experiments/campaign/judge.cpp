#include "campaign/judge.h"

#include <fmt/format.h>

#include <algorithm>

#include "campaign/flat.h"
#include "campaign/plan.h"
#include "workers/engine.h"

namespace capsoc::campaign {
namespace {

/// What every kind of work has in its results.
constexpr const char* passes = "exit.code == 0";
constexpr const char* exit_code = "exit.code";
constexpr const char* exit_reason = "exit.reason";
/// A program's own word on why it failed, where it has one.
constexpr const char* verdict_reason = "verdict.reason";

/// Every number of a result that is of the simulation.
std::vector<Named> all_metrics(const Work& work) {
  std::vector<std::string> others = work.host_keys();
  others.insert(others.end(), {"schema", "configuration", "hits"});
  std::vector<Named> metrics;
  for (const auto& [name, value] : flatten(work.example())) {
    if (!std::holds_alternative<double>(value) || is_below(name, others)) continue;
    if (auto expression = Expression::parse(name))
      metrics.push_back({name, std::move(expression.value()), ""});
  }
  return metrics;
}

}  // namespace

Judge::Judge(const Description& description, const Work& work, std::vector<std::string> axes)
    : axes_(std::move(axes)),
      metrics_(description.metrics),
      criteria_(description.criteria),
      by_(description.by) {
  if (metrics_.empty()) metrics_ = all_metrics(work);
  if (criteria_.empty()) criteria_.push_back({"pass", Expression::parse(passes).value(), ""});
  if (!metrics_.empty()) worst_ = 0;
  for (std::size_t i = 0; i < metrics_.size(); ++i)
    if (metrics_[i].name == description.worst) worst_ = i;
}

Result<Judged> Judge::judge(const std::vector<std::string>& values, const Row& row) const {
  Judged judged;
  judged.exit = row.ending;
  judged.metrics.resize(metrics_.size());
  judged.criteria.assign(criteria_.size(), false);
  judged.finished = row.ending == workers::finished;
  if (!judged.finished) return judged;
  const auto json = nlohmann::ordered_json::parse(row.result, nullptr, false);
  if (!json.is_object())
    return Error{
        fmt::format("the result of run {} is damaged; remove the store's row or use a "
                    "copy of the store",
                    row.key)};
  const FlatResult result = flatten(json);
  const Lookup of_result = [&](const std::string& name) -> Value {
    if (const auto known = result.find(name); known != result.end()) return known->second;
    const auto axis = std::find(axes_.begin(), axes_.end(), name);
    const auto number = static_cast<std::size_t>(axis - axes_.begin());
    return number < values.size() ? value_of(values[number]) : Value();
  };
  std::vector<Value> metrics;
  for (std::size_t i = 0; i < metrics_.size(); ++i) {
    metrics.push_back(metrics_[i].expression.evaluate(of_result));
    if (const double* number = std::get_if<double>(&metrics.back())) judged.metrics[i] = *number;
    if (const bool* truth = std::get_if<bool>(&metrics.back())) judged.metrics[i] = *truth ? 1 : 0;
  }
  const Lookup of_metrics = [&](const std::string& name) -> Value {
    for (std::size_t i = 0; i < metrics_.size(); ++i)
      if (metrics_[i].name == name) return metrics[i];
    return of_result(name);
  };
  judged.pass = true;
  for (std::size_t i = 0; i < criteria_.size(); ++i) {
    judged.criteria[i] = criteria_[i].expression.evaluate(of_metrics) == Value(true);
    judged.pass = judged.pass && judged.criteria[i];
  }
  for (const Named& each : by_) judged.by.push_back(to_text(each.expression.evaluate(of_metrics)));
  judged.exit = to_text(of_result(exit_code)) + ": " + to_text(of_result(exit_reason));
  if (const Value reason = of_result(verdict_reason); !is_null(reason))
    judged.exit += ", " + to_text(reason);
  return judged;
}

}  // namespace capsoc::campaign
