#include "identification/distance_fit.h"

#include <cmath>

#include "identification/linear_algebra.h"
#include "identification/noise_expectation.h"

namespace capsoc::identification {
namespace {

using Square5 = Eigen::Matrix<double, 5, 5>;
using Terms6 = Terms<fit_orders>;
using Square6 = Eigen::Matrix<double, 6, 6>;

constexpr int iteration_limit = 100;
/// Changes of the circle below this are rounding.
constexpr double settled = 1e-14;
/// So are changes below this part of the smallest standard error.
constexpr double negligible = 1e-6;
constexpr double smallest_damping = 1.0 / 16;
/// A change of the circle beyond this leaves what the first order describes.
constexpr double longest_step = 0.3;
/// Below this noise, relative to the smaller half axis, its bias and the curvature of the problem
/// leave the covariance alone.
constexpr double first_order_noise = 1e-3;
/// Samples that the derivatives of the sums are taken from.
constexpr Eigen::Index most_looked_at = 4096;
constexpr double golden_ratio = 0.61803398874989484820;

struct Sums {
  Square5 information = Square5::Zero();  ///< of shape shape^T w
  Terms6 terms = Terms6::Zero();
  Terms6 expected = Terms6::Zero();
};

Sums sums_of(const Channel& u, const Channel& v, const Parameters& p, double noise) {
  const CirclePlane plane(p);
  const NoiseExpectation<fit_orders> expectation(plane, noise);
  Sums sums;
  for (Eigen::Index i = 0; i < u.size(); ++i) {
    const CirclePlane::Polar at = plane.at(u[i], v[i]);
    const double weight = 1 / plane.square_slope(at);
    const double excess = at.length - 1;
    const Change shape = shape_of<fit_orders>(at);
    sums.information.noalias() += weight * (shape * shape.transpose());
    sums.terms.head<5>() += (weight * excess) * shape;
    sums.terms[5] += weight * excess * excess;
    sums.expected += expectation.at(std::atan2(at.sine, at.cosine));
  }
  return sums;
}

/// Five parameters take five degrees of freedom.
double freedom_of(const Channel& u) {
  return static_cast<double>(u.size()) - 5;
}

/// The sums that the fit sets to zero, the last one for the noise.
Terms6 rest_of(const Channel& u, const Channel& v, const Parameters& p, double noise) {
  const Sums sums = sums_of(u, v, p, noise);
  Terms6 rest = sums.terms - sums.expected;
  rest[5] = sums.terms[5] - sums.expected[5] * freedom_of(u) / static_cast<double>(u.size());
  return rest;
}

/// Derivatives of rest_of() by the change and the logarithm of the noise. Of a short arc the sums
/// hardly depend on one combination of the changes: it is followed by itself, and to both sides.
Square6 derivatives(const Channel& u, const Channel& v, const DistanceFit& fit,
                    const Square5& covariance) {
  const SymmetricEigen axes = eigen_of_symmetric(covariance);
  Square6 along = Square6::Zero(), directions = Square6::Identity();
  for (int k = 0; k < 5; ++k) {
    const double step = 0.05 * std::sqrt(std::max(axes.values[k], 0.0));
    const Change change = step * axes.vectors.col(k);
    along.col(k) = (rest_of(u, v, changed(fit.parameters, change), fit.noise) -
                    rest_of(u, v, changed(fit.parameters, -change), fit.noise)) /
                   (2 * step);
  }
  constexpr double step = 0.01;
  along.col(5) = (rest_of(u, v, fit.parameters, fit.noise * (1 + step)) -
                  rest_of(u, v, fit.parameters, fit.noise * (1 - step))) /
                 (2 * step);
  directions.topLeftCorner<5, 5>() = axes.vectors;
  return along * directions.transpose();
}

Square5 covariance_of(const Channel& u, const Channel& v, const DistanceFit& fit,
                      const Square5& first_order) {
  const CirclePlane plane(fit.parameters);
  if (fit.noise * plane.largest_slope() < first_order_noise) return first_order;
  // Golden-ratio places are spread evenly and in step with no period of the samples.
  const Eigen::Index count = std::min(u.size(), most_looked_at);
  Eigen::ArrayXd some_u(count), some_v(count), theta(count);
  for (Eigen::Index k = 0; k < count; ++k) {
    double turns = 0;
    const double place = std::modf(static_cast<double>(k) * golden_ratio, &turns);
    const auto i =
        count == u.size() ? k : static_cast<Eigen::Index>(place * static_cast<double>(u.size()));
    some_u[k] = u[i];
    some_v[k] = v[i];
    const CirclePlane::Polar at = plane.at(u[i], v[i]);
    theta[k] = std::atan2(at.sine, at.cosine);
  }
  const Square6 by = derivatives(some_u, some_v, fit, first_order);
  const Square6 inverse = pseudo_inverse_of(by);
  const Square6 scatter = NoiseExpectation<fit_orders>(plane, fit.noise, true).scatter(theta);
  const Square6 covariance = inverse * scatter * inverse.transpose();
  return covariance.topLeftCorner<5, 5>() *
         (static_cast<double>(count) / static_cast<double>(u.size()));
}

}  // namespace

DistanceFit fit_distances(const Channel& u, const Channel& v, const Parameters& start) {
  DistanceFit fit;
  fit.parameters = start;
  double last = HUGE_VAL, damping = 1;
  Square5 information;
  while (fit.iterations < iteration_limit) {
    ++fit.iterations;
    const Sums sums = sums_of(u, v, fit.parameters, fit.noise);
    information = sums.information;
    const double count = static_cast<double>(u.size());
    // The table holds noise^2 times what curvature makes of it.
    const double shape_of_noise =
        fit.noise > 0 ? sums.expected[5] / count / (fit.noise * fit.noise) : 1;
    fit.noise = std::sqrt(sums.terms[5] / freedom_of(u) / shape_of_noise);
    Change change = solve_symmetric(information, (sums.terms - sums.expected).head<5>());
    const double size = change.cwiseAbs().maxCoeff();
    if (!std::isfinite(size) || !std::isfinite(fit.noise)) return fit;
    if (size > last) damping = std::max(damping / 2, smallest_damping);
    fit.parameters = changed(fit.parameters, change * std::min(damping, longest_step / size));
    // In the minimum the last bits go round in circles.
    const double error = fit.noise / std::sqrt(information.diagonal().maxCoeff());
    fit.converged =
        size < std::max(settled, negligible * error) || (size >= last / 2 && size < 1e-11);
    if (fit.converged) break;
    last = size;
  }
  if (!fit.converged) return fit;
  const Square5 inverse = solve_symmetric(information, Square5::Identity());
  fit.unit_covariance = inverse;
  fit.covariance = covariance_of(u, v, fit, fit.noise * fit.noise * inverse);
  return fit;
}

}  // namespace capsoc::identification
