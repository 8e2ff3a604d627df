// The answers of `capsoc regress` and of the mutation score.
#include <fmt/format.h>

#include "report/headline.h"
#include "report/number_text.h"

namespace capsoc::report {
namespace {

/// What all runs compared, and the bins of functional coverage.
struct Totals {
  uint64_t runs = 0, different = 0, bins = 0, hit = 0;
  double cycles = 0, samples = 0;
  const Json* first_difference = nullptr;  ///< the run that has it
  std::string arithmetic;                  ///< of that run
};

void count_bins(Totals& all, const Json* groups) {
  if (groups == nullptr || !groups->is_object()) return;
  for (const Json& bins : *groups) {
    if (!bins.is_object()) continue;
    for (const Json& hits : bins) {
      ++all.bins;
      if (number_at(hits, {}).value_or(0) > 0) ++all.hit;
    }
  }
}

Totals totals_of(const Json& result) {
  Totals all;
  for (const char* arithmetic : arithmetics) {
    for (const Json* run : elements_at(result, {"arithmetics", arithmetic, "runs"})) {
      ++all.runs;
      all.cycles += number_at(*run, {"cycles"}).value_or(0);
      all.samples += number_at(*run, {"samples"}).value_or(0);
      if (find(*run, {"difference"}) == nullptr) continue;
      ++all.different;
      if (all.first_difference != nullptr) continue;
      all.first_difference = run;
      all.arithmetic = arithmetic;
    }
    count_bins(all, find(result, {"arithmetics", arithmetic, "coverage"}));
  }
  return all;
}

/// Points of the RTL of one kind that are covered, of those that can be, over both arithmetics.
void add_rtl_coverage(Headline& headline, const Json& result, const char* kind) {
  double covered = 0, points = 0;
  for (const char* arithmetic : arithmetics)
    if (const Json* part = find(result, {"arithmetics", arithmetic, "rtl_coverage", kind})) {
      covered += number_at(*part, {"covered"}).value_or(0);
      points +=
          number_at(*part, {"points"}).value_or(0) - number_at(*part, {"excepted"}).value_or(0);
    }
  if (points > 0)
    headline.figures.push_back({fmt::format("RTL {} coverage", kind), percent(covered / points),
                                fmt::format("{:.0f} of {:.0f}", covered, points)});
}

void add_figures(Headline& headline, const Totals& all, const Json& result) {
  headline.figures.push_back(
      {"clocks compared", three_digits(all.cycles), fmt::format("{:.0f}", all.cycles)});
  const std::string different = fmt::format("{} of {}", all.different, all.runs);
  headline.figures.push_back({"runs that differ", different, different});
  if (all.first_difference != nullptr) {
    const std::string cycle = shown_at(*all.first_difference, {"difference", "cycle"});
    headline.figures.push_back({"first difference at clock", cycle, cycle});
  }
  headline.figures.push_back({"functional coverage", fmt::format("{} of {}", all.hit, all.bins),
                              fmt::format("{} of {} bins", all.hit, all.bins)});
  for (const char* kind : {"line", "toggle"}) add_rtl_coverage(headline, result, kind);
}

}  // namespace

Headline headline_of_regress(const Json& result) {
  const Totals all = totals_of(result);
  const Json* partial = find(result, {"partial"});
  Headline headline;
  if (all.first_difference != nullptr) {
    const Json& run = *all.first_difference;
    headline.style = "bad";
    headline.verdict =
        text_at(run, {"difference", "kind"}) == "no result" ? "no result" : "difference";
    headline.sentence =
        fmt::format("{} in scenario {} ({}), seed {}, cycle {}: {}",
                    headline.verdict == "no result" ? "No result" : "Difference",
                    text_at(run, {"scenario"}), all.arithmetic, shown_at(run, {"seed"}),
                    shown_at(run, {"difference", "cycle"}), text_at(run, {"difference", "what"}));
  } else {
    headline.style = partial == nullptr && all.hit == all.bins ? "good" : "odd";
    headline.verdict = partial == nullptr ? "no difference" : "no difference until here";
    headline.sentence =
        fmt::format("No difference{} between the model and the RTL: {} runs, {} clocks, {} samples",
                    partial == nullptr ? "" : " until here", all.runs, three_digits(all.cycles),
                    three_digits(all.samples));
    if (partial == nullptr && all.hit < all.bins)
      headline.sentence +=
          fmt::format(". But {} of {} coverage bins are missing", all.bins - all.hit, all.bins);
  }
  if (partial != nullptr)
    headline.sentence += fmt::format(". Partial: {} of {} runs are done",
                                     shown_at(*partial, {"done"}), shown_at(*partial, {"of"}));
  add_figures(headline, all, result);
  return headline;
}

Headline headline_of_mutation(const Json& result) {
  constexpr double least_score = 0.95;
  double killed = 0, survived = 0, equivalent = 0;
  for (const char* arithmetic : arithmetics) {
    const Json* files = find(result, {"arithmetics", arithmetic, "files"});
    if (files == nullptr || !files->is_object()) continue;
    for (const Json& counts : *files) {
      killed += number_at(counts, {"killed"}).value_or(0);
      survived += number_at(counts, {"survived"}).value_or(0);
      equivalent += number_at(counts, {"equivalent"}).value_or(0);
    }
  }
  const double decided = killed + survived;
  if (decided <= 0) return {};
  const bool good = killed / decided >= least_score;
  const auto count = [](const char* label, double value) {
    const std::string text = fmt::format("{:.0f}", value);
    return Headline::Figure{label, text, text};
  };
  return {good ? "good" : "bad",
          good ? "the score is reached" : "the score is not reached",
          fmt::format("The regression kills {} of the mutants: {:.0f} of {:.0f}, wanted {}",
                      percent(killed / decided), killed, decided, percent(least_score)),
          {{"mutation score", percent(killed / decided), fmt::format("{}", killed / decided)},
           count("survivors", survived),
           count("equivalent mutants", equivalent)}};
}

}  // namespace capsoc::report
