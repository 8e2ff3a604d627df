#include "fit/drawn.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include "base/constants.h"
#include "identification/calibration.h"
#include "identification/network.h"

namespace capsoc::fit {
namespace {

constexpr std::size_t buckets = 1000;
constexpr int digits = 7;
using Points = std::vector<std::pair<double, double>>;

void add(Curves& curves, const char* name, const Curve& curve) {
  if (curve.x.empty()) return;
  Curve few = thinned(curve, buckets);
  for (double& x : few.x) x = rounded(x, digits);
  for (double& y : few.y) y = rounded(y, digits);
  curves.emplace_back(name, std::move(few));
}

Curve in_order(Points points) {
  std::sort(points.begin(), points.end());
  Curve curve;
  for (const auto& [x, y] : points) curve.add(x, y);
  return curve;
}

/// 0 .. 360.
double turn_of(double radians) {
  return 360 * (radians / two_pi - std::floor(radians / two_pi));
}

void add_ellipse(const Fit& fit, Curves& curves) {
  const identification::Samples& samples = fit.record.samples;
  const Eigen::Index step = samples.u.size() / static_cast<Eigen::Index>(2 * buckets) + 1;
  Curve some, ellipse;
  for (Eigen::Index i = 0; i < samples.u.size(); i += step) some.add(samples.u[i], samples.v[i]);
  identification::SignalModel model{fit.answer.parameters};
  if (fit.answer.harmonics.identified) model = fit.answer.harmonics.model;
  constexpr int points = 720;
  for (int i = 0; i < points; ++i) {
    const identification::Point point = identification::point_at(model, two_pi * i / points);
    ellipse.add(point.u, point.v);
  }
  add(curves, "samples", some);
  add(curves, "ellipse", ellipse);
}

void add_residuals(const Fit& fit, Curves& curves) {
  const identification::Samples& samples = fit.record.samples;
  const identification::Parameters& p = fit.answer.network_parameters;
  identification::Network network(samples.u.size());
  network.set_nodes(identification::to_nodes(p));
  network.forward(samples.u, samples.v);
  const auto residuals = network.residuals();
  Curve by_sample;
  Points by_angle;
  for (Eigen::Index i = 0; i < samples.u.size(); ++i) {
    by_sample.add(static_cast<double>(i), residuals[i]);
    by_angle.emplace_back(turn_of(identification::angle_of(p, samples.u[i], samples.v[i])),
                          residuals[i]);
  }
  add(curves, "residual", by_sample);
  add(curves, "residual_by_angle", in_order(std::move(by_angle)));
}

void add_errors(const Fit& fit, Curves& curves) {
  const identification::Samples& samples = fit.record.samples;
  if (fit.record.angle.size() == 0) return;
  Eigen::ArrayXd raw(samples.u.size()), found(samples.u.size());
  for (Eigen::Index i = 0; i < raw.size(); ++i) {
    raw[i] = identification::uncalibrated_angle(samples.u[i], samples.v[i]);
    found[i] = identification::angle_of(fit.answer.parameters, samples.u[i], samples.v[i]);
  }
  add(curves, "error_by_angle", angle_error_curve(found, fit.record.angle));
  add(curves, "raw_by_angle", angle_error_curve(raw, fit.record.angle));
}

void add_training(const Fit& fit, Curves& curves) {
  const auto along = [&](const char* name, auto value) {
    Curve curve;
    for (const identification::TracePoint& point : fit.answer.convergence)
      curve.add(point.iteration, value(point));
    add(curves, name, curve);
  };
  using Point = identification::TracePoint;
  along("loss", [](const Point& p) { return p.loss; });
  along("iteration.a1", [](const Point& p) { return p.parameters.a1; });
  along("iteration.a2", [](const Point& p) { return p.parameters.a2; });
  along("iteration.b1", [](const Point& p) { return p.parameters.b1; });
  along("iteration.b2", [](const Point& p) { return p.parameters.b2; });
  along("iteration.beta", [](const Point& p) { return p.parameters.beta; });
}

}  // namespace

Curve angle_error_curve(const Eigen::ArrayXd& angles, const Eigen::ArrayXd& truth) {
  const Eigen::ArrayXd reversed = -truth;
  const bool direct = identification::peak_to_peak_error(angles, truth) <=
                      identification::peak_to_peak_error(angles, reversed);
  const Eigen::ArrayXd& nearer = direct ? truth : reversed;
  std::complex<double> mean = 0;
  for (Eigen::Index i = 0; i < angles.size(); ++i) mean += std::polar(1.0, angles[i] - nearer[i]);
  Points points;
  for (Eigen::Index i = 0; i < angles.size(); ++i)
    points.emplace_back(
        turn_of(truth[i]),
        identification::wrapped(angles[i] - nearer[i] - std::arg(mean)) * degrees_per_radian);
  return in_order(std::move(points));
}

Curves curves_of(const Fit& fit) {
  Curves curves;
  add_ellipse(fit, curves);
  add_residuals(fit, curves);
  add_errors(fit, curves);
  add_training(fit, curves);
  return curves;
}

}  // namespace capsoc::fit
