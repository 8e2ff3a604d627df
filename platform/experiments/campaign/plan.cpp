#include "campaign/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <unordered_set>
#include <utility>

#include "base/nearest.h"
#include "base/number.h"
#include "base/printable.h"
#include "campaign/flat.h"
#include "host/places.h"
#include "host/sha256.h"
#include "version/version.h"

namespace capsoc::campaign {
namespace {

/// Runs whose files are read before the campaign begins; what is wrong in another one is its
/// result.
constexpr std::size_t checked_runs = 50;

/// Known names for the expressions of results.
std::vector<std::string> names_of(const FlatResult& example, const Description& description) {
  std::vector<std::string> names = description.axis_paths();
  for (const auto& [name, value] : example) names.push_back(name);
  return names;
}

std::optional<Error> check_expression(const Named& named, const std::vector<std::string>& known,
                                      const char* what) {
  for (const std::string& name : named.expression.names()) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    return Error{fmt::format("{}: {} '{}' is no {}; did you mean {}?", named.origin,
                             printable(named.name), printable(name), what,
                             nearest_names(std::string_view(name).substr(0, 64), known))};
  }
  return std::nullopt;
}

}  // namespace

Value value_of(const std::string& text) {
  if (const auto number = finite_number(text)) return *number;
  if (text == "true" || text == "false") return text == "true";
  return text;
}

Result<Program> Program::own() {
  Program program{fmt::format("{} (commit {})", capsoc::version(), commit()),
                  host::sha256_of_file(host::program_path())};
  if (program.hash.empty())
    return Error{"the program cannot read its own file, which identifies the runs; mount /proc"};
  return program;
}

bool Shard::has(std::string_view key) const {
  return std::strtoull(std::string(key.substr(0, 16)).c_str(), nullptr, 16) % whole == part - 1;
}

Result<Plan> Plan::make(Description description, Program program) {
  Plan plan;
  auto work = make_work(description.kind, description.settings);
  if (!work) return Error{fmt::format("{}: {}", description.file, work.error())};
  plan.work_ = std::move(work.value());
  plan.description_ = std::make_unique<Description>(std::move(description));
  plan.design_ = std::make_unique<Design>(*plan.description_);
  plan.program_ = std::move(program);
  if (auto error = plan.check_names()) return *error;
  if (auto error = plan.add_runs()) return *error;
  if (auto error = plan.check_some()) return *error;
  return plan;
}

std::optional<Error> Plan::check_names() const {
  const Description& d = *description_;
  std::vector<std::string> settings = d.axis_paths();
  for (const Assignment& each : d.settings) settings.push_back(each.path);
  for (const Named& derived : d.derived)
    if (auto error = check_expression(derived, settings, "axis and is not in [settings]"))
      return error;
  std::vector<std::string> known = names_of(flatten(work_->example()), d);
  for (const Named& metric : d.metrics)
    if (auto error = check_expression(metric, known, "key of a result and no axis")) return error;
  for (const Named& metric : d.metrics) known.push_back(metric.name);
  for (const Named& criterion : d.criteria)
    if (auto error = check_expression(criterion, known, "metric, no key of a result and no axis"))
      return error;
  for (const Named& each : d.by)
    if (auto error = check_expression(each, known, "metric, no key of a result and no axis"))
      return error;
  return std::nullopt;
}

Result<std::vector<Assignment>> Plan::assignments(const PlannedRun& run) const {
  const Description& d = *description_;
  std::vector<Assignment> all = d.settings;
  const std::vector<std::string> values = this->values(run);
  std::size_t next = 0;
  for (const AxisGroup& group : d.groups)
    for (const Axis& axis : group.axes) all.push_back({axis.path, values[next++], axis.origin});
  for (const Assignment& seeds : d.repetition_seeds)
    all.push_back({seeds.path, values[next++], seeds.origin});
  const std::size_t given = all.size();
  const Lookup lookup = [&](const std::string& name) -> Value {
    for (std::size_t i = given; i-- > 0;)
      if (all[i].path == name) return value_of(all[i].value);
    return {};
  };
  for (const Named& derived : d.derived) {
    const Value value = derived.expression.evaluate(lookup);
    if (is_null(value))
      return Error{fmt::format("{}: {} = {} has no value in a run; correct the expression",
                               derived.origin, printable(derived.name),
                               printable(derived.expression.text()))};
    all.push_back({derived.name, to_text(value), derived.origin});
  }
  return all;
}

Result<std::string> Plan::command(const PlannedRun& run) const {
  const auto all = assignments(run);
  if (!all) return Error{all.error()};
  const auto job = work_->prepare(all.value());
  if (!job) return Error{job.error()};
  return job.value().command;
}

Keep Plan::keep(const PlannedRun& run, bool failed) const {
  constexpr std::size_t enough = 16;  // of a key, for the name of a file
  const Description& d = *description_;
  if (d.failures_folder.empty()) return {};
  return {fmt::format("{}/{}", d.failures_folder, run.key().substr(0, enough)), failed,
          d.failures_waves};
}

Keep Plan::keep_session(const PlannedRun& run) const {
  Keep session = keep(run, true);
  session.session_s = description_->session_s;
  return session;
}

std::optional<Error> Plan::add_runs() {
  const uint64_t count = description_->runs();
  const std::string head =
      fmt::format("campaign 1\nkind={}\nprogram={}\n", description_->kind, program_.hash);
  std::unordered_set<std::string_view> keys;  // into runs_, which stays where it is
  runs_.reserve(count);
  for (uint64_t i = 0; i < count; ++i) {
    PlannedRun& run = runs_.emplace_back();
    run.number = i;
    const auto all = assignments(run);
    if (!all) return Error{all.error()};
    const auto job = work_->prepare(all.value());
    if (!job) return Error{job.error()};
    const std::string key = host::sha256_of(head + job.value().identity);
    std::copy_n(key.begin(), run.digits.size(), run.digits.begin());
    if (keys.insert(run.key()).second) continue;
    ++duplicates_;
    runs_.pop_back();
  }
  return std::nullopt;
}

std::optional<Error> Plan::check_some() const {
  if (description_->session_s && !work_->has_sessions())
    return Error{
        fmt::format("{}: [keep] session_s is for kind = \"run\"; remove it", description_->file)};
  const std::size_t step = std::max<std::size_t>(1, runs_.size() / checked_runs);
  for (std::size_t i = 0; i < runs_.size(); i += step) {
    const auto all = assignments(runs_[i]);
    if (!all) return Error{all.error()};
    if (auto error = work_->check(all.value(), keep(runs_[i], false))) return error;
  }
  return std::nullopt;
}

}  // namespace capsoc::campaign
