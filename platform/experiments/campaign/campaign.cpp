#include "campaign/campaign.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <utility>

#include "campaign/judge.h"
#include "host/console.h"
#include "host/end_signals.h"
#include "workers/engine.h"
#include "workers/progress.h"

namespace capsoc::campaign {
namespace {

using workers::Ended;
using workers::Engine;
using workers::Progress;

std::string text_of(const nlohmann::ordered_json& json) {
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

/// One campaign on its way.
class Campaign {
 public:
  Campaign(const Plan& plan, Store& store, const RunOptions& options)
      : plan_(plan),
        store_(store),
        options_(options),
        judge_(plan.description(), plan.work(), plan.description().axis_paths()) {}

  std::optional<Error> perform() {
    if (auto error = find_tasks()) return error;
    if (auto error = make_folder()) return error;
    host::note_end_signals();
    Progress progress(tasks_.size(), static_cast<double>(tasks_.size()));
    const Engine::Take take = [&](Ended ended) { return this->take(std::move(ended), progress); };
    const Engine::Tick tick = [&](std::size_t running) { progress.update(running); };
    Engine engine(options_.jobs, plan_.description().limits, [this](std::size_t task) {
      const PlannedRun& run = plan_.runs()[task];
      return work(run, plan_.keep(run, false));
    });
    auto error = engine.perform(tasks_, take, tick);
    progress.finish();
    if (error) return error;
    return record_failures();
  }

  uint64_t done() const { return done_; }

 private:
  std::optional<Error> find_tasks() {
    if (options_.retry)
      if (auto error = store_.forget_unfinished()) return error;
    if (auto error = store_.set_plan(plan_)) return error;
    const auto known = store_.keys();
    if (!known) return Error{known.error()};
    uint64_t had = 0;
    for (std::size_t i = 0; i < plan_.runs().size(); ++i) {
      const std::string_view key = plan_.runs()[i].key();
      if (!options_.shard.has(key)) continue;
      if (known.value().count(std::string(key)) != 0)
        ++had;
      else
        tasks_.push_back(i);
    }
    if (had > 0) host::say("{} runs are in {} already\n", had, store_.path());
    return std::nullopt;
  }

  std::optional<Error> make_folder() const {
    const std::string& folder = plan_.description().failures_folder;
    std::error_code failure;
    if (!folder.empty()) std::filesystem::create_directories(folder, failure);
    if (failure)
      return Error{fmt::format("{}: the folder cannot be made ({}); name another one in [keep]",
                               folder, failure.message())};
    return std::nullopt;
  }

  /// In a worker.
  Result<std::string> work(const PlannedRun& run, const Keep& keep) const {
    const auto assignments = plan_.assignments(run);
    if (!assignments) return Error{assignments.error()};
    const auto result = plan_.work().perform(assignments.value(), keep);
    if (!result) return Error{result.error()};
    return text_of(result.value());
  }

  std::optional<Error> take(Ended ended, Progress& progress) {
    const PlannedRun& run = plan_.runs()[ended.task];
    const auto command = plan_.command(run);
    if (!command) return Error{command.error()};
    Row row{std::string(run.key()),  ended.ending, command.value(),
            std::move(ended.result), ended.log,    ended.wall_s};
    const auto judged = judge_.judge(plan_.values(run), row);
    if (!judged) return Error{judged.error()};
    if (judged.value().pass)
      row.log.clear();
    else
      failed_.push_back(ended.task);
    if (auto error = store_.add({row})) return error;
    ++done_;
    progress.done(judged.value().pass, 1);
    return std::nullopt;
  }

  /// The failed runs again, which are the same, with what [keep] asks for.
  std::optional<Error> record_failures() {
    if (plan_.description().failures_folder.empty() || failed_.empty() || host::noted_signal() != 0)
      return std::nullopt;
    host::say("recording {} failed runs in {}\n", failed_.size(),
              plan_.description().failures_folder);
    if (auto error = repeat([this](const PlannedRun& run) { return plan_.keep(run, true); }))
      return error;
    if (!plan_.description().session_s || host::noted_signal() != 0) return std::nullopt;
    return repeat([this](const PlannedRun& run) { return plan_.keep_session(run); });
  }

  std::optional<Error> repeat(const std::function<Keep(const PlannedRun& run)>& keep) {
    Engine engine(options_.jobs, plan_.description().limits, [&](std::size_t task) {
      const PlannedRun& run = plan_.runs()[task];
      return work(run, keep(run));
    });
    const auto take = [&](const Ended& ended) -> std::optional<Error> {
      if (ended.ending != workers::finished && host::noted_signal() == 0)
        host::say("{}: not recorded: {}\n", keep(plan_.runs()[ended.task]).stem, ended.log);
      return std::nullopt;
    };
    return engine.perform(failed_, take, [](std::size_t) {});
  }

  const Plan& plan_;
  Store& store_;
  RunOptions options_;
  Judge judge_;
  std::vector<std::size_t> tasks_, failed_;  // numbers in the plan
  uint64_t done_ = 0;
};

}  // namespace

Result<uint64_t> perform(const Plan& plan, Store& store, const RunOptions& options) {
  Campaign campaign(plan, store, options);
  if (auto error = campaign.perform()) return *error;
  return campaign.done();
}

Result<double> time_one(const Plan& plan, double limit_s) {
  workers::Limits limits = plan.description().limits;
  limits.seconds = std::min(limits.seconds, limit_s);
  const std::string trial =
      (std::filesystem::temp_directory_path() / fmt::format("capsoc-{}", getpid())).string();
  Engine engine(1, limits, [&](std::size_t task) -> Result<std::string> {
    const auto assignments = plan.assignments(plan.runs()[task]);
    if (!assignments) return Error{assignments.error()};
    const auto result = plan.work().perform(assignments.value(), {trial, false, false});
    if (!result) return Error{result.error()};
    return std::string();
  });
  double seconds = 0;
  std::string ending;
  const auto take = [&](const Ended& ended) -> std::optional<Error> {
    seconds = ended.wall_s;
    ending = ended.ending;
    return std::nullopt;
  };
  // So that the worker's end is the end of all that it started.
  host::note_end_signals();
  if (auto error = engine.perform({0}, take, [](std::size_t) {})) return *error;
  if (host::noted_signal() != 0) return Error{"a signal came"};
  std::remove((trial + ".fst").c_str());  // of a difference in lockstep
  if (ending != workers::finished) return Error{ending};
  return seconds;
}

Result<uint64_t> merge(Store& into, const std::vector<std::string>& stores) {
  uint64_t taken = 0;
  for (const std::string& path : stores) {
    const auto other = Store::read(path);
    if (!other) return Error{other.error()};
    const auto theirs = other.value()->plan();
    if (!theirs) return Error{theirs.error()};
    if (!theirs.value()) {
      host::say("{}: holds no campaign yet, and no runs\n", path);
      continue;
    }
    auto ours = into.plan();
    if (!ours) return Error{ours.error()};
    if (!ours.value()) {
      if (auto error = into.take_plan(*other.value())) return *error;
      ours = theirs;
    }
    const StoredPlan &a = *ours.value(), &b = *theirs.value();
    if (a.program.hash != b.program.hash)
      return Error{
          fmt::format("{}: its runs are of another program (capsoc {}) than those of {} "
                      "(capsoc {}); merge stores of one program",
                      path, b.program.version, into.path(), a.program.version)};
    if (a.description != b.description)
      return Error{fmt::format("{}: is of another description than {}; merge stores of one", path,
                               into.path())};
    const auto count = into.merge(*other.value());
    if (!count) return Error{count.error()};
    taken += count.value();
  }
  return taken;
}

}  // namespace capsoc::campaign
