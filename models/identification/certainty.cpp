#include "identification/certainty.h"

#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "identification/angle_change.h"
#include "identification/calibration.h"
#include "identification/circle_plane.h"
#include "identification/distributions.h"

namespace capsoc::identification {
namespace {

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
  Square covariance = evidence.covariance / std::max(independent, 1e-9);
  if (least < floor)
    covariance = evidence.fit.unit_covariance * floor / std::max(independent, 1e-9);
  return covariance;
}

double largest_difference(const Parameters& one, const Parameters& other, const Coverage& within) {
  constexpr int angles = 180;
  double largest = 0;
  for (int i = 0; i < angles; ++i) {
    const double theta = 2 * pi * i / angles;
    if (!within.has(theta)) continue;
    const Point at = point_at({other, {}, {}}, theta);
    largest = std::max(largest, std::abs(wrapped(angle_of(one, at.u, at.v) - theta)));
  }
  return largest;
}

/// Of the noise's part of the bound, radians.
constexpr double largest_beyond_arc = 0.35;

/// Rounding of the arithmetic, relative to the largest value.
double rounding_of(const Parameters& p) {
  return 0x1p-51 * std::max(std::abs(p.b1) + p.a1, std::abs(p.b2) + p.a2);
}

/// Harmonics that may hide: the amplitude that was measured less what noise makes of it, and a part
/// of what noise hides.
double hidden_amplitude(const Structure& structure) {
  return std::hypot(structure.amplitude, structure.noise);
}

AngleError error_within(const Evidence& evidence, const Coverage& coverage) {
  const auto within = [&](double theta) { return coverage.has(theta); };
  AngleError error;
  const Square covariance = covariance_of(evidence);
  error.noise = simultaneous_factor(covariance, evidence.freedom, 1 - bound_confidence, within) *
                largest_angle_of(covariance, within);
  // The second order of an error of that size.
  error.noise *= 1 + error.noise;
  error.method = largest_difference(evidence.answer, evidence.fit.parameters, coverage);
  error.drift = evidence.drift;
  if (evidence.structure.last_order > 0) {
    const double amplitude = hidden_amplitude(evidence.structure);
    error.harmonics =
        amplitude * (angle_by_amplitude + 3 * largest_angle_of(evidence.structure.leak, within));
  }
  error.resolution = rounding_of(evidence.answer) * largest_angle_of(systematic(evidence), within);
  error.parameters = error.noise + error.method + error.drift + error.resolution;
  error.total = error.parameters + error.harmonics;
  return error;
}

}  // namespace

Intervals intervals_of(const Evidence& evidence, double confidence) {
  const Parameters &p = evidence.answer, &q = evidence.fit.parameters;
  const Square by = parameters_by_change(q);
  const Square noise = by * covariance_of(evidence) * by.transpose();
  const Square floor = by * systematic(evidence) * by.transpose();
  // Structure that is taken for correlation can leave no covariance.
  const Square white = by * evidence.fit.covariance * by.transpose();
  const double width = student_quantile(confidence, evidence.freedom);
  const double rounding = rounding_of(p);
  const double harmonics =
      evidence.structure.found ? angle_by_amplitude * evidence.structure.amplitude : 0;
  const auto half = [&](int k, double difference, double scale) {
    return width * std::sqrt(noise(k, k) > 0 ? noise(k, k) : white(k, k)) +
           rounding * std::sqrt(floor(k, k)) + std::abs(difference) + harmonics * scale;
  };
  return {half(0, p.a1 - q.a1, p.a1), half(1, p.a2 - q.a2, p.a2),  half(2, p.b1 - q.b1, p.a1),
          half(3, p.b2 - q.b2, p.a2), half(4, p.beta - q.beta, 1), confidence};
}

AngleBound bound_of(const Evidence& evidence) {
  AngleBound bound;
  AngleError& turn = bound;
  turn = error_within(evidence, Coverage::whole());
  // Beyond an arc that leaves the angle so uncertain its derivatives there say nothing.
  if (evidence.coverage.part < 1 && turn.noise > largest_beyond_arc) {
    turn.noise = turn.parameters = pi;
    turn.total = pi + turn.harmonics;
  }
  bound.arc = error_within(evidence, evidence.coverage);
  bound.arc_degrees = 360 * evidence.coverage.part;
  return bound;
}

}  // namespace capsoc::identification
