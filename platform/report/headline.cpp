#include "report/headline.h"

#include <fmt/format.h>

namespace capsoc::report {
namespace {

/// Nothing for what the result does not have.
void add_degrees(Headline& headline, const char* label, const Json& result, Path path) {
  if (const auto value = number_at(result, path))
    headline.figures.push_back(
        {label, fmt::format("{:.3g} deg", *value), shown_at(result, path) + " deg"});
}

/// The verdict of a program that states one.
void judge_run(Headline& headline, const Json& result) {
  const Json* const pass = find(result, {"verdict", "pass"});
  if (pass == nullptr || !pass->is_boolean()) return;
  if (!pass->get<bool>()) {
    headline.style = "bad";
    headline.verdict = "no pass";
    headline.sentence = "No pass: " + shown_at(result, {"verdict", "reason"});
    return;
  }
  headline.style = "good";
  headline.verdict = "pass";
  const auto bound = number_at(result, {"verdict", "bound_deg"});
  headline.sentence =
      bound ? fmt::format("Pass: the angles of the last {} samples are within {:.3g} deg",
                          shown_at(result, {"verdict", "samples"}), *bound)
            : "Pass";
  std::string conditions;
  for (const Json* each : elements_at(result, {"verdict", "conditions"}))
    conditions += (conditions.empty() ? ", if " : " and ") + text_at(*each, {});
  headline.sentence += conditions;
  if (shown_at(result, {"verdict", "bound_holds"}) != "false") return;
  headline.style = "bad";
  headline.verdict = "a pass that does not hold";
  const auto error = number_at(result, {"verdict", "largest_error_deg"});
  headline.sentence +=
      fmt::format(". That does not hold: an angle is {:.3g} deg off", error.value_or(0));
}

Headline of_run(const Json& result) {
  Headline headline;
  judge_run(headline, result);
  add_degrees(headline, "largest angle error before", result,
              {"angle_error_deg", "uncalibrated_max"});
  const bool is_calibrated =
      number_at(result, {"angle_error_deg", "calibration_mode_max"}).has_value();
  if (is_calibrated)
    add_degrees(headline, "after, in calibration mode", result,
                {"angle_error_deg", "calibration_mode_max"});
  else
    add_degrees(headline, "after, in the last turn", result,
                {"angle_error_deg", "calibrated_max_last_revolution"});
  add_degrees(headline, "the program's own bound", result, {"verdict", "bound_deg"});
  return headline;
}

Headline of_fit(const Json& result) {
  Headline headline;
  headline.style = "good";
  headline.verdict = "identified";
  const auto bound = number_at(result, {"angle_bound_deg", "total"});
  const auto confidence = number_at(result, {"angle_bound_deg", "confidence"});
  headline.sentence = fmt::format("Identified from {} samples", shown_at(result, {"samples"}));
  if (bound && confidence)
    headline.sentence += fmt::format(
        ": the angle is within {:.3g} deg over the whole turn at {:g} % confidence, without what "
        "disturbs one sample and without a harmonic along the ellipse",
        *bound, 100 * *confidence);
  const std::string warning = text_at(result, {"warning"});
  if (!bound || !warning.empty()) headline.style = "odd";
  if (!bound) headline.verdict += " without a bound";
  if (!bound)
    headline.sentence += ", without a bound" + (warning.empty() ? "" : ": " + warning);
  else if (!warning.empty())
    headline.sentence += ". But " + warning;
  for (const Json* gate : elements_at(result, {"gates"}))
    if (shown_at(*gate, {"passed"}) == "false") {
      headline.style = "bad";
      headline.verdict = "refused";
      headline.sentence = "Refused: the gate " + text_at(*gate, {"name"}) + " did not pass";
      break;
    }
  add_degrees(headline, "angle error before, peak to peak", result,
              {"angle_error_deg", "uncalibrated_peak_to_peak"});
  add_degrees(headline, "after, peak to peak", result,
              {"angle_error_deg", "calibrated_peak_to_peak"});
  add_degrees(headline, "bound over the whole turn", result, {"angle_bound_deg", "total"});
  return headline;
}

}  // namespace

Headline headline_of(const Json& result) {
  const std::string command = command_of(result);
  if (command == "run") return of_run(result);
  if (command == "fit") return of_fit(result);
  if (command == "campaign") return headline_of_campaign(result);
  if (command == "regress") return headline_of_regress(result);
  if (command == "mutation") return headline_of_mutation(result);
  if (command == "reproduce") return headline_of_reproduce(result);
  if (command == "accuracy") return headline_of_accuracy(result);
  if (command == "bench") return headline_of_bench(result);
  return {};
}

}  // namespace capsoc::report
