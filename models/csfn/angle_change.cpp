#include "csfn/angle_change.h"

#include <algorithm>

#include "support/constants.h"

namespace capsoc::csfn {
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

}  // namespace capsoc::csfn
