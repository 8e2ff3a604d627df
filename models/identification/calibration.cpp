#include "identification/calibration.h"

#include <algorithm>
#include <cmath>

#include "base/constants.h"

namespace capsoc::identification {
namespace {

/// Sines and cosines of the angle and its multiples, from one call of each.
struct Phase {
  explicit Phase(double theta)
      : s1(std::sin(theta)),
        c1(std::cos(theta)),
        s2(2 * s1 * c1),
        c2(c1 * c1 - s1 * s1),
        s3(s2 * c1 + c2 * s1),
        c3(c2 * c1 - s2 * s1) {}
  double s1, c1, s2, c2, s3, c3;
};

double value_of(const std::array<HarmonicTerm, 2>& terms, const Phase& at) {
  return terms[0].sine * at.s2 + terms[0].cosine * at.c2 + terms[1].sine * at.s3 +
         terms[1].cosine * at.c3;
}

double slope_of(const std::array<HarmonicTerm, 2>& terms, const Phase& at) {
  return 2 * (terms[0].sine * at.c2 - terms[0].cosine * at.s2) +
         3 * (terms[1].sine * at.c3 - terms[1].cosine * at.s3);
}

/// A model with the sine and cosine of its beta.
struct Prepared {
  explicit Prepared(const SignalModel& from)
      : model(from),
        sine(std::sin(from.fundamental.beta)),
        cosine(std::cos(from.fundamental.beta)) {}

  Point point(const Phase& at) const {
    const Parameters& p = model.fundamental;
    return {p.b1 + p.a1 * (at.s1 + value_of(model.u, at)),
            p.b2 + p.a2 * (at.c1 * cosine - at.s1 * sine + value_of(model.v, at))};
  }
  Point tangent(const Phase& at) const {
    const Parameters& p = model.fundamental;
    return {p.a1 * (at.c1 + slope_of(model.u, at)),
            p.a2 * (slope_of(model.v, at) - at.s1 * cosine - at.c1 * sine)};
  }

  const SignalModel& model;
  double sine, cosine;
};

template <class Angle>
double peak_to_peak(Eigen::Index count, const Channel& truth, const Angle& angle) {
  if (count == 0) return 0;
  double sine = 0, cosine = 0;
  for (Eigen::Index i = 0; i < count; ++i) {
    const double error = angle(i) - truth[i];
    sine += std::sin(error);
    cosine += std::cos(error);
  }
  const double mean = std::atan2(sine, cosine);
  double least = 0, largest = 0;
  for (Eigen::Index i = 0; i < count; ++i) {
    const double error = wrapped(angle(i) - truth[i] - mean);
    least = i == 0 ? error : std::min(least, error);
    largest = i == 0 ? error : std::max(largest, error);
  }
  return largest - least;
}

}  // namespace

double wrapped(double radians) {
  const double turns = radians / (2 * pi);
  const double rest = radians - 2 * pi * std::round(turns);
  return rest <= -pi ? rest + 2 * pi : rest;
}

Point point_at(const SignalModel& model, double theta) {
  return Prepared(model).point(Phase(theta));
}

Point tangent_at(const SignalModel& model, double theta) {
  return Prepared(model).tangent(Phase(theta));
}

Canonical canonical(const Parameters& parameters) {
  Canonical result = {parameters, false};
  Parameters& p = result.parameters;
  // -a1 sin(theta) = a1 sin(theta + pi), which adds pi to the phase of V against U; -a2 likewise.
  if (p.a1 < 0) p.beta += pi;
  if (p.a2 < 0) p.beta += pi;
  p.a1 = std::abs(p.a1);
  p.a2 = std::abs(p.a2);
  p.beta = wrapped(p.beta);
  if (std::abs(p.beta) > pi / 2) {
    p.beta = wrapped(pi - p.beta);
    result.reversed = true;
  }
  return result;
}

double angle_of(const Parameters& p, double u, double v) {
  const double sine = (u - p.b1) / p.a1;
  const double cosine = (v - p.b2) / (p.a2 * std::cos(p.beta)) + sine * std::tan(p.beta);
  return std::atan2(sine, cosine);
}

double angle_of(const SignalModel& model, double u, double v) {
  const Prepared prepared(model);
  const Parameters& p = model.fundamental;
  const double sine = (u - p.b1) / p.a1;
  double theta = std::atan2(sine, ((v - p.b2) / p.a2 + sine * prepared.sine) / prepared.cosine);
  // Gauss-Newton on the distance to the curve: quadratic on the curve, and near it the rate is the
  // distance over the radius of curvature.
  for (int i = 0; i < 20; ++i) {
    const Phase phase(theta);
    const Point at = prepared.point(phase);
    const Point along = prepared.tangent(phase);
    const double square = along.u * along.u + along.v * along.v;
    if (square == 0) break;
    const double step = ((u - at.u) * along.u + (v - at.v) * along.v) / square;
    theta += std::clamp(step, -0.5, 0.5);
    if (std::abs(step) < 1e-15) break;
  }
  return wrapped(theta);
}

double uncalibrated_angle(double u, double v) {
  return std::atan2(u, v);
}

double peak_to_peak_error(const Channel& angle, const Channel& truth) {
  return peak_to_peak(angle.size(), truth, [&](Eigen::Index i) { return angle[i]; });
}

double peak_to_peak_error(const Parameters& parameters, const Channel& u, const Channel& v,
                          const Channel& truth) {
  return peak_to_peak(u.size(), truth,
                      [&](Eigen::Index i) { return angle_of(parameters, u[i], v[i]); });
}

double peak_to_peak_error(const SignalModel& model, const Channel& u, const Channel& v,
                          const Channel& truth) {
  return peak_to_peak(u.size(), truth, [&](Eigen::Index i) { return angle_of(model, u[i], v[i]); });
}

}  // namespace capsoc::identification
