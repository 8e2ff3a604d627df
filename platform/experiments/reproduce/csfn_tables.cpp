#include "reproduce/csfn_tables.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "fit/fit.h"
#include "reproduce/figures.h"

namespace capsoc::reproduce {
namespace {

constexpr double arc_seconds = 3600;
const std::array<const char*, 5> names = {"a1", "a2", "b1", "b2", "beta"};
using FiveFigures = std::array<double, 5>;

FiveFigures figures(const identification::Parameters& p) {
  return {p.a1, p.a2, p.b1, p.b2, p.beta};
}

std::optional<fit::Fit> fitted(Report& report, const std::string& trace,
                               const fit::FitOptions& options = {}) {
  fit::FitOptions papers = options;
  papers.identify.method = identification::Method::adam;
  papers.identify.trace = true;
  auto result = fit::fit(trace, papers);
  const std::string reason = result ? result.value().rejection : result.error();
  if (reason.empty()) return std::move(result.value());
  report.failure(trace, reason);
  return std::nullopt;
}

void ratio_row(Report& report, const fit::AngleErrors& errors, double printed) {
  const double percent = 100 * *errors.calibrated / *errors.uncalibrated;
  report.row("reduction ratio, %", fixed(printed, 2), fixed(percent, 2),
             agrees(percent, printed, 2, 0.05));
}

void table_1(Report& report, const std::string& traces) {
  constexpr FiveFigures printed = {2.53e-7, 2.12e-7, -5.77e-7, -7.14e-7, 1.70e-7};
  report.heading("csfn-1");
  const auto fit = fitted(report, traces + "/csfn_eq.toml");
  if (!fit) return;
  const FiveFigures found = figures(fit->answer.parameters), truth = figures(*fit->truth);
  report.sentence("A row agrees when the error is no larger than the paper's.");
  for (std::size_t i = 0; i < names.size(); ++i) {
    const double error = found.at(i) / truth.at(i) - 1;
    const double largest = std::abs(printed.at(i));
    report.row(names.at(i), scientific(printed.at(i), 2), scientific(error, 2),
               lies_in(scientific(error, 2), {-largest, largest}));
  }
  report.row("peak to peak before, deg", "73.72", fixed(*fit->errors.uncalibrated, 2),
             agrees(*fit->errors.uncalibrated, 73.72, 2, 0.004));
  const double after = *fit->errors.calibrated * arc_seconds;
  report.row("after, arc seconds", "0.09", scientific(after, 1),
             lies_in(scientific(after, 1), Bound::at_most(0.09)));
  const double percent = 100 * *fit->errors.calibrated / *fit->errors.uncalibrated;
  report.row("reduction ratio, %", "0.00003", scientific(percent, 1),
             lies_in(scientific(percent, 1), Bound::at_most(0.00003)));
  report.sentence(
      "10,000 random angles as in the paper; which ones it drew is not known. The rate");
  report.sentence("decays here; at the paper's constant rate the end point spikes now and then.");
  report.heading("csfn-figure-8");
  learning_rows(report, *fit);
}

void figure_14(Report& report, const std::string& traces) {
  report.heading("csfn-figure-14");
  const auto fit = fitted(report, traces + "/csfn_h3.toml");
  if (!fit) return;
  report.row("peak to peak before, deg", "74.17", fixed(*fit->errors.uncalibrated, 2),
             agrees(*fit->errors.uncalibrated, 74.17, 2, 0.004));
  report.row("after, deg", "3.77", fixed(*fit->errors.calibrated, 2),
             agrees(*fit->errors.calibrated, 3.77, 2, 0.05));
  ratio_row(report, fit->errors, 5.08);
}

void table_2(Report& report, const std::string& traces) {
  constexpr FiveFigures printed = {0.6083, 0.6223, 0.1324, 0.1830, 0.0657};
  report.heading("csfn-2");
  fit::FitOptions options;
  options.identify.adam.batch = 1000;  // section 4.2
  const auto fit = fitted(report, traces + "/csfn_experiment.toml", options);
  if (!fit) return;
  const FiveFigures found = figures(fit->answer.parameters);
  for (std::size_t i = 0; i < names.size(); ++i)
    report.row(names.at(i), fixed(printed.at(i), 4), fixed(found.at(i), 4),
               agrees(found.at(i), printed.at(i), 4, 0.02));
  report.row("peak to peak before, deg", "42.57", fixed(*fit->errors.uncalibrated, 2),
             agrees(*fit->errors.uncalibrated, 42.57, 2, 0.002));
  report.row("after, deg", "2.97", fixed(*fit->errors.calibrated, 2),
             agrees(*fit->errors.calibrated, 2.97, 2, 0.05));
  ratio_row(report, fit->errors, 6.98);
  report.heading("csfn-figure-18");
  learning_rows(report, *fit);
  report.heading("csfn-figure-23");
  spectrum_rows(report, fit->record, {0.0044, 0.01035, 0, 0});
}

}  // namespace

void csfn_tables(Report& report, const std::string& traces) {
  if (report.wants({"csfn-1", "csfn-figure-8"})) table_1(report, traces);
  if (report.wants({"csfn-figure-14"})) figure_14(report, traces);
  if (report.wants({"csfn-2", "csfn-figure-18", "csfn-figure-23"})) table_2(report, traces);
}

}  // namespace capsoc::reproduce
