#include "regress/campaign.h"

#include <fmt/format.h>
#include <stdio_ext.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <numeric>

#include "base/nearest.h"
#include "base/printable.h"
#include "coprocessor/harmonic_correction.h"
#include "coprocessor/register_map.h"
#include "host/end_signals.h"
#include "regress/run_result.h"
#include "workers/engine.h"
#include "workers/progress.h"

namespace capsoc::regress {
namespace {

using coprocessor::Arithmetic;

constexpr std::size_t longest_words = 300;

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

/// What software does at power-up ahead of all else: the nodes of the harmonic correction are
/// anything until they are written. `paper` has none.
void write_nodes(Bench& bench) {
  if (bench.arithmetic() == Arithmetic::paper) return;
  for (uint32_t node = 0; node < coprocessor::correction_nodes; ++node)
    bench.write(coprocessor::reg_correction,
                node << coprocessor::description::CORRECTION_NODE_shift);
}

/// Estimated length of a run, in samples, to schedule it among the others.
double work_of(const Run& run) {
  constexpr double directed = 1000;  // what a scenario does whatever its budget is
  return directed + static_cast<double>(run.budget.samples + run.budget.accesses);
}

/// Why a process ended, from its log: Verilator's first error, else the last line, where an
/// exception or a script's traceback has its cause. "" for an empty log.
std::string last_words(const std::string& log) {
  const std::size_t error = log.find("%Error");
  if (error != std::string::npos) return log.substr(error, log.find('\n', error) - error);
  const std::size_t end = log.find_last_not_of(" \n");
  if (end == std::string::npos) return {};
  const std::size_t begin = log.rfind('\n', end);
  return log.substr(begin + 1, end - begin);  // npos + 1 is 0
}

/// Verilator's messages are standard output: into the log with the rest, line by line, since a
/// process that crashes writes nothing more.
void log_standard_output() {
  __fpurge(stdout);  // the parent prints what it had begun
  dup2(STDERR_FILENO, STDOUT_FILENO);
  std::setvbuf(stdout, nullptr, _IOLBF, BUFSIZ);
}

/// All runs on their way.
class Regression {
 public:
  Regression(const Plan& plan, std::vector<Run> runs,
             const std::function<void(const Outcome&)>& asked)
      : plan_(plan), asked_(asked) {
    outcome_.runs = std::move(runs);
    for (Arithmetic arithmetic : plan.arithmetics)
      outcome_.coverage.emplace_back(arithmetic, Coverage(arithmetic, plan.tick));
  }

  Result<Outcome> perform() {
    host::note_end_signals();
    host::note_report_signal();
    double work = 0;
    for (const Run& run : outcome_.runs) {
      work += work_of(run);
      limits_.seconds = std::max(limits_.seconds,
                                 plan_.seconds > 0 ? plan_.seconds : should_end_within(run.budget));
    }
    if (plan_.seconds > 0) limits_.seconds = plan_.seconds;
    workers::Progress progress(outcome_.runs.size(), work);
    workers::Engine engine(plan_.jobs, limits_,
                           [this](std::size_t task) { return this->work(task); });
    const auto error = engine.perform(
        longest_first(), [&](const workers::Ended& ended) { return take(ended, progress); },
        [&](std::size_t running) {
          progress.update(running);
          if (host::take_report_signal() && asked_) asked_(outcome_);
        });
    progress.finish();
    if (error) return *error;
    return std::move(outcome_);
  }

 private:
  /// So that no long one is alone at the end.
  std::vector<std::size_t> longest_first() const {
    std::vector<std::size_t> tasks(outcome_.runs.size());
    std::iota(tasks.begin(), tasks.end(), 0);
    std::stable_sort(tasks.begin(), tasks.end(), [this](std::size_t a, std::size_t b) {
      return work_of(outcome_.runs[a]) > work_of(outcome_.runs[b]);
    });
    return tasks;
  }

  /// In a worker.
  Result<std::string> work(std::size_t task) const {
    log_standard_output();
    Run run = outcome_.runs[task];
    Coverage coverage(run.arithmetic, plan_.tick);
    if (auto error = regress::perform(plan_, run, coverage)) return *error;
    return to_text(run, coverage);
  }

  std::optional<Error> take(const workers::Ended& ended, workers::Progress& progress) {
    constexpr std::string_view refused = "refused: ";
    if (ended.ending.rfind(refused, 0) == 0) return Error{ended.ending.substr(refused.size())};
    Run& run = outcome_.runs[ended.task];
    run.done = true;
    run.wall_s = ended.wall_s;
    std::string ending = ended.ending;
    if (ending == workers::finished && !take_result(ended.result, run))
      ending = "crashed: its result cannot be read";
    if (ending == "out of time")
      ending += fmt::format(": it did not end within {:.3g} s (--time-limit)", limits_.seconds);
    else if (const std::string said = last_words(ended.log);
             ending.rfind("crashed", 0) == 0 && !said.empty())
      ending += ": " + printable(said, longest_words);
    if (ending != workers::finished)
      run.finding = Finding{Finding::Kind::no_result, 0, ending, "", ended.log, 0, {}};
    progress.done(!run.finding, work_of(run));
    return std::nullopt;
  }

  /// false: a process that its RTL has damaged wrote it.
  bool take_result(const std::string& text, Run& run) {
    for (auto& [arithmetic, sum] : outcome_.coverage)
      if (arithmetic == run.arithmetic) return take_text(text, run, sum);
    return false;
  }

  const Plan& plan_;
  const std::function<void(const Outcome&)>& asked_;
  workers::Limits limits_{0};
  Outcome outcome_;
};

}  // namespace

const char* name_of(Arithmetic arithmetic) {
  return arithmetic == Arithmetic::paper ? "paper" : "precise";
}

const Run* Outcome::first_failure() const {
  const Run* first = nullptr;
  for (const Run& run : runs)
    if (run.finding && (first == nullptr || run.finding->kind < first->finding->kind)) first = &run;
  return first;
}

size_t Outcome::done() const {
  return static_cast<size_t>(
      std::count_if(runs.begin(), runs.end(), [](const Run& run) { return run.done; }));
}

double should_end_within(const Budget& budget) {
  constexpr double start = 300, each = 0.02;
  return start + each * static_cast<double>(budget.samples + budget.accesses);
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
        const std::string name =
            fmt::format("{}-{}-{}", name_of(arithmetic), scenario->name, run.seed);
        if (!plan.waves_directory.empty()) run.waves_file = plan.waves_directory + "/" + name;
        if (!plan.coverage_directory.empty())
          run.coverage_file = plan.coverage_directory + "/" + name + ".dat";
        runs.push_back(std::move(run));
      }
  return runs;
}

std::optional<Error> perform(const Plan& plan, Run& run, Coverage& coverage) {
  auto comparison = plan.compare(run.arithmetic);
  if (!comparison) return Error{comparison.error()};
  Comparison& pair = *comparison.value();
  const auto drive = [&](coprocessor::Device& device, Coverage& covered,
                         std::function<bool()> failed) {
    Bench bench(device, run.arithmetic, covered, std::move(failed), pair.bus());
    const auto stream = static_cast<uint64_t>(run.scenario - scenarios().data());
    Random random(run.seed, stream);
    write_nodes(bench);
    run.scenario->run(bench, random, run.budget);
    bench.drain();
    return bench;
  };
  const Bench bench = drive(pair.device(), coverage, [&pair] { return pair.differs(); });
  run.done = true;
  run.counts = bench.counts();
  run.finding = pair.finding();
  if (const auto& complaint = bench.complaint(); complaint && !run.finding)
    run.finding = Finding{
        Finding::Kind::wrong, complaint->edge, complaint->what, "", complaint->report, 0, {}};
  if (run.finding && !run.waves_file.empty()) {
    const auto again = [&](coprocessor::Device& device, std::function<bool()> failed) {
      Coverage unused(run.arithmetic, plan.tick);
      drive(device, unused, std::move(failed));
    };
    const auto waves = pair.write_waves(run.waves_file, again);
    if (!waves) return Error{waves.error()};
    run.has_waves = waves.value();
  }
  if (run.coverage_file.empty()) return std::nullopt;
  return pair.write_coverage(run.coverage_file);
}

Result<Outcome> run_campaign(const Plan& plan, const std::function<void(const Outcome&)>& asked) {
  auto runs = runs_of(plan);
  if (!runs) return Error{runs.error()};
  return Regression(plan, std::move(runs.value()), asked).perform();
}

}  // namespace capsoc::regress
