// What noise makes, on the average, of the sums that the distance fit sets to zero.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "identification/circle_plane.h"

namespace capsoc::identification {

/// Orders of the fit: its five terms are the orders 0 to 2 of the radius of the circle.
constexpr int fit_orders = 2;
/// Orders up to which the residuals are searched for harmonics.
constexpr int harmonic_orders = 8;

/// 1, cos, sin, cos 2, sin 2, ... up to the order: derivatives of the radius by its Fourier terms.
template <int orders>
using Shape = Eigen::Matrix<double, 2 * orders + 1, 1>;
template <int orders>
Shape<orders> shape_of(const CirclePlane::Polar& at) {
  Shape<orders> shape;
  double cosine = 1, sine = 0;
  shape[0] = 1;
  for (int m = 1; m <= orders; ++m) {
    const double next = cosine * at.cosine - sine * at.sine;
    sine = sine * at.cosine + cosine * at.sine;
    cosine = next;
    shape[2 * m - 1] = cosine;
    shape[2 * m] = sine;
  }
  return shape;
}

/// A sample's terms: w (Y - 1) times shape_of(), and w (Y - 1)^2, with w the inverse of
/// square_slope(): the square of the distance from the ellipse, to first order.
template <int orders>
using Terms = Eigen::Matrix<double, 2 * orders + 2, 1>;
template <int orders>
Terms<orders> terms_of(const CirclePlane& plane, const CirclePlane::Polar& at) {
  const double weight = 1 / plane.square_slope(at);
  const double excess = at.length - 1;
  Terms<orders> terms;
  terms << weight * excess * shape_of<orders>(at), weight * excess * excess;
  return terms;
}

/// Means over normal noise of the same standard deviation in both channels, by Gauss and Hermite's
/// quadrature and so to every order of the noise. A sample's angle is known from the noisy sample
/// only. The table is made such that its mean over the noise is the terms' mean at every true
/// angle. So sums of terms minus table have no bias, whatever the angles are.
template <int orders>
class NoiseExpectation {
 public:
  using Square = Eigen::Matrix<double, 2 * orders + 2, 2 * orders + 2>;

  /// noise: standard deviation in the unit of the samples; 0 gives a table of zeros.
  /// with_scatter: scatter() will be called.
  NoiseExpectation(const CirclePlane& plane, double noise, bool with_scatter = false);

  /// At the angle (radians) of a noisy sample.
  Terms<orders> at(double theta) const;

  /// Sum over the samples' angles of the covariance of terms minus table.
  Square scatter(const Eigen::ArrayXd& theta) const;

 private:
  using Table = Eigen::Matrix<double, 2 * orders + 2, Eigen::Dynamic>;

  Table table_;
  std::vector<Square> scatter_;
};

extern template class NoiseExpectation<fit_orders>;
extern template class NoiseExpectation<harmonic_orders>;

}  // namespace capsoc::identification
