// The circle divided into sectors, to see how samples lie on it without sorting them.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "identification/samples.h"

namespace capsoc::identification {

/// Equal parts of a square around the circle, 0.07 to 0.14 degrees wide: no arctangent a sample.
class Sectors {
 public:
  static constexpr int count = 3200;

  explicit Sectors(const Parameters& parameters)
      : p_(parameters),
        inverse_cosine_(1 / std::cos(parameters.beta)),
        tangent_(std::tan(parameters.beta)) {}

  /// Of a sample's angle, Eq (4); -1 for the ellipse's centre.
  int of(double u, double v) const {
    const double sine = (u - p_.b1) / p_.a1;
    const double cosine = (v - p_.b2) / p_.a2 * inverse_cosine_ + sine * tangent_;
    const double sector = place_on_square(cosine, sine) * (count / 4.0);
    return sector >= 0 ? std::min(static_cast<int>(sector), count - 1) : -1;
  }

  /// Where a sector begins, in degrees; sectors beyond the last are a turn on.
  static double degrees_at(int sector) { return degrees_at_place(sector * 4.0 / count); }

 private:
  /// Where a direction cuts the square |x| + |y| = 1, as 0 .. 4 around it.
  static double place_on_square(double x, double y) {
    const double along = y / (std::abs(x) + std::abs(y));
    if (x < 0) return 2 - along;
    return along < 0 ? 4 + along : along;
  }

  static double degrees_at_place(double place) {
    const double folded = std::fmod(place, 4);
    const double y = folded <= 1 ? folded : folded <= 3 ? 2 - folded : folded - 4;
    const double x = folded <= 2 ? 1 - folded : folded - 3;
    const double angle = std::atan2(y, x) * 180 / pi;
    return (angle < 0 ? angle + 360 : angle) + 360 * std::floor(place / 4);
  }

  Parameters p_;
  double inverse_cosine_, tangent_;
};

}  // namespace capsoc::identification
