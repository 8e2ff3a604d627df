#include "csfn/structure.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "csfn/distributions.h"
#include "csfn/noise_expectation.h"

namespace capsoc::csfn {
namespace {

constexpr int fitted = 2 * fit_orders + 1;
constexpr int first_order = fit_orders + 1;
/// Samples an order, at least: fewer at random angles leave gaps in which an order is not known.
constexpr int samples_an_order = 6;
/// Squares that remain are at least this part of what the fit's noise leaves: of few samples the
/// orders can take more than there is.
constexpr double least_rest = 0.25;

}  // namespace

Structure structure_of(const Channel& u, const Channel& v, const DistanceFit& fit,
                       double resolution) {
  constexpr int size = 2 * harmonic_orders + 1;
  Structure structure;
  const auto count = static_cast<int>(std::min<Eigen::Index>(u.size(), 1'000'000'000));
  structure.last_order = std::min(harmonic_orders, count / samples_an_order);
  if (structure.last_order < first_order) return structure;

  const CirclePlane plane(fit.parameters);
  const NoiseExpectation<harmonic_orders> expectation(plane, fit.noise);
  Eigen::Matrix<double, size, size> information = decltype(information)::Zero();
  Shape<harmonic_orders> sum = Shape<harmonic_orders>::Zero();
  double square = 0;
  for (Eigen::Index i = 0; i < u.size(); ++i) {
    const CirclePlane::Polar at = plane.at(u[i], v[i]);
    const double weight = 1 / plane.square_slope(at);
    const Shape<harmonic_orders> shape = shape_of<harmonic_orders>(at);
    const Terms<harmonic_orders> expected = expectation.at(std::atan2(at.sine, at.cosine));
    information.noalias() += weight * (shape * shape.transpose());
    sum += weight * (at.length - 1) * shape - expected.head<size>();
    square += weight * (at.length - 1) * (at.length - 1);
  }
  // Least squares on all orders; with the factor L the squares that each order explains, after
  // those below it, are the squares of L^-1 sum.
  const int used = 2 * structure.last_order + 1;
  const Eigen::LLT<Eigen::MatrixXd> factor(information.topLeftCorner(used, used));
  if (factor.info() != Eigen::Success) {
    structure.last_order = 0;
    return structure;
  }
  const Eigen::VectorXd explained = factor.matrixL().solve(sum.head(used)).array().square();
  const Eigen::VectorXd found = factor.solve(sum.head(used));
  const Eigen::MatrixXd inverse = factor.solve(Eigen::MatrixXd::Identity(used, used));
  const double freedom = count - used;
  const double rest =
      std::max({square - explained.sum(), least_rest * freedom * fit.noise * fit.noise, 1e-300});

  double joint = 0, largest = 0, least = 1;
  const int tests = 2 * (structure.last_order - first_order + 1) - 1;
  for (int order = first_order; order <= structure.last_order; ++order) {
    const int at = 2 * order - 1;
    const double one = explained[at] + explained[at + 1];
    joint += one;
    const double above = 2 * (order - first_order + 1);
    const double below = count - 2 * order - 1;
    const double others = std::max(square - explained.head(fitted).sum() - joint, rest);
    least = std::min({least, f_tail(one / 2 / (rest / freedom), 2, freedom),
                      f_tail(joint / above / (others / below), above, below)});
    const double power = found.segment(at, 2).squaredNorm();
    if (power > largest) structure.order = order;
    largest = std::max(largest, power);
  }
  const auto harmonics = used - fitted;
  structure.amplitude = found.tail(harmonics).norm();
  structure.noise = std::sqrt(rest / freedom * inverse.diagonal().tail(harmonics).sum());
  structure.probability = std::min(1.0, least * tests);
  structure.found = structure.probability < structure_false_alarms &&
                    structure.amplitude > resolution * plane.largest_slope();
  return structure;
}

}  // namespace capsoc::csfn
