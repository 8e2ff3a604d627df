// What the report of `capsoc run` says next to its figures.
#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

#include "report/html.h"
#include "report/page.h"

namespace capsoc::report {
namespace {

constexpr const char* parameter_names[] = {"a1", "a2", "b1", "b2", "beta", "phi"};

std::string parameters_of(const Json& result) {
  Table table{"Parameters at the end of demodulation (full scale, rad)",
              {"parameter", "word", "identified", "true", "relative error"},
              {}};
  for (const char* name : parameter_names) {
    const Json* row = find(result, {"parameters", name});
    if (row == nullptr) continue;
    table.rows.push_back({name, shown_at(*row, {"word"}), shown_at(*row, {"value"}),
                          shown_at(*row, {"true"}), shown_at(*row, {"relative_error"})});
  }
  return html_of(table);
}

std::string figures_of_run(const Json& result) {
  Table table{"Figures of the run", {"figure", "value"}, {}};
  const auto add = [&](const char* name, const std::string& value) {
    if (value != "-") table.rows.push_back({name, value});
  };
  add("largest angle error before, deg", shown_at(result, {"angle_error_deg", "uncalibrated_max"}));
  add("the same as the SoC paper counts, deg",
      shown_at(result, {"angle_error_deg", "uncalibrated_max_paper"}));
  add("last turn of demodulation, deg",
      shown_at(result, {"angle_error_deg", "calibrated_max_last_revolution"}));
  add("calibration mode, deg", shown_at(result, {"angle_error_deg", "calibration_mode_max"}));
  add("convergence to 1 %", shown_at(result, {"convergence"}));
  add("after, s", shown_at(result, {"convergence_s"}));
  add("the program's own bound, deg", shown_at(result, {"verdict", "bound_deg"}));
  add("the bound holds", shown_at(result, {"verdict", "bound_holds"}));
  add("the program's reason", shown_at(result, {"verdict", "reason"}));
  add("samples", shown_at(result, {"samples"}));
  add("simulated time, s", shown_at(result, {"time", "simulated_s"}));
  add("host's time, s", shown_at(result, {"time", "wall_s"}));
  add("instructions", shown_at(result, {"cpu", "instructions"}));
  add("cycles", shown_at(result, {"cpu", "cycles"}));
  add("golden: the angle", shown_at(result, {"golden", "angle", "verdict"}));
  return html_of(table);
}

/// Of a run with several.
std::string sensors_of(const Json& result) {
  Table table{
      "Sensors: parameters (full scale, rad), largest angle error before and in the last turn "
      "(deg)",
      {"channel", "sensor", "samples", "valid", "a1", "a2", "b1", "b2", "beta", "before",
       "last turn"},
      {}};
  for (const Json* sensor : elements_at(result, {"sensors"})) {
    std::vector<Cell> row;
    for (const char* key : {"channel", "path", "samples", "valid"})
      row.push_back(shown_at(*sensor, {key}));
    for (const char* name : {"a1", "a2", "b1", "b2", "beta"})
      row.push_back(shown_at(*sensor, {"parameters", name, "value"}));
    for (const char* key : {"uncalibrated_max", "last_revolution"})
      row.push_back(shown_at(*sensor, {"angle_error_deg", key}));
    table.rows.push_back(std::move(row));
  }
  return table.rows.empty() ? "" : html_of(table);
}

std::string reports_of(const Json& result) {
  std::string out;
  for (const char* key : {"fault_report", "place_report", "divergence"})
    if (const std::string text = text_at(result, {key}); !text.empty())
      out += preformatted("What went wrong", text);
  for (const char* key : {"sensor_warnings", "lost"})
    for (const Json* sentence : elements_at(result, {key}))
      out += paragraph(text_at(*sentence, {}));
  return out;
}

std::string uart_of(const Json& result) {
  std::string out =
      paragraph(fmt::format("{} bytes, SHA-256 {}.", shown_at(result, {"uart0", "bytes"}),
                            shown_at(result, {"uart0", "sha256"})));
  const auto left_out = number_at(result, {"uart0", "left_out"});
  if (left_out.value_or(0) > 0)
    out += paragraph(fmt::format("{:g} bytes in the middle are left out.", *left_out));
  if (find(result, {"uart0", "text"}) != nullptr)
    out += preformatted("UART 0", text_at(result, {"uart0", "text"}));
  return out;
}

std::string functions_of(const Json& result) {
  Table table{"Functions that took the most cycles, without what they called",
              {"function", "cycles", "instructions"},
              {}};
  for (const Json* function : elements_at(result, {"profile"}))
    table.rows.push_back({text_at(*function, {"function"}), shown_at(*function, {"cycles"}),
                          shown_at(*function, {"instructions"})});
  if (table.rows.empty())
    return paragraph("There is none: run with --profile FILE, which steps every instruction.");
  return html_of(table);
}

std::string configuration_of(const Json& result) {
  Table table{"Configuration", {"setting", "value"}, {}, true};
  if (const Json* all = find(result, {"configuration"}); all != nullptr && all->is_object())
    for (const auto& [name, value] : all->items())
      table.rows.push_back({name, shown_at(value, {})});
  return html_of(table);
}

std::string curves_missing(const Json& result) {
  if (find(result, {"curves"}) != nullptr) return "";
  return paragraph("This result has no curves: run with --curves or --html.");
}

}  // namespace

void add_run_sections(Page& page) {
  const auto each = [&](std::string (*piece)(const Json&)) { return page.of_each("run", piece); };
  const auto figures = [&](const char* section) { return page.figures_of("run", section); };
  page.add("Errors of the angle", figures("Errors of the angle"));
  page.add("Result", each(figures_of_run) + each(parameters_of) + each(sensors_of) +
                         each(reports_of) + each(curves_missing));
  for (const char* section : {"Learning curves", "Errors of the parameters",
                              "Errors of the demodulator", "The signals", "Status and flags"})
    page.add(section, figures(section));
  page.add("UART 0", each(uart_of));
  page.add("Profile", figures("Profile") + each(functions_of));
  page.add("Configuration", each(configuration_of));
  page.add("Where it comes from", each(origin_of));
}

}  // namespace capsoc::report
