#include "identification/harmonics_route.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/constants.h"
#include "base/random.h"
#include "identification/linear_algebra.h"

namespace capsoc::identification {
double distance_of(const Channel& u, const Channel& v, const SignalModel& model) {
  double square = 0;
  for (Eigen::Index i = 0; i < u.size(); ++i) {
    const double distance = foot_of(model, u[i], v[i]).distance;
    square += distance * distance;
  }
  return std::sqrt(square / static_cast<double>(u.size()));
}

double expected_error(const SignalModel& model, const Eigen::MatrixXd& covariance) {
  constexpr int draws = 63, angles = 90;
  const SymmetricEigen eigen = eigen_of_symmetric(covariance);
  const Eigen::MatrixXd root = eigen.vectors * eigen.values.cwiseMax(0).cwiseSqrt().asDiagonal();
  Eigen::MatrixXd sensitivity(angles, curve_terms);
  for (int i = 0; i < angles; ++i) {
    const double theta = 2 * pi * i / angles;
    const Point along = tangent_at(model, theta);
    const PointDerivatives d = derivatives_at(model, theta);
    const double square = along.u * along.u + along.v * along.v;
    sensitivity.row(i) = (along.u * d.u + along.v * d.v).transpose() / square;
  }
  const Eigen::MatrixXd from_normal = sensitivity * root;
  Random random(1);
  std::vector<double> errors;
  for (int draw = 0; draw < draws; ++draw) {
    Eigen::VectorXd normal(curve_terms);
    for (double& x : normal) {  // twelve uniform numbers are near enough to a normal one
      x = -6;
      for (int k = 0; k < 12; ++k) x += random.uniform();
    }
    const Eigen::VectorXd error = from_normal * normal;
    errors.push_back(error.maxCoeff() - error.minCoeff());
  }
  std::nth_element(errors.begin(), errors.begin() + draws / 2, errors.end());
  return errors[draws / 2];
}

Eigen::ArrayXd angles_of(const Channel& u, const Channel& v, const SignalModel& model) {
  Eigen::ArrayXd theta(u.size());
  for (Eigen::Index i = 0; i < u.size(); ++i) theta[i] = angle_of(model, u[i], v[i]);
  return theta;
}

bool plausible(const SignalModel& model, double scale) {
  const CurveVector terms = to_vector(model);
  return terms.allFinite() && terms.tail(8).cwiseAbs().maxCoeff() < 0.3 &&
         terms.head(2).minCoeff() > 0 && terms.head(4).cwiseAbs().maxCoeff() < 100 * scale &&
         std::abs(terms[4]) < pi / 2;
}

}  // namespace capsoc::identification
