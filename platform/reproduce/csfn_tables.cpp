#include "reproduce/csfn_tables.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "fit/fit.h"

namespace capsoc::reproduce {
namespace {

constexpr double arc_seconds = 3600;
const std::array<const char*, 5> names = {"a1", "a2", "b1", "b2", "beta"};
using FiveFigures = std::array<double, 5>;

FiveFigures figures(const csfn::Parameters& p) {
  return {p.a1, p.a2, p.b1, p.b2, p.beta};
}

std::optional<fit::Fit> fitted(Report& report, const std::string& trace,
                               const fit::FitOptions& options = {}) {
  fit::FitOptions papers = options;
  papers.identify.method = csfn::Method::adam;
  auto result = fit::fit(trace, papers);
  const std::string reason = result ? result.value().rejection : result.error();
  if (reason.empty()) return std::move(result.value());
  report.row(trace, "", reason, false);
  return std::nullopt;
}

void table_1(Report& report, const std::string& traces) {
  constexpr FiveFigures printed = {2.53e-7, 2.12e-7, -5.77e-7, -7.14e-7, 1.70e-7};
  report.heading("CSFN paper, Table 1 and Figure 12: relative errors of the simulation");
  const auto fit = fitted(report, traces + "/csfn_eq.toml");
  if (!fit) return;
  const FiveFigures found = figures(fit->answer.parameters), truth = figures(*fit->truth);
  report.sentence("A row agrees when the error is no larger than the paper's.");
  for (std::size_t i = 0; i < names.size(); ++i) {
    const double error = found.at(i) / truth.at(i) - 1;
    report.row(names.at(i), fmt::format("{:.2e}", printed.at(i)), fmt::format("{:.2e}", error),
               std::abs(error) <= std::abs(printed.at(i)));
  }
  report.row("peak to peak before, deg", "73.72", fmt::format("{:.2f}", *fit->errors.uncalibrated),
             agrees(*fit->errors.uncalibrated, 73.72, 2, 0.004));
  const double after = *fit->errors.calibrated * arc_seconds;
  report.row("after, arc seconds", "0.09", fmt::format("{:.1e}", after), after <= 0.09);
  report.sentence(
      "10,000 random angles as in the paper; which ones it drew is not known. The rate");
  report.sentence("decays here; at the paper's constant rate the end point spikes now and then.");
}

void figure_14(Report& report, const std::string& traces) {
  report.heading("CSFN paper, Figure 14: a third harmonic of 1 %");
  const auto fit = fitted(report, traces + "/csfn_h3.toml");
  if (!fit) return;
  report.row("peak to peak before, deg", "74.17", fmt::format("{:.2f}", *fit->errors.uncalibrated),
             agrees(*fit->errors.uncalibrated, 74.17, 2, 0.004));
  report.row("after, deg", "3.77", fmt::format("{:.2f}", *fit->errors.calibrated),
             agrees(*fit->errors.calibrated, 3.77, 2, 0.05));
}

void table_2(Report& report, const std::string& traces) {
  constexpr FiveFigures printed = {0.6083, 0.6223, 0.1324, 0.1830, 0.0657};
  report.heading("CSFN paper, Table 2 and Figure 22: the experiment, rebuilt");
  fit::FitOptions options;
  const auto fit = fitted(report, traces + "/csfn_experiment.toml", options);
  if (!fit) return;
  const FiveFigures found = figures(fit->answer.parameters);
  for (std::size_t i = 0; i < names.size(); ++i)
    report.row(names.at(i), fmt::format("{:.4f}", printed.at(i)),
               fmt::format("{:.4f}", found.at(i)), agrees(found.at(i), printed.at(i), 4, 0.02));
  report.row("peak to peak before, deg", "42.57", fmt::format("{:.2f}", *fit->errors.uncalibrated),
             agrees(*fit->errors.uncalibrated, 42.57, 2, 0.002));
  report.row("after, deg", "2.97", fmt::format("{:.2f}", *fit->errors.calibrated),
             agrees(*fit->errors.calibrated, 2.97, 2, 0.05));
}

}  // namespace

void csfn_tables(Report& report, const std::string& traces) {
  table_1(report, traces);
  figure_14(report, traces);
  table_2(report, traces);
}

}  // namespace capsoc::reproduce
