#include "fault/trial.h"

#include <fmt/format.h>

#include <cmath>
#include <systemc>
#include <utility>

#include "fault/sample_results.h"
#include "kit/seconds.h"
#include "results/exit_codes.h"
#include "session/simulation.h"

namespace capsoc::fault {
namespace {

class Trial {
 public:
  Trial(run::Simulation& simulation, const TrialSettings& settings, const Golden& golden,
        const Start& start)
      : simulation_(simulation),
        settings_(settings),
        golden_(golden),
        from_s_(static_cast<double>(start.time_ps) * 1e-12),
        judgement_({settings.limit_deg(), static_cast<uint64_t>(settings.silent_samples())}),
        results_(simulation, [this](const SampleResult& result) { take(result); }) {
    // One that was on its way is not told here.
    while (next_ < golden.results.size() && golden.results[next_].number <= start.sample) ++next_;
  }

  Result<Outcome> perform() {
    auto next = static_cast<uint64_t>(std::floor((from_s_ - golden_.from_s) / step_s)) + 1;
    for (uint64_t distance = 0; next < golden_.hashes.size();) {
      const double time_s = golden_.from_s + static_cast<double>(next) * step_s;
      const auto goes_on = simulation_.advance_to(sc_core::sc_time(time_s, sc_core::SC_SEC));
      if (!goes_on) return Error{goes_on.error()};
      if (!goes_on.value()) return conclude(true, false);
      if (!judgement_.detected_by().empty()) return conclude(false, false);
      const bool acted = simulation_.faults_are_over();
      if (acted && is_as_golden(golden_.hashes[next])) return conclude(false, true);
      // After the fault less and less often: most are found at once or never.
      if (acted) distance = distance == 0 ? 1 : 2 * distance;
      const uint64_t last = golden_.hashes.size() - 1;
      next = next < last ? std::min(last, next + std::max<uint64_t>(1, distance)) : next + 1;
    }
    if (auto error = simulation_.advance_to_end()) return *error;
    return conclude(true, false);
  }

 private:
  bool is_as_golden(const std::optional<uint64_t>& hash) {
    return hash && simulation_.state_hash() == hash;
  }

  /// In the order of the samples; one that got lost is missed by the next.
  void take(const SampleResult& result) {
    const auto& all = golden_.results;
    while (next_ < all.size() && all[next_].number < result.number)
      judgement_.take(all[next_++], nullptr);
    if (next_ < all.size() && all[next_].number == result.number)
      judgement_.take(all[next_++], &result);
  }

  Outcome conclude(bool is_over, bool is_same_state) {
    Ending ending;
    ending.golden_code = ending.code = golden_.code;
    ending.is_same_state = is_same_state;
    const double now_s = kit::to_seconds(sc_core::sc_time_stamp());
    const run::RunResult result = simulation_.finish();
    if (is_over) ending.code = result.code;
    // A program that gives up takes no more samples.
    while (is_over && ending.code == golden_.code && next_ < golden_.results.size())
      judgement_.take(golden_.results[next_++], nullptr);
    if (is_over && ending.code != golden_.code) judgement_.note_end();
    Outcome outcome;
    for (const run::FaultOutcome& fault : result.faults) {
      ending.is_applied = ending.is_applied && fault.applied && fault.note.empty();
      outcome.by = fault.note;
    }
    outcome.verdict = judgement_.conclude(ending);
    if (outcome.verdict != Verdict::unapplied) outcome.by = judgement_.detected_by();
    if (outcome.verdict == Verdict::crashed) outcome.by = "fault report";
    if (outcome.verdict == Verdict::detected && outcome.by.empty())
      outcome.by = fmt::format("exit {}", ending.code);
    outcome.after = judgement_.detected_after();
    outcome.largest_deg = judgement_.largest_deg();
    outcome.trusted = judgement_.trusted();
    outcome.simulated_s = now_s - from_s_;
    return outcome;
  }

  run::Simulation& simulation_;
  const TrialSettings& settings_;
  const Golden& golden_;
  double from_s_;
  Judgement judgement_;
  std::size_t next_ = 0;  // of the golden results
  SampleResults results_;
};

}  // namespace

Result<Outcome> try_fault(const run::RunSettings& settings, const TrialSettings& trial,
                          const Drawn& drawn, const Golden& golden, std::string state) {
  run::Simulation::Additions additions;
  additions.state = std::move(state);
  auto simulation = run::Simulation::construct(settings, additions);
  if (!simulation) return Error{simulation.error()};
  return Trial(*simulation.value(), trial, golden, golden.starts[drawn.start]).perform();
}

}  // namespace capsoc::fault
