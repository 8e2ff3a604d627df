#include "regress/campaign.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <mutex>
#include <thread>

#include "support/nearest.h"

namespace capsoc::regress {
namespace {

using coprocessor::Arithmetic;

/// `part` of the `whole`, for one of `count` seeds; the parts add up to the total, or a little
/// more.
uint64_t share(uint64_t total, unsigned part, unsigned whole, uint64_t index, uint64_t count) {
  if (whole == 0) return 0;
  const uint64_t all = total / whole * part + (total % whole * part + whole - 1) / whole;
  return all / count + (index < all % count ? 1 : 0);
}

Result<std::vector<const Scenario*>> chosen(const Plan& plan) {
  std::vector<const Scenario*> result;
  for (const Scenario& scenario : scenarios()) {
    const auto& names = plan.scenarios;
    if (names.empty() || std::find(names.begin(), names.end(), scenario.name) != names.end())
      result.push_back(&scenario);
  }
  for (const std::string& name : plan.scenarios) {
    std::vector<std::string> known;
    for (const Scenario& scenario : scenarios()) known.emplace_back(scenario.name);
    if (std::find(known.begin(), known.end(), name) == known.end())
      return Error{fmt::format("there is no scenario '{}'; did you mean {}?", name,
                               nearest_names(name, known))};
  }
  return result;
}

std::string reproduction(const Plan& plan, const Run& run) {
  std::string text = fmt::format("capsoc regress --arithmetic {} --scenario {} --first-seed {}",
                                 name_of(run.arithmetic), run.scenario->name, run.seed);
  text +=
      fmt::format(" --seeds 1 --samples {} --accesses {}", run.budget.samples, run.budget.accesses);
  return plan.command_options.empty() ? text : text + " " + plan.command_options;
}

/// Runs one scenario; what it covered is added to `coverage`.
std::optional<Error> perform(const Plan& plan, Run& run, Coverage& coverage) {
  auto comparison = plan.compare(run.arithmetic);
  if (!comparison) return Error{comparison.error()};
  Comparison& pair = *comparison.value();
  Bench bench(pair.device(), run.arithmetic, coverage, [&pair] { return pair.differs(); });
  const auto stream = static_cast<uint64_t>(run.scenario - scenarios().data());
  Random random(run.seed, stream);
  run.scenario->run(bench, random, run.budget);
  bench.drain();
  run.counts = bench.counts();
  run.finding = pair.finding();
  if (const auto& complaint = bench.complaint(); complaint && !run.finding)
    run.finding = Finding{complaint->edge, complaint->what, "", complaint->report, false, 0, {}};
  if (run.coverage_file.empty()) return std::nullopt;
  return pair.write_coverage(run.coverage_file);
}

}  // namespace

const char* name_of(Arithmetic arithmetic) {
  return arithmetic == Arithmetic::paper ? "paper" : "precise";
}

const Run* Outcome::first_difference() const {
  const Run* first = nullptr;
  for (const Run& run : runs) {
    if (!run.finding) continue;
    if (run.finding->of_devices) return &run;
    if (first == nullptr) first = &run;
  }
  return first;
}

Result<std::vector<Run>> runs_of(const Plan& plan) {
  auto selected = chosen(plan);
  if (!selected) return Error{selected.error()};
  unsigned sample_shares = 0, access_shares = 0;
  for (const Scenario* scenario : selected.value()) {
    sample_shares += scenario->sample_share;
    access_shares += scenario->access_share;
  }
  std::vector<Run> runs;
  for (Arithmetic arithmetic : plan.arithmetics)
    for (const Scenario* scenario : selected.value())
      for (uint64_t i = 0; i < plan.seeds; ++i) {
        Run run;
        run.arithmetic = arithmetic;
        run.scenario = scenario;
        run.seed = plan.first_seed + i;
        run.budget = {share(plan.samples, scenario->sample_share, sample_shares, i, plan.seeds),
                      share(plan.accesses, scenario->access_share, access_shares, i, plan.seeds)};
        run.command = reproduction(plan, run);
        if (!plan.coverage_directory.empty())
          run.coverage_file = fmt::format("{}/{}-{}-{}.dat", plan.coverage_directory,
                                          name_of(arithmetic), scenario->name, run.seed);
        runs.push_back(std::move(run));
      }
  return runs;
}

Result<Outcome> run_campaign(const Plan& plan) {
  auto runs = runs_of(plan);
  if (!runs) return Error{runs.error()};
  Outcome outcome;
  outcome.runs = std::move(runs.value());
  for (Arithmetic arithmetic : plan.arithmetics)
    outcome.coverage.emplace_back(arithmetic, Coverage(arithmetic));

  std::atomic<size_t> next{0};
  std::mutex mutex;  // of the coverage and the error
  std::optional<Error> error;
  const auto work = [&] {
    for (size_t i = next++; i < outcome.runs.size(); i = next++) {
      Run& run = outcome.runs[i];
      Coverage coverage(run.arithmetic);
      auto failure = perform(plan, run, coverage);
      const std::lock_guard lock(mutex);
      if (failure) {
        if (!error) error = failure;
        return;
      }
      for (auto& [arithmetic, sum] : outcome.coverage)
        if (arithmetic == run.arithmetic) sum.add(coverage);
    }
  };
  std::vector<std::thread> threads;
  for (unsigned job = 1; job < plan.jobs; ++job) threads.emplace_back(work);
  work();
  for (std::thread& thread : threads) thread.join();
  if (error) return *error;
  return outcome;
}

}  // namespace capsoc::regress
