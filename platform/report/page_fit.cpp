// What the report of `capsoc fit` says next to its figures.
#include <fmt/format.h>

#include "report/html.h"
#include "report/page.h"

namespace capsoc::report {
namespace {

std::string answer_of(const Json& result) {
  Table parameters{"Identified parameters (full scale, rad)",
                   {"parameter", "word", "value", "interval", "true", "relative error"},
                   {}};
  for (const char* name : {"a1", "a2", "b1", "b2", "beta", "phi"}) {
    const Json* row = find(result, {"parameters", name});
    if (row == nullptr) continue;
    parameters.rows.push_back({name, shown_at(*row, {"word"}), shown_at(*row, {"value"}),
                               shown_at(*row, {"interval"}), shown_at(*row, {"true"}),
                               shown_at(*row, {"relative_error"})});
  }
  Table figures{"Figures of the fit", {"figure", "value"}, {}};
  const auto add = [&](const char* name, Path path) {
    if (const std::string text = shown_at(result, path); text != "-" && !text.empty())
      figures.rows.push_back({name, text});
  };
  add("method", {"method"});
  add("stopped by", {"stop_reason"});
  add("iterations", {"iterations"});
  add("samples", {"samples"});
  add("bits of the converter", {"adc_bits"});
  add("loss", {"loss"});
  add("residual, rms", {"residuals", "rms"});
  add("residual, largest", {"residuals", "largest"});
  add("noise, full scale", {"residuals", "noise"});
  add("confidence of the intervals", {"confidence"});
  add("rotation", {"handedness"});
  add("bound of the angle, deg", {"angle_bound_deg", "total"});
  add("angle error before, peak to peak, deg", {"angle_error_deg", "uncalibrated_peak_to_peak"});
  add("after", {"angle_error_deg", "calibrated_peak_to_peak"});
  add("with harmonics taken off", {"angle_error_deg", "with_harmonics_peak_to_peak"});
  add("harmonics", {"harmonics", "reason"});
  add("warning", {"warning"});
  add("disagreement", {"disagreement"});
  return html_of(parameters) + html_of(figures);
}

std::string gates_of(const Json& result) {
  Table gates{
      "Gates, in the order in which they were checked", {"gate", "passed", "value", "limit"}, {}};
  for (const Json* gate : elements_at(result, {"gates"})) {
    const std::string passed = shown_at(*gate, {"passed"});
    gates.rows.push_back({text_at(*gate, {"name"}),
                          {passed, passed == "true" ? "good" : "bad"},
                          shown_at(*gate, {"value"}),
                          shown_at(*gate, {"limit"})});
  }
  return html_of(gates);
}

std::string methods_of(const Json& result) {
  std::string out;
  for (const char* list : {"companions", "methods"}) {
    Table methods{list == std::string("methods") ? "Every method" : "Closed-form companions",
                  {"method", "a1", "a2", "b1", "b2", "beta", "difference", "loss", "error"},
                  {}};
    for (const Json* method : elements_at(result, {list})) {
      std::vector<Cell> row = {text_at(*method, {"method"})};
      for (const char* name : {"a1", "a2", "b1", "b2", "beta"})
        row.emplace_back(shown_at(*method, {"parameters", name}));
      row.emplace_back(shown_at(*method, {"difference"}));
      row.emplace_back(shown_at(*method, {"loss"}));
      row.emplace_back(text_at(*method, {"error"}));
      methods.rows.push_back(std::move(row));
    }
    out += html_of(methods);
  }
  return out;
}

}  // namespace

void add_fit_sections(Page& page) {
  const auto figures = [&](const char* section) { return page.figures_of("fit", section); };
  page.add("Angle error", figures("Angle error"));
  page.add("Result", page.of_each("fit", answer_of));
  for (const char* section : {"Ellipse", "Residuals", "Training"})
    page.add(section, figures(section));
  page.add("Confidence", figures("Confidence") + page.of_each("fit", methods_of));
  page.add("Gates", page.of_each("fit", gates_of));
  page.add("Where it comes from", page.of_each("fit", origin_of));
}

}  // namespace capsoc::report
