#include "identification/angle_change.h"

#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "identification/distributions.h"
#include "identification/linear_algebra.h"

namespace capsoc::identification {
namespace {

constexpr int compared_angles = 180;

}  // namespace

Change angle_by_change(double theta) {
  Change by;
  by << 0, -std::sin(theta), std::cos(theta), -std::sin(2 * theta), std::cos(2 * theta) + 1;
  return by;
}

double largest_angle_of(const Change& change) {
  double largest = 0;
  for (int i = 0; i < compared_angles; ++i)
    largest =
        std::max(largest, std::abs(angle_by_change(2 * pi * i / compared_angles).dot(change)));
  return largest;
}

double largest_angle_of(const Eigen::Matrix<double, 5, 5>& covariance,
                        const std::function<bool(double)>& within) {
  double square = 0;
  for (int i = 0; i < compared_angles; ++i) {
    const double theta = 2 * pi * i / compared_angles;
    if (within && !within(theta)) continue;
    const Change by = angle_by_change(theta);
    square = std::max(square, by.dot(covariance * by));
  }
  return std::sqrt(square);
}

double simultaneous_factor(const Eigen::Matrix<double, 5, 5>& covariance, double freedom,
                           double risk, const std::function<bool(double)>& within) {
  const double scheffe = std::sqrt(5 * f_quantile(risk, 5, freedom));
  const SymmetricEigen eigen = eigen_of_symmetric(covariance);
  if (!eigen.found) return scheffe;
  const Eigen::MatrixXd root = eigen.vectors * eigen.values.cwiseMax(0).cwiseSqrt().asDiagonal();
  double length = 0;
  int pieces = 0;
  Eigen::VectorXd last;
  bool joined = false;
  for (int i = 0; i <= compared_angles; ++i) {
    const double theta = 2 * pi * i / compared_angles;
    if (within && !within(theta)) {
      joined = false;
      continue;
    }
    const Eigen::VectorXd direction = (root.transpose() * angle_by_change(theta)).normalized();
    if (!direction.allFinite()) return scheffe;
    if (joined)
      length += 2 * std::asin(std::min((direction - last).norm() / 2, 1.0));
    else
      ++pieces;
    last = direction;
    joined = true;
  }
  // Both signs: the tube about a curve of that length, and a half cap at each of its ends.
  const auto exceeded = [&](double factor) {
    const double tube =
        length / pi * std::exp(-freedom / 2 * std::log1p(factor * factor / freedom));
    return tube + pieces * f_tail(factor * factor, 1, freedom);
  };
  double least = 0, most = scheffe;
  if (exceeded(most) > risk) return scheffe;
  for (int step = 0; step < 60; ++step) {
    const double middle = (least + most) / 2;
    (exceeded(middle) > risk ? least : most) = middle;
  }
  return most;
}

}  // namespace capsoc::identification
