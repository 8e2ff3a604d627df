#include "identification/ellipse_distance.h"

#include <algorithm>
#include <cmath>

namespace capsoc::identification {
namespace {

/// Newton's method from the left of the root of a convex function never passes it and doubles its
/// digits at the end; a sample in the middle of a thin ellipse takes some forty steps.
constexpr int newton_steps = 100;

}  // namespace

EllipseDistance::EllipseDistance(const Parameters& p) : centre_u_(p.b1), centre_v_(p.b2) {
  // Half axes are the roots of the eigenvalues of (a1^2, c; c, a2^2), c = -a1 a2 sin(beta).
  const double mixed = -p.a1 * p.a2 * std::sin(p.beta);
  const double mean = (p.a1 * p.a1 + p.a2 * p.a2) / 2, half = (p.a1 * p.a1 - p.a2 * p.a2) / 2;
  const double larger = mean + std::hypot(half, mixed);
  major_ = std::sqrt(larger);
  minor_ = p.a1 * p.a2 * std::cos(p.beta) / major_;  // the determinant is their product
  const double direction = std::atan2(mixed, half) / 2;
  cosine_ = std::cos(direction);
  sine_ = std::sin(direction);
}

double EllipseDistance::at(double u, double v) const {
  const double du = u - centre_u_, dv = v - centre_v_;
  const double x = std::abs(cosine_ * du + sine_ * dv), y = std::abs(cosine_ * dv - sine_ * du);
  const double along = x / major_, across = y / minor_;
  const bool inside = along * along + across * across < 1;
  // The foot is (major^2 x/(t + major^2), minor^2 y/(t + minor^2)), t > -minor^2 such that it lies
  // on the ellipse (Eberly, Distance from a point to an ellipse, 2013).
  const double square_major = major_ * major_, square_minor = minor_ * minor_;
  const double between = square_major - square_minor;
  if (y <= 0 && major_ * x < between) {  // the foot is off the major axis
    const double cosine = major_ * x / between;
    const double foot_x = major_ * cosine, foot_y = minor_ * std::sqrt(1 - cosine * cosine);
    return -std::hypot(x - foot_x, foot_y);
  }
  double t = std::max(minor_ * y - square_minor, major_ * x - square_major);
  for (int i = 0; i < newton_steps; ++i) {
    const double a = major_ * x / (t + square_major), b = minor_ * y / (t + square_minor);
    const double excess = a * a + b * b - 1;
    const double slope = -2 * (a * a / (t + square_major) + b * b / (t + square_minor));
    if (!(slope < 0)) break;
    const double step = -excess / slope;
    t += step;
    if (std::abs(step) <= 1e-15 * (std::abs(t) + square_minor)) break;
  }
  const double foot_x = square_major * x / (t + square_major);
  const double foot_y = square_minor * y / (t + square_minor);
  const double distance = std::hypot(x - foot_x, y - foot_y);
  return inside ? -distance : distance;
}

}  // namespace capsoc::identification
