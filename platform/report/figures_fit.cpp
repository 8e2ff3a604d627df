// The figures of `capsoc fit`.
#include <array>
#include <cmath>

#include "report/figure.h"

namespace capsoc::report {
namespace {

constexpr std::array<const char*, 5> fit_parameters = {"a1", "a2", "b1", "b2", "beta"};

/// A line of a figure and the curve that it shows.
struct Line {
  const char *name, *curve;
};

template <std::size_t count>
Data lines_of(const Json& result, const std::array<Line, count>& lines) {
  Data data;
  for (const Line& line : lines) {
    Curve curve = curve_at(result, {"curves", line.curve});
    if (!curve.x.empty()) data.series.push_back({line.name, std::move(curve)});
  }
  return data;
}

Data ellipse(const Figure&, const Json& result) {
  return lines_of<2>(result, {{{"samples", "samples"}, {"fitted", "ellipse"}}});
}

Data residuals(const Figure&, const Json& result) {
  return lines_of<1>(result, {{{"1 - Y", "residual"}}});
}

Data residuals_by_angle(const Figure&, const Json& result) {
  return lines_of<1>(result, {{{"1 - Y", "residual_by_angle"}}});
}

Data loss(const Figure&, const Json& result) {
  return lines_of<1>(result, {{{"loss", "loss"}}});
}

Data learning(const Figure&, const Json& result) {
  return lines_of<5>(result, {{{"a1", "iteration.a1"},
                               {"a2", "iteration.a2"},
                               {"b1", "iteration.b1"},
                               {"b2", "iteration.b2"},
                               {"beta", "iteration.beta"}}});
}

Data angle_error(const Figure&, const Json& result) {
  return lines_of<2>(result, {{{"calibrated", "error_by_angle"}, {"atan2(U, V)", "raw_by_angle"}}});
}

/// Half widths, and how far the truth is.
Data intervals(const Figure&, const Json& result) {
  Data data;
  Series interval{"half width of the interval", {}}, error{"distance to the true value", {}};
  for (std::size_t i = 0; i < fit_parameters.size(); ++i) {
    const auto width = number_at(result, {"parameters", fit_parameters.at(i), "interval"});
    const auto value = number_at(result, {"parameters", fit_parameters.at(i), "value"});
    const auto truth = number_at(result, {"parameters", fit_parameters.at(i), "true"});
    if (width) interval.curve.add(static_cast<double>(i), *width);
    if (value && truth) error.curve.add(static_cast<double>(i), std::abs(*value - *truth));
  }
  if (interval.curve.x.empty()) return data;
  data.series.push_back(std::move(interval));
  if (!error.curve.x.empty()) data.series.push_back(std::move(error));
  for (const char* name : fit_parameters) data.labels.emplace_back(name);
  return data;
}

Data companions(const Figure&, const Json& result) {
  Data data;
  Curve difference;
  for (const char* list : {"companions", "methods"})
    for (const Json* method : elements_at(result, {list})) {
      const auto value = number_at(*method, {"difference"});
      if (!value) continue;
      difference.add(static_cast<double>(data.labels.size()), *value);
      data.labels.push_back(text_at(*method, {"method"}));
    }
  if (!difference.x.empty()) data.series.push_back({"difference", std::move(difference)});
  return data;
}

}  // namespace

void add_fit_figures(std::vector<Figure>& list) {
  const auto add = [&](const char* name, const char* section, const char* title,
                       const char* caption, const char* papers, const char* x, const char* y,
                       Kind kind, bool log, Data (*data)(const Figure&, const Json&)) {
    list.push_back({name, "fit", section, title, caption, papers, x, y, kind, log, data});
  };
  add("fit-ellipse", "Ellipse", "Samples and the fitted ellipse",
      "Some of the samples, and the curve of the identified parameters.",
      "CSFN paper, Figures 7(d), 13(b) and 16(b)", "U", "V", Kind::points, false, ellipse);
  add("fit-residuals", "Residuals", "Residual by sample",
      "1 - Y of Eq (15) at the answer: the distance from the curve relative to its size.", "",
      "sample", "1 - Y", Kind::lines, false, residuals);
  add("fit-residuals-by-angle", "Residuals", "Residual by angle",
      "The same over the angle that was found: a wave in it is a harmonic.", "", "angle found, deg",
      "1 - Y", Kind::lines, false, residuals_by_angle);
  add("fit-angle-error", "Angle error", "Angle error over angle",
      "About its mean, where the true angle is known.", "CSFN paper, Figures 12, 14 and 22",
      "true angle, deg", "angle error, deg", Kind::lines, true, angle_error);
  add("fit-intervals", "Confidence", "Confidence intervals",
      "Half widths of the intervals, and the distance to the true values where they are known.", "",
      "parameter", "full scale, rad", Kind::bars, true, intervals);
  add("fit-companions", "Confidence", "Other methods",
      "Largest difference of the other methods' parameters from the answer.", "", "method",
      "relative difference, rad", Kind::bars, true, companions);
  add("fit-loss", "Training", "Loss over iterations", "Mean of (1 - Y)^2; of adam and lm.",
      "CSFN paper, Figures 10(b) and 20(b)", "iteration", "loss", Kind::lines, true, loss);
  add("fit-learning", "Training", "Parameters over iterations",
      "On their way to the answer; of adam and lm.", "CSFN paper, Figures 8 to 10 and 18 to 20",
      "iteration", "full scale, rad", Kind::lines, false, learning);
}

}  // namespace capsoc::report
