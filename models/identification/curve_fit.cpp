#include "identification/curve_fit.h"

#include <cmath>
#include <complex>

#include "base/constants.h"
#include "identification/linear_algebra.h"

namespace capsoc::identification {
namespace {

constexpr int curve_iterations = 40;

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

/// The unknowns of a fit and how the 13 terms follow from them.
class Unknowns {
 public:
  Unknowns(int highest, CurveShape shape)
      : shape_(shape), harmonics_(highest - 1), size_(5 + (free() ? 4 : 2) * harmonics_) {}

  bool free() const { return shape_ == CurveShape::free; }
  int size() const { return size_; }

  Vector of(const SignalModel& model) const {
    const CurveVector all = to_vector(model);
    Vector x(size_);
    x.head(5) = all.head(5);
    x.segment(5, 2 * harmonics_) = all.segment(5, 2 * harmonics_);
    if (free()) x.segment(5 + 2 * harmonics_, 2 * harmonics_) = all.segment(9, 2 * harmonics_);
    return x;
  }

  CurveVector terms(const Vector& x) const {
    CurveVector all = CurveVector::Zero();
    all.head(5) = x.head(5);
    all.segment(5, 2 * harmonics_) = x.segment(5, 2 * harmonics_);
    if (free()) {
      all.segment(9, 2 * harmonics_) = x.segment(5 + 2 * harmonics_, 2 * harmonics_);
      return all;
    }
    for (int k = 0; k < harmonics_; ++k) {  // sin(h (theta + pi/2 + beta)) and the cosine
      const double shift = (k + 2) * (pi / 2 + x[4]);
      all[9 + 2 * k] = x[5 + 2 * k] * std::cos(shift) - x[6 + 2 * k] * std::sin(shift);
      all[10 + 2 * k] = x[5 + 2 * k] * std::sin(shift) + x[6 + 2 * k] * std::cos(shift);
    }
    return all;
  }

  /// Derivatives of terms().
  Matrix map(const Vector& x) const {
    Matrix map = Matrix::Zero(curve_terms, size_);
    map.topLeftCorner(5, 5).setIdentity();
    map.block(5, 5, 2 * harmonics_, 2 * harmonics_).setIdentity();
    if (free()) {
      map.block(9, 5 + 2 * harmonics_, 2 * harmonics_, 2 * harmonics_).setIdentity();
      return map;
    }
    const CurveVector all = terms(x);
    for (int k = 0; k < harmonics_; ++k) {
      const double shift = (k + 2) * (pi / 2 + x[4]);
      map(9 + 2 * k, 5 + 2 * k) = std::cos(shift);
      map(9 + 2 * k, 6 + 2 * k) = -std::sin(shift);
      map(10 + 2 * k, 5 + 2 * k) = std::sin(shift);
      map(10 + 2 * k, 6 + 2 * k) = std::cos(shift);
      map(9 + 2 * k, 4) = -(k + 2) * all[10 + 2 * k];
      map(10 + 2 * k, 4) = (k + 2) * all[9 + 2 * k];
    }
    return map;
  }

 private:
  CurveShape shape_;
  int harmonics_, size_;
};

constexpr int spread_orders = 3;

/// What a step needs, summed over the samples.
struct CurveSums {
  Eigen::Matrix<double, curve_terms, curve_terms> jtj;
  CurveVector jtr = CurveVector::Zero();
  double square = 0;     ///< of the distances
  double objective = 0;  ///< that and the weighted squares of the spread's means
  std::array<std::complex<double>, 13> order{};
};

/// CurveSums of e^(i m theta), m = 1 .. 3, and their derivatives by the terms.
struct Spread {
  std::array<std::complex<double>, spread_orders> sum{};
  Eigen::Matrix<std::complex<double>, curve_terms, spread_orders> by_terms;
};

/// Means of N random directions have a variance of 1/(2N) in the real and the imaginary part each;
/// in units of the distances' variance they count as two more samples an order.
void add_spread(const Spread& spread, double count, double noise, CurveSums& sums) {
  const double weight = noise * std::sqrt(2 * count) / count;
  for (int m = 0; m < spread_orders; ++m) {
    for (const bool real : {true, false}) {
      const double residual = weight * (real ? spread.sum[m].real() : spread.sum[m].imag());
      CurveVector j;
      for (int k = 0; k < curve_terms; ++k) {
        const std::complex<double> by = spread.by_terms(k, m);
        j[k] = -weight * (real ? by.real() : by.imag());
      }
      sums.jtj.noalias() += j * j.transpose();
      sums.jtr += residual * j;
      sums.objective += residual * residual;
    }
  }
}

CurveSums sums_of(const Channel& u, const Channel& v, const SignalModel& model,
                  double angle_noise) {
  CurveSums sums;
  sums.jtj.setZero();
  Spread spread;
  spread.by_terms.setZero();
  for (Eigen::Index i = 0; i < u.size(); ++i) {
    const Foot foot = foot_of(model, u[i], v[i]);
    const PointDerivatives d = derivatives_at(model, foot.theta);
    // The foot moves along the tangent, which the normal does not see.
    const CurveVector j = foot.normal_u * d.u + foot.normal_v * d.v;
    sums.jtj.noalias() += j * j.transpose();
    sums.jtr += foot.distance * j;
    sums.square += foot.distance * foot.distance;
    const std::complex<double> direction = std::polar(1.0, foot.theta);
    std::complex<double> turned = foot.distance;
    for (auto& sum : sums.order) {
      sum += turned;
      turned *= direction;
    }
    if (angle_noise <= 0) continue;
    const Point along = tangent_at(model, foot.theta);
    const CurveVector moved =
        -(along.u * d.u + along.v * d.v) / (along.u * along.u + along.v * along.v);
    std::complex<double> power = 1;
    for (int m = 0; m < spread_orders; ++m) {
      power *= direction;
      spread.sum[m] += power;
      spread.by_terms.col(m) += (std::complex<double>(0, m + 1) * power) * moved;
    }
  }
  sums.objective = sums.square;
  if (angle_noise > 0) add_spread(spread, static_cast<double>(u.size()), angle_noise, sums);
  return sums;
}

bool usable(const CurveVector& terms) {
  return terms.allFinite() && terms[0] > 0 && terms[1] > 0 && std::abs(terms[4]) < pi / 2 &&
         terms.tail(8).cwiseAbs().maxCoeff() < 0.3;
}

}  // namespace

CurveVector to_vector(const SignalModel& m) {
  const Parameters& p = m.fundamental;
  CurveVector vector;
  vector << p.a1, p.a2, p.b1, p.b2, p.beta, m.u[0].sine, m.u[0].cosine, m.u[1].sine, m.u[1].cosine,
      m.v[0].sine, m.v[0].cosine, m.v[1].sine, m.v[1].cosine;
  return vector;
}

SignalModel to_model(const CurveVector& x) {
  SignalModel model;
  model.fundamental = {x[0], x[1], x[2], x[3], x[4]};
  model.u = {HarmonicTerm{x[5], x[6]}, HarmonicTerm{x[7], x[8]}};
  model.v = {HarmonicTerm{x[9], x[10]}, HarmonicTerm{x[11], x[12]}};
  return model;
}

PointDerivatives derivatives_at(const SignalModel& model, double theta) {
  const Parameters& p = model.fundamental;
  const Point at = point_at(model, theta);
  const double s2 = std::sin(2 * theta), c2 = std::cos(2 * theta);
  const double s3 = std::sin(3 * theta), c3 = std::cos(3 * theta);
  PointDerivatives d;
  d.u << (at.u - p.b1) / p.a1, 0, 1, 0, 0, p.a1 * s2, p.a1 * c2, p.a1 * s3, p.a1 * c3, 0, 0, 0, 0;
  d.v << 0, (at.v - p.b2) / p.a2, 0, 1, -p.a2 * std::sin(theta + p.beta), 0, 0, 0, 0, p.a2 * s2,
      p.a2 * c2, p.a2 * s3, p.a2 * c3;
  return d;
}

Foot foot_of(const SignalModel& model, double u, double v) {
  const double theta = angle_of(model, u, v);
  const Point at = point_at(model, theta);
  const Point along = tangent_at(model, theta);
  const double speed = std::max(std::hypot(along.u, along.v), 1e-300);
  Foot foot{theta, 0, -along.v / speed, along.u / speed};
  foot.distance = (u - at.u) * foot.normal_u + (v - at.v) * foot.normal_v;
  return foot;
}

CurveFit fit_curve(const Channel& u, const Channel& v, const SignalModel& start, int highest,
                   CurveShape shape, double angle_noise) {
  const Unknowns unknowns(highest, shape);
  Vector x = unknowns.of(start);
  CurveSums sums = sums_of(u, v, to_model(unknowns.terms(x)), angle_noise);
  double damping = 1e-6;
  CurveFit fit;
  for (int iteration = 0; iteration < curve_iterations; ++iteration) {
    const Matrix map = unknowns.map(x);
    Matrix normal = map.transpose() * sums.jtj * map;
    normal.diagonal() *= 1 + damping;
    const Vector step = solve_symmetric(normal, map.transpose() * sums.jtr);
    const Vector candidate = x + step;
    const CurveVector terms = unknowns.terms(candidate);
    bool accepted = false;
    if (usable(terms)) {
      const CurveSums there = sums_of(u, v, to_model(terms), angle_noise);
      accepted = there.objective <= sums.objective;
      if (accepted) {
        x = candidate;
        sums = there;
      }
    }
    damping *= accepted ? 0.1 : 10;
    const double scale = std::max(x[0], x[1]);
    // Amplitudes and offsets in units of the larger amplitude.
    const double moved = std::max(step.head(4).cwiseAbs().maxCoeff() / scale,
                                  step.tail(step.size() - 4).cwiseAbs().maxCoeff());
    if (moved < 1e-13 || (!accepted && moved < 1e-9)) {
      fit.converged = true;
      break;
    }
  }
  const auto count = static_cast<double>(u.size());
  fit.model = to_model(unknowns.terms(x));
  fit.noise = std::sqrt(sums.square / std::max(count - unknowns.size(), 1.0));
  const Matrix map = unknowns.map(x);
  const Matrix normal = map.transpose() * sums.jtj * map;
  const Matrix inverse = pseudo_inverse_of(normal);
  fit.covariance = fit.noise * fit.noise * (map * inverse * map.transpose());
  for (const auto& order : sums.order) {
    fit.structure = std::max(fit.structure, std::norm(order) / std::max(sums.square, 1e-300));
  }
  return fit;
}

}  // namespace capsoc::identification
