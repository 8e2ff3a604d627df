#include "identification/known_angles.h"

#include <cmath>

#include "identification/harmonics_route.h"
#include "identification/linear_algebra.h"

namespace capsoc::identification {
namespace {

using Coefficients = Eigen::Matrix<double, 7, 1>;  // 1, sin, cos, sin 2, cos 2, sin 3, cos 3

Coefficients basis(double theta) {
  Coefficients row;
  row << 1, std::sin(theta), std::cos(theta), std::sin(2 * theta), std::cos(2 * theta),
      std::sin(3 * theta), std::cos(3 * theta);
  return row;
}

HarmonicTerm turned(double sine, double cosine, double shift, double amplitude) {
  return {(sine * std::cos(shift) + cosine * std::sin(shift)) / amplitude,
          (cosine * std::cos(shift) - sine * std::sin(shift)) / amplitude};
}

/// Both channels by one angle whose origin is then moved to where U's fundamental is a pure sine.
SignalModel model_of(const Coefficients& u, const Coefficients& v) {
  SignalModel model;
  Parameters& p = model.fundamental;
  p.a1 = std::hypot(u[1], u[2]);
  p.a2 = std::hypot(v[1], v[2]);
  p.b1 = u[0];
  p.b2 = v[0];
  const double origin = std::atan2(u[2], u[1]);  // the new angle is the old one plus this
  p.beta = wrapped(std::atan2(-v[1], v[2]) - origin);
  for (int k = 0; k < 2; ++k) {
    const double shift = (k + 2) * origin;
    model.u[k] = turned(u[3 + 2 * k], u[4 + 2 * k], shift, p.a1);
    model.v[k] = turned(v[3 + 2 * k], v[4 + 2 * k], shift, p.a2);
  }
  return model;
}

}  // namespace

LinearFit fit_on_angles(const Channel& u, const Channel& v, const Eigen::ArrayXd& theta,
                        int highest, const Eigen::ArrayXd* place, const SignalModel& last) {
  const int terms = 1 + 2 * highest;
  const int size = 2 * terms + (place != nullptr ? 1 : 0);
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(size, size);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(size);
  Eigen::MatrixXd block = Eigen::MatrixXd::Zero(terms, terms);
  Eigen::VectorXd by_slope_u = Eigen::VectorXd::Zero(terms);
  Eigen::VectorXd by_slope_v = Eigen::VectorXd::Zero(terms);
  for (Eigen::Index i = 0; i < u.size(); ++i) {
    const Coefficients all = basis(theta[i]);
    const Eigen::VectorXd row = all.head(terms);
    block += row * row.transpose();
    right.head(terms) += u[i] * row;
    right.segment(terms, terms) += v[i] * row;
    if (place == nullptr) continue;
    const Point slope = tangent_at(last, angle_of(last, u[i], v[i]));
    const double at = (*place)[i];
    by_slope_u += slope.u * at * row;
    by_slope_v += slope.v * at * row;
    normal(size - 1, size - 1) += (slope.u * slope.u + slope.v * slope.v) * at * at;
    right[size - 1] += (u[i] * slope.u + v[i] * slope.v) * at;
  }
  normal.topLeftCorner(terms, terms) = block;
  normal.block(terms, terms, terms, terms) = block;
  if (place != nullptr) {
    normal.block(0, size - 1, terms, 1) = by_slope_u;
    normal.block(terms, size - 1, terms, 1) = by_slope_v;
    normal.block(size - 1, 0, 1, terms) = by_slope_u.transpose();
    normal.block(size - 1, terms, 1, terms) = by_slope_v.transpose();
  }
  const Eigen::VectorXd x = solve_symmetric(normal, right);
  Coefficients cu = Coefficients::Zero(), cv = Coefficients::Zero();
  cu.head(terms) = x.head(terms);
  cv.head(terms) = x.segment(terms, terms);
  return {model_of(cu, cv), place != nullptr ? x[size - 1] : 0};
}

double expected_error_on_angles(const SignalModel& model, double noise, double count, int highest) {
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(curve_terms, curve_terms);
  const double variance = noise * noise / count;
  const Parameters& p = model.fundamental;
  covariance.diagonal().head(4) << 2 * variance, 2 * variance, variance, variance;
  covariance(4, 4) = 2 * variance * (1 / (p.a1 * p.a1) + 1 / (p.a2 * p.a2));
  for (int k = 0; k < 4; ++k) {
    if (k / 2 + 2 > highest) continue;
    covariance(5 + k, 5 + k) = 2 * variance / (p.a1 * p.a1);
    covariance(9 + k, 9 + k) = 2 * variance / (p.a2 * p.a2);
  }
  return expected_error(model, covariance);
}

}  // namespace capsoc::identification
