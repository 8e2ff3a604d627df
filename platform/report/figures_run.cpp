// The figures of `capsoc run`, of the curves that --html and --curves put into its results.
#include <fmt/format.h>

#include <array>
#include <cmath>

#include "base/constants.h"
#include "report/figure.h"

namespace capsoc::report {
namespace {

constexpr const char* time_axis = "time, s";

struct RunParameter {
  const char *name, *words, *unit, *part;
};
constexpr std::array<RunParameter, 6> run_parameters = {
    {{"a1", "amplitude of U", "full scale", "(a)"},
     {"a2", "amplitude of V", "full scale", "(b)"},
     {"b1", "offset of U", "full scale", "(c)"},
     {"b2", "offset of V", "full scale", "(d)"},
     {"beta", "phase shift between U and V", "rad", "(f)"},
     {"phi", "start angle", "rad", "(e)"}}};

void add(Data& data, const std::string& name, const Json& result, const char* curve) {
  Curve found = curve_at(result, {"curves", curve});
  if (!found.x.empty()) data.series.push_back({name, std::move(found)});
}

Data learning_curve(const Figure& figure, const Json& result) {
  Data data;
  add(data, figure.name, result, figure.name.c_str());
  if (data.series.empty()) return data;
  if (const auto truth = number_at(result, {"parameters", figure.name.c_str(), "true"}))
    data.marks.push_back({"true", *truth});
  return data;
}

/// The difference to the truth relative to it, as the result file has it for the end.
Data parameter_error(const Figure& figure, const Json& result) {
  const std::string name = figure.name.substr(0, figure.name.find('-'));
  const bool angle = name == "beta" || name == "phi";
  const auto truth = number_at(result, {"parameters", name.c_str(), "true"});
  if (!truth || *truth == 0) return {};
  Data data;
  add(data, name, result, name.c_str());
  for (Series& series : data.series)
    for (double& y : series.curve.y) {
      const double difference = y - *truth;
      y = rounded((angle ? std::remainder(difference, two_pi) : difference) / *truth, 7);
    }
  if (!data.series.empty()) data.marks.push_back({"1 %: converged below", 0.01});
  return data;
}

/// Figures that draw curves as they are: figure, name of the curve there, curve of the result.
struct Drawn {
  const char *figure, *name, *curve;
};
constexpr std::array<Drawn, 11> drawn = {{{"lms-error", "U", "err_u"},
                                          {"lms-error", "V", "err_v"},
                                          {"error-average", "average", "error_average"},
                                          {"lissajous", "U, V as sampled", "lissajous"},
                                          {"lissajous", "calibrated", "calibrated"},
                                          {"angle-error", "calibrated", "angle_error"},
                                          {"angle-error", "atan2(U, V)", "raw_error"},
                                          {"angle-error-by-angle", "calibrated", "error_by_angle"},
                                          {"angle-error-by-angle", "atan2(U, V)", "raw_by_angle"},
                                          {"spectrum", "calibrated", "spectrum"},
                                          {"spectrum", "atan2(U, V)", "raw_spectrum"}}};

Data as_it_is(const Figure& figure, const Json& result) {
  Data data;
  for (const Drawn& one : drawn)
    if (figure.name == one.figure) add(data, one.name, result, one.curve);
  return data;
}

Data spectrum(const Figure& figure, const Json& result) {
  Data data = as_it_is(figure, result);
  std::size_t orders = 0;
  for (const Series& series : data.series) orders = std::max(orders, series.curve.x.size());
  for (std::size_t order = 0; order < orders; ++order)
    data.labels.push_back(order == 0 ? "mean" : std::to_string(order));
  return data;
}

Data flags(const Figure&, const Json& result) {
  Data data;
  const Json* curves = find(result, {"curves"});
  if (curves == nullptr || !curves->is_object()) return data;
  for (const auto& [name, curve] : curves->items())
    if (name.rfind("status.", 0) == 0 || name.rfind("flags.", 0) == 0)
      add(data, name.substr(0, 40), result, name.c_str());
  return data;
}

Data profile(const Figure&, const Json& result) {
  constexpr std::size_t most = 12;
  Data data;
  Curve cycles;
  for (const Json* function : elements_at(result, {"profile"})) {
    const auto count = number_at(*function, {"cycles"});
    const std::string name = text_at(*function, {"function"});
    // Asleep is no function, and would be nearly all.
    if (!count || name == "[waiting]" || data.labels.size() == most) continue;
    cycles.add(static_cast<double>(data.labels.size()), *count);
    data.labels.push_back(name);
  }
  if (!cycles.x.empty()) data.series.push_back({"cycles", std::move(cycles)});
  return data;
}

}  // namespace

void add_run_figures(std::vector<Figure>& list) {
  for (const RunParameter& p : run_parameters)
    list.push_back({p.name, "run", "Learning curves", fmt::format("{}: {}", p.name, p.words),
                    "The coprocessor's register at each sample, and the sensor's own value.",
                    fmt::format("SoC paper, Figures 7{0}, 9 and 12", p.part), time_axis,
                    fmt::format("{}, {}", p.name, p.unit), Kind::lines, false, learning_curve});
  for (const RunParameter& p : run_parameters)
    list.push_back({fmt::format("{}-error", p.name), "run", "Errors of the parameters",
                    fmt::format("{}: relative error", p.name),
                    "Magnitude of the difference to the sensor's own value, relative to it.",
                    "SoC paper, Tables 1 and 8 (the end of the curve)", time_axis, "relative error",
                    Kind::lines, true, parameter_error});
  list.push_back({"lms-error", "run", "Errors of the demodulator", "Instantaneous error",
                  "Input minus the demodulator's estimate, for both channels.",
                  "SoC paper, Figure 7(g)", time_axis, "error, full scale", Kind::lines, false,
                  as_it_is});
  list.push_back({"error-average", "run", "Errors of the demodulator", "Average of the error",
                  "The register ERROR_AVERAGE, by which the coprocessor finds lock.", "", time_axis,
                  "average magnitude, full scale", Kind::lines, true, as_it_is});
  list.push_back({"lissajous", "run", "The signals", "Lissajous figure before and after",
                  "V over U of the last turn as sampled, and the same turn calibrated by the "
                  "parameters of the end: a unit circle.",
                  "SoC paper, Figures 6(a) and 7(h); CSFN paper, Figures 7(d) and 11(a)", "U", "V",
                  Kind::points, false, as_it_is});
  list.push_back({"angle-error", "run", "Errors of the angle", "Angle error over time",
                  "Magnitude of the coprocessor's angle minus the true one, and of atan2(U, V) "
                  "minus the true one.",
                  "SoC paper, Figures 8, 13, 17 and 18", time_axis, "angle error, deg", Kind::lines,
                  true, as_it_is});
  list.push_back({"angle-error-by-angle", "run", "Errors of the angle", "Angle error over angle",
                  "The same over the true angle, for the last turn.",
                  "CSFN paper, Figures 12, 14 and 22", "true angle, deg", "angle error, deg",
                  Kind::lines, true, as_it_is});
  list.push_back({"spectrum", "run", "Errors of the angle", "Spectrum of the angle error",
                  "Amplitude of each harmonic of the true angle in the error of the last turn, by "
                  "least squares.",
                  "SoC paper, Figure 19; CSFN paper, Figure 23 (of the signals)", "harmonic",
                  "amplitude, deg", Kind::bars, true, spectrum});
  list.push_back({"flags", "run", "Status and flags", "Lock and flags over time",
                  "Bits of the registers STATUS and FLAGS that were set once: high is 1. Flags "
                  "stay set until the program clears them.",
                  "", time_axis, "bit", Kind::lanes, false, flags});
  list.push_back({"profile", "run", "Profile", "Functions that took the most cycles",
                  "Cycles of the function itself, without what it called and without sleep.", "",
                  "function", "cycles", Kind::bars, false, profile});
}

}  // namespace capsoc::report
