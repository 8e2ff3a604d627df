// The answer of `capsoc campaign`.
#include <fmt/format.h>

#include "report/headline.h"
#include "report/number_text.h"

namespace capsoc::report {
namespace {

/// The criterion that the fewest runs meet, if that is not all of them.
std::string hardest_criterion(const Json& result, double done) {
  std::string name;
  double least = done;
  for (const Json* each : elements_at(result, {"criteria"}))
    if (const auto met = number_at(*each, {"met"}); met && *met < least) {
      least = *met;
      name = text_at(*each, {"name"});
    }
  return name.empty() || done <= 0
             ? ""
             : fmt::format(". The fewest runs meet {}: {}", name, percent(least / done));
}

void add_yield(Headline& headline, const Json& result, double yield) {
  headline.figures.push_back({"yield", percent(yield), shown_at(result, {"yield"})});
  const auto interval = elements_at(result, {"yield_interval"});
  if (interval.size() != 2) return;
  const auto least = number_at(*interval[0], {}), greatest = number_at(*interval[1], {});
  if (least && greatest)
    headline.figures.push_back({"95 % interval of the yield",
                                fmt::format("{:.2f} to {}", 100 * *least, percent(*greatest)),
                                shown_at(*interval[0], {}) + " to " + shown_at(*interval[1], {})});
}

void add_worst(Headline& headline, const Json& result) {
  const auto worst = elements_at(result, {"worst"});
  if (worst.empty()) return;
  if (const auto value = number_at(*worst.front(), {"worst"}))
    headline.figures.push_back({"largest " + text_at(result, {"worst_metric"}),
                                fmt::format("{:.3g}", *value),
                                shown_at(*worst.front(), {"worst"})});
}

}  // namespace

Headline headline_of_campaign(const Json& result) {
  Headline headline;
  const auto yield = number_at(result, {"yield"});
  const double wanted = number_at(result, {"least_yield"}).value_or(0);
  const std::string done = shown_at(result, {"done"}), runs = shown_at(result, {"runs"});
  if (!yield) return {"odd", "no run is done", "No run is done", {}};
  const bool reached = *yield >= wanted;
  headline.style = !reached ? "bad" : done == runs ? "good" : "odd";
  headline.verdict = reached ? "the yield is reached" : "the yield is not reached";
  headline.sentence = fmt::format("Yield {}: {} of {} runs passed, wanted {}", percent(*yield),
                                  shown_at(result, {"passed"}), done, percent(wanted));
  if (!reached)
    headline.sentence += hardest_criterion(result, number_at(result, {"done"}).value_or(0));
  if (done != runs) {
    headline.verdict += " so far";
    headline.sentence += fmt::format(". {} of {} runs are done", done, runs);
  }
  add_yield(headline, result, *yield);
  add_worst(headline, result);
  return headline;
}

}  // namespace capsoc::report
