#include "identification/circle_plane.h"

namespace capsoc::identification {
namespace {

/// From the circle plane to the samples: U = a1 sin, V = a2 (cos cos(beta) - sin sin(beta)).
Eigen::Matrix2d to_samples(const Parameters& p) {
  Eigen::Matrix2d map;
  map << 0, p.a1, p.a2 * std::cos(p.beta), -p.a2 * std::sin(p.beta);
  return map;
}

Eigen::Matrix2d stretch(const Change& change) {
  Eigen::Matrix2d s;
  s << change[0] + change[3], change[4], change[4], change[0] - change[3];
  return s;
}

}  // namespace

Parameters changed(const Parameters& p, const Change& change) {
  const Eigen::Matrix2d map = to_samples(p);
  const Eigen::Vector2d shift = map * change.segment<2>(1);
  const Eigen::Matrix2d there = map * (Eigen::Matrix2d::Identity() + stretch(change));
  // Rows are U and V as vectors over the circle: their lengths are the amplitudes, and the angle
  // between them is a quarter turn + beta.
  const double cross = there(0, 0) * there(1, 1) - there(0, 1) * there(1, 0);
  const double dot = there.row(0).dot(there.row(1));
  return {there.row(0).norm(), there.row(1).norm(), p.b1 + shift[0], p.b2 + shift[1],
          std::atan2(-dot, std::abs(cross))};
}

Eigen::Matrix<double, 5, 5> parameters_by_change(const Parameters& p) {
  const Eigen::Matrix2d map = to_samples(p);
  const double sine = std::sin(p.beta), cosine = std::cos(p.beta);
  Eigen::Matrix<double, 5, 5> by;
  for (int k = 0; k < 5; ++k) {
    const Change unit = Change::Unit(k);
    const Eigen::Vector2d shift = map * unit.segment<2>(1);
    // Half the change of map map^T, whose elements are a1^2, -a1 a2 sin(beta) and a2^2.
    const Eigen::Matrix2d half = k == 1 || k == 2 ? Eigen::Matrix2d(Eigen::Matrix2d::Zero())
                                                  : map * stretch(unit) * map.transpose();
    const double a1 = half(0, 0) / p.a1, a2 = half(1, 1) / p.a2;
    const double beta = (-2 * half(0, 1) / (p.a1 * p.a2) - sine * (a1 / p.a1 + a2 / p.a2)) / cosine;
    by.col(k) << a1, a2, shift[0], shift[1], beta;
  }
  return by;
}

}  // namespace capsoc::identification
