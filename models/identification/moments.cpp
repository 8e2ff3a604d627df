#include "identification/moments.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "identification/kernels.h"
#include "identification/linear_algebra.h"

namespace capsoc::identification {
namespace {

/// A spread below this part of the channel's largest value is rounding, not movement.
constexpr double smallest_spread = 1e-12;
/// 1 - |correlation| of an ellipse is 1 - |sin(beta)|; this is beta within 45 urad of 90 degrees.
constexpr double smallest_opening = 1e-9;
/// Rounding of the moments leaves about 1e-16 of the largest eigenvalue; |beta| = 1.5 leaves 1e-7.
constexpr double smallest_eigenvalue_ratio = 1e-13;
/// Products of six values are formed: beyond this they leave the range of a double.
constexpr double largest_value = 1e30;

std::optional<Error> check_finite(const Channel& u, const Channel& v) {
  for (Eigen::Index i = 0; i < u.size(); ++i) {
    if (!std::isfinite(u[i]) || !std::isfinite(v[i])) {
      return Error{"sample " + std::to_string(i) +
                   " is not a finite number: remove it or record again"};
    }
  }
  return std::nullopt;
}

/// Raw sums about (centre_u, centre_v) in units of the scales to central, normalised moments.
void normalise(const MomentSums& s, double count, Moments& moments) {
  const double m[15] = {1,     s.x,   s.y,    s.xx,   s.xy,   s.yy,   s.xxx, s.xxy,
                        s.xyy, s.yyy, s.xxxx, s.xxxy, s.xxyy, s.xyyy, s.yyyy};
  const auto mean = [&](int x, int y) {
    static constexpr int first[] = {0, 1, 3, 6, 10};  // of the total power
    const int power = x + y;
    return power == 0 ? 1.0 : m[first[power] + y] / count;
  };
  static constexpr int power_x[] = {2, 1, 0, 1, 0, 0};
  static constexpr int power_y[] = {0, 1, 2, 0, 1, 0};
  const double inverse_u = 1 / std::sqrt(mean(2, 0));
  const double inverse_v = 1 / std::sqrt(mean(0, 2));
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 6; ++column) {
      const int x = power_x[row] + power_x[column];
      const int y = power_y[row] + power_y[column];
      moments.m(row, column) = mean(x, y) * std::pow(inverse_u, x) * std::pow(inverse_v, y);
    }
  }
}

}  // namespace

Result<Moments> moments_of(const Channel& u, const Channel& v) {
  if (u.size() != v.size()) {
    return Error{"the channels have " + std::to_string(u.size()) + " and " +
                 std::to_string(v.size()) + " samples: give as many of U as of V"};
  }
  if (u.size() < 5) {
    return Error{std::to_string(u.size()) +
                 " samples are too few: five parameters need at least five"};
  }
  const Kernels& sums = kernels(widest());
  const auto size = static_cast<std::size_t>(u.size());
  const auto count = static_cast<double>(u.size());
  const Extent extent = sums.extent(u.data(), v.data(), size);
  if (!std::isfinite(extent.sum_u) || !std::isfinite(extent.sum_v)) {
    if (auto error = check_finite(u, v)) return *error;
  }
  const double peak_u = std::max(-extent.least_u, extent.largest_u);
  const double peak_v = std::max(-extent.least_v, extent.largest_v);
  if (!(peak_u <= largest_value && peak_v <= largest_value)) {
    return Error{"a sample is larger than 1e30: scale the samples to full scale = 1"};
  }
  Moments moments;
  moments.mean_u = extent.sum_u / count;
  moments.mean_v = extent.sum_v / count;
  const double range_u = extent.largest_u - extent.least_u;
  const double range_v = extent.largest_v - extent.least_v;
  const bool still_u = range_u <= smallest_spread * peak_u || range_u < 1e-30;
  const bool still_v = range_v <= smallest_spread * peak_v || range_v < 1e-30;
  if (still_u && still_v) {
    return Error{"all samples are one single point: turn the sensor while recording"};
  }
  if (still_u || still_v) {
    return Error{std::string("channel ") + (still_u ? "U" : "V") +
                 " is constant, so the samples lie on a straight line: check its wiring"};
  }
  const MomentSums raw = sums.moments(u.data(), v.data(), size, moments.mean_u, moments.mean_v,
                                      1 / range_u, 1 / range_v);
  moments.spread_u = range_u * std::sqrt(raw.xx / count);
  moments.spread_v = range_v * std::sqrt(raw.yy / count);
  normalise(raw, count, moments);
  if (1 - std::abs(moments.m(3, 4)) < smallest_opening) {
    return Error{"the samples lie on a straight line: the channels must be about 90 degrees apart"};
  }
  // An eigenvalue of zero is a conic through all points: clean samples have one, two mean that the
  // ellipse is not determined.
  const SymmetricEigen eigen = eigen_of_symmetric(moments.m);
  if (!eigen.found || eigen.values[1] < smallest_eigenvalue_ratio * eigen.values[5]) {
    return Error{
        "the samples do not determine an ellipse: at least five different points of it are needed"};
  }
  return moments;
}

}  // namespace capsoc::identification
