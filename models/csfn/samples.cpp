#include "csfn/samples.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <string>

namespace capsoc::csfn {
namespace {

/// A spread below this part of the channel's largest value is rounding, not movement.
constexpr double smallest_spread = 1e-12;
/// 1 - |correlation| of an ellipse is 1 - |sin(beta)|; this is beta within 45 urad of 90 degrees.
constexpr double smallest_opening = 1e-9;
/// Rounding of the moments leaves about 1e-16 of the largest eigenvalue; |beta| = 1.5 leaves 1e-7.
constexpr double smallest_eigenvalue_ratio = 1e-13;

using Moments = Eigen::Matrix<double, 6, 6>;

/// Moments of the conic's monomials, of channels with mean 0 and spread 1. An eigenvalue of zero is
/// a conic through all points: clean samples have one, two mean that the ellipse is not determined.
Moments conic_moments(const Channel& u, const Channel& v, double mean_u, double mean_v,
                      double spread_u, double spread_v) {
  Moments moments = Moments::Zero();
  for (Eigen::Index i = 0; i < u.size(); ++i) {
    const double x = (u[i] - mean_u) / spread_u;
    const double y = (v[i] - mean_v) / spread_v;
    Eigen::Matrix<double, 6, 1> row;
    row << x * x, x * y, y * y, x, y, 1;
    moments.noalias() += row * row.transpose();
  }
  return moments / static_cast<double>(u.size());
}

}  // namespace

std::optional<Error> check_samples(const Channel& u, const Channel& v) {
  if (u.size() != v.size()) {
    return Error{"the channels have " + std::to_string(u.size()) + " and " +
                 std::to_string(v.size()) + " samples: give as many of U as of V"};
  }
  if (u.size() < 5) {
    return Error{std::to_string(u.size()) +
                 " samples are too few: five parameters need at least five"};
  }
  for (Eigen::Index i = 0; i < u.size(); ++i) {
    if (!std::isfinite(u[i]) || !std::isfinite(v[i])) {
      return Error{"sample " + std::to_string(i) +
                   " is not a finite number: remove it or record again"};
    }
  }
  const double peak_u = u.abs().maxCoeff();
  const double peak_v = v.abs().maxCoeff();
  // Products of six values are formed: beyond this they leave the range of a double.
  if (peak_u > 1e30 || peak_v > 1e30) {
    return Error{"a sample is larger than 1e30: scale the samples to full scale = 1"};
  }
  const double mean_u = u.mean();
  const double mean_v = v.mean();
  const double spread_u = std::sqrt((u - mean_u).square().mean());
  const double spread_v = std::sqrt((v - mean_v).square().mean());
  const bool still_u = spread_u <= smallest_spread * peak_u || spread_u < 1e-30;
  const bool still_v = spread_v <= smallest_spread * peak_v || spread_v < 1e-30;
  if (still_u && still_v) {
    return Error{"all samples are one single point: turn the sensor while recording"};
  }
  if (still_u || still_v) {
    return Error{std::string("channel ") + (still_u ? "U" : "V") +
                 " is constant, so the samples lie on a straight line: check its wiring"};
  }
  const double correlation = ((u - mean_u) / spread_u * ((v - mean_v) / spread_v)).mean();
  if (1 - std::abs(correlation) < smallest_opening) {
    return Error{"the samples lie on a straight line: the channels must be about 90 degrees apart"};
  }
  const Eigen::SelfAdjointEigenSolver<Moments> eigen(
      conic_moments(u, v, mean_u, mean_v, spread_u, spread_v), Eigen::EigenvaluesOnly);
  if (eigen.eigenvalues()[1] < smallest_eigenvalue_ratio * eigen.eigenvalues()[5]) {
    return Error{
        "the samples do not determine an ellipse: at least five different points of it are needed"};
  }
  return std::nullopt;
}

}  // namespace capsoc::csfn
