#include "csfn/certainty.h"

#include <algorithm>
#include <cmath>

#include "csfn/calibration.h"
#include "csfn/circle_plane.h"
#include "csfn/distributions.h"
#include "support/constants.h"

namespace capsoc::csfn {
namespace {

constexpr int angles = 180;

using Square = Eigen::Matrix<double, 5, 5>;

/// Of the parameters, for a noise of 1 that no number of samples reduces.
Square systematic(const Evidence& evidence) {
  return evidence.fit.unit_covariance * evidence.count;
}

/// Samples that repeat say no more about noise that rounding makes.
Square covariance_of(const Evidence& evidence) {
  const double independent =
      evidence.fit.noise < 2 * evidence.resolution ? 1 - evidence.repeated : 1;
  const double floor = evidence.resolution * evidence.resolution;
  const double least = evidence.fit.noise * evidence.fit.noise;
  Square covariance = evidence.fit.covariance / std::max(independent, 1e-9);
  if (least < floor)
    covariance = evidence.fit.unit_covariance * floor / std::max(independent, 1e-9);
  return covariance;
}

/// Derivatives of the angle at theta by the change of the circle. Its origin turns along: where U's
/// sine has its peak a stretch moves nothing.
Change angle_by_change(double theta) {
  Change by;
  by << 0, -std::sin(theta), std::cos(theta), -std::sin(2 * theta), std::cos(2 * theta) + 1;
  return by;
}

double largest_angle(const Square& covariance) {
  double square = 0;
  for (int i = 0; i < angles; ++i) {
    const Change by = angle_by_change(2 * pi * i / angles);
    square = std::max(square, by.dot(covariance * by));
  }
  return std::sqrt(square);
}

double largest_difference(const Parameters& one, const Parameters& other) {
  double largest = 0;
  for (int i = 0; i < angles; ++i) {
    const double theta = 2 * pi * i / angles;
    const Point at = point_at({other, {}, {}}, theta);
    largest = std::max(largest, std::abs(wrapped(angle_of(one, at.u, at.v) - theta)));
  }
  return largest;
}

/// Rounding of the arithmetic, relative to the largest value.
double rounding_of(const Parameters& p) {
  return 0x1p-51 * std::max(std::abs(p.b1) + p.a1, std::abs(p.b2) + p.a2);
}

}  // namespace

Intervals intervals_of(const Evidence& evidence, double confidence) {
  const Parameters &p = evidence.answer, &q = evidence.fit.parameters;
  const Square by = parameters_by_change(q);
  const Square noise = by * covariance_of(evidence) * by.transpose();
  const Square floor = by * systematic(evidence) * by.transpose();
  const double width = student_quantile(confidence, evidence.count - 5);
  const double rounding = rounding_of(p);
  const double harmonics =
      evidence.structure.found ? angle_by_amplitude * evidence.structure.amplitude : 0;
  const auto half = [&](int k, double difference, double scale) {
    return width * std::sqrt(noise(k, k)) + rounding * std::sqrt(floor(k, k)) +
           std::abs(difference) + harmonics * scale;
  };
  return {half(0, p.a1 - q.a1, p.a1), half(1, p.a2 - q.a2, p.a2),  half(2, p.b1 - q.b1, p.a1),
          half(3, p.b2 - q.b2, p.a2), half(4, p.beta - q.beta, 1), confidence};
}

AngleBound bound_of(const Evidence& evidence) {
  AngleBound bound;
  // Scheffe: for all angles at once, five parameters.
  const double width = std::sqrt(5 * f_quantile(1 - bound_confidence, 5, evidence.count - 5));
  bound.noise = width * largest_angle(covariance_of(evidence));
  // The second order of an error of that size.
  bound.noise *= 1 + bound.noise;
  bound.method = largest_difference(evidence.answer, evidence.fit.parameters);
  if (evidence.structure.last_order > 0) {
    bound.harmonics =
        angle_by_amplitude * std::hypot(evidence.structure.amplitude, evidence.structure.noise);
  }
  bound.resolution = rounding_of(evidence.answer) * largest_angle(systematic(evidence));
  bound.total = bound.noise + bound.method + bound.harmonics + bound.resolution;
  return bound;
}

}  // namespace capsoc::csfn
