// The plane in which an identified ellipse is the unit circle.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "identification/samples.h"

namespace capsoc::identification {

/// (cos, sin) of Eq (4), linear in the sample: on the ellipse they are cos(theta) and sin(theta).
/// Noise that is equal in U and V has the covariance noise^2 * M there.
class CirclePlane {
 public:
  explicit CirclePlane(const Parameters& parameters) : p_(parameters) {
    const double sine = std::sin(p_.beta), cosine = std::cos(p_.beta);
    // Rows of the map from (u, v) - (b1, b2) to (cos, sin).
    map_ << sine / (cosine * p_.a1), 1 / (cosine * p_.a2),  //
        1 / p_.a1, 0;
    metric_ = map_ * map_.transpose();
  }

  /// A sample in polar coordinates: 1 - length is the network's residual, Eq (15).
  struct Polar {
    double length = 0;
    double cosine = 1, sine = 0;
  };
  Polar at(double u, double v) const {
    const double x = map_(0, 0) * (u - p_.b1) + map_(0, 1) * (v - p_.b2);
    const double y = map_(1, 0) * (u - p_.b1);
    return polar(x, y);
  }
  static Polar polar(double x, double y) {
    const double length = std::sqrt(x * x + y * y);
    if (!(length > 0)) return {};
    return {length, x / length, y / length};
  }

  /// Square of the length's gradient in the unit of 1/samples: the noise of the length is noise
  /// times its root.
  double square_slope(const Polar& at) const {
    return metric_(0, 0) * at.cosine * at.cosine + 2 * metric_(0, 1) * at.cosine * at.sine +
           metric_(1, 1) * at.sine * at.sine;
  }

  /// 1/the smallest half axis of the ellipse.
  double largest_slope() const {
    const double half = (metric_(0, 0) - metric_(1, 1)) / 2;
    return std::sqrt((metric_(0, 0) + metric_(1, 1)) / 2 + std::hypot(half, metric_(0, 1)));
  }
  const Eigen::Matrix2d& map() const { return map_; }

 private:
  Parameters p_;
  Eigen::Matrix2d map_, metric_;
};

/// A change of the circle to first order: its radius becomes 1 + d0 + d1 cos + d2 sin + d3 cos 2 +
/// d4 sin 2.
using Change = Eigen::Matrix<double, 5, 1>;

/// The ellipse of the changed circle: (I + S) x circle moved by (d1, d2), S = (d0 + d3, d4; d4,
/// d0 - d3).
Parameters changed(const Parameters& parameters, const Change& change);

/// Derivatives of a1, a2, b1, b2, beta by the change.
Eigen::Matrix<double, 5, 5> parameters_by_change(const Parameters& parameters);

}  // namespace capsoc::identification
