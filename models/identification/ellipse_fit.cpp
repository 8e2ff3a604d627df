#include "identification/ellipse_fit.h"

#include <cmath>

#include "identification/linear_algebra.h"

namespace capsoc::identification {
namespace {

/// A, B, C, D, E, F.
using Conic = Eigen::Matrix<double, 6, 1>;
using Matrix5 = Eigen::Matrix<double, 5, 5>;

/// Moments scaled alike in both channels, which keeps Taubin's distance what it is for noise equal
/// in U and V.
struct Scaled {
  ConicMoments m;
  double mean_u, mean_v, scale;
};

Scaled scaled_alike(const Moments& moments) {
  Scaled scaled = {moments.m, moments.mean_u, moments.mean_v,
                   std::hypot(moments.spread_u, moments.spread_v) / std::sqrt(2.0)};
  const double x = moments.spread_u / scaled.scale;
  const double y = moments.spread_v / scaled.scale;
  Conic monomials;
  monomials << x * x, x * y, y * y, x, y, 1;
  scaled.m.array() *= (monomials * monomials.transpose()).array();
  return scaled;
}

/// With x = (U - b1)/a1 and y = (V - b2)/a2, Eq (6) of the CSFN paper times cos^2(beta) is
/// x^2 + y^2 + 2 sin(beta) xy = cos^2(beta); comparing coefficients gives the parameters.
Result<Parameters> parameters_of(const Conic& raw, const Scaled& moments) {
  const Conic conic = raw[0] < 0 ? Conic(-raw) : raw;
  const double a = conic[0], b = conic[1], c = conic[2], d = conic[3], e = conic[4];
  const double discriminant = 4 * a * c - b * b;
  const double x = (b * e - 2 * c * d) / discriminant;
  const double y = (b * d - 2 * a * e) / discriminant;
  const double level = -(conic[5] + (d * x + e * y) / 2);
  const bool ellipse = a > 0 && discriminant > 0 && level > 0 && std::isfinite(level);
  if (!ellipse) {
    return Error{
        "the conic through the samples is no ellipse: record more of the turn, or with less noise"};
  }
  Parameters parameters;
  parameters.a1 = moments.scale * std::sqrt(4 * c * level / discriminant);
  parameters.a2 = moments.scale * std::sqrt(4 * a * level / discriminant);
  parameters.b1 = moments.mean_u + moments.scale * x;
  parameters.b2 = moments.mean_v + moments.scale * y;
  parameters.beta = std::atan2(b, std::sqrt(discriminant));
  return parameters;
}

Result<Parameters> failed() {
  return Error{"the ellipse fit's eigenvalues were not found: check the samples"};
}

}  // namespace

Result<Parameters> fit_heydemann(const Moments& record) {
  const Scaled moments = scaled_alike(record);
  Conic conic;
  const Matrix5 normal = moments.m.topLeftCorner<5, 5>();
  conic.head<5>() = solve_symmetric(normal, moments.m.col(5).head<5>());
  conic[5] = -1;
  return parameters_of(conic, moments);
}

Result<Parameters> fit_taubin(const Moments& record) {
  const Scaled moments = scaled_alike(record);
  // F minimises for itself: it is minus the mean of the rest, which leaves the covariance.
  const Eigen::Matrix<double, 5, 1> mean = moments.m.col(5).head<5>();
  const Matrix5 scatter = moments.m.topLeftCorner<5, 5>() - mean * mean.transpose();
  // Mean of gradient times gradient: (2x, y, 0, 1, 0) and (0, x, 2y, 0, 1).
  const double xx = mean[0], xy = mean[1], yy = mean[2], mx = mean[3], my = mean[4];
  Matrix5 gradient;
  gradient << 4 * xx, 2 * xy, 0, 2 * mx, 0,  //
      2 * xy, xx + yy, 2 * xy, my, mx,       //
      0, 2 * xy, 4 * yy, 0, 2 * my,          //
      2 * mx, my, 0, 1, 0,                   //
      0, mx, 2 * my, 0, 1;
  const SymmetricEigen eigen = eigen_of_pencil(scatter, gradient);
  if (!eigen.found) return failed();
  Conic conic;
  conic.head<5>() = eigen.vectors.col(0);
  conic[5] = -mean.dot(conic.head<5>());
  return parameters_of(conic, moments);
}

Result<Parameters> fit_direct(const Moments& record) {
  const Scaled moments = scaled_alike(record);
  const Eigen::Matrix3d quadratic = moments.m.topLeftCorner<3, 3>();
  const Eigen::Matrix3d mixed = moments.m.topRightCorner<3, 3>();
  const Eigen::Matrix3d linear = moments.m.bottomRightCorner<3, 3>();
  const Eigen::Matrix3d to_linear = -solve_symmetric(linear, mixed.transpose());
  const Eigen::Matrix3d reduced = quadratic + mixed * to_linear;
  Eigen::Matrix3d constrained;  // the constraint's inverse (0 0 1/2; 0 -1 0; 1/2 0 0) times reduced
  constrained << reduced.row(2) / 2, -reduced.row(1), reduced.row(0) / 2;
  const Eigen::MatrixXd vectors = eigenvectors_of(constrained);
  for (Eigen::Index i = 0; i < vectors.cols(); ++i) {  // exactly one eigenvector is an ellipse's
    const Eigen::Vector3d top = vectors.col(i);
    if (4 * top[0] * top[2] - top[1] * top[1] <= 0) continue;
    Conic conic;
    conic << top, to_linear * top;
    return parameters_of(conic, moments);
  }
  return failed();
}

Result<Parameters> parameters_of_conic(const std::array<double, 6>& conic) {
  const Conic as_vector = Eigen::Map<const Conic>(conic.data());
  return parameters_of(as_vector, {ConicMoments::Zero(), 0, 0, 1});
}

Result<Parameters> fit_heydemann(const Channel& u, const Channel& v) {
  const Result<Moments> moments = moments_of(u, v);
  if (!moments) return Error{moments.error()};
  return fit_heydemann(moments.value());
}

Result<Parameters> fit_taubin(const Channel& u, const Channel& v) {
  const Result<Moments> moments = moments_of(u, v);
  if (!moments) return Error{moments.error()};
  return fit_taubin(moments.value());
}

Result<Parameters> fit_direct(const Channel& u, const Channel& v) {
  const Result<Moments> moments = moments_of(u, v);
  if (!moments) return Error{moments.error()};
  return fit_direct(moments.value());
}

}  // namespace capsoc::identification
