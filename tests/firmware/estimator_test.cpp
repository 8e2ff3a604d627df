// The estimator of firmware/apps/recursive, compiled for the host, against the normal equations of
// all samples and against Joseph's form of the Kalman filter.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>
#include <vector>

extern "C" {
#include "apps/recursive/estimator.c"
}

namespace {

struct Sample {
  Eigen::Vector3d x;
  double u, v;
};

/// Of a shaft at constant speed, with noise; the first angles lie close together.
std::vector<Sample> samples(unsigned count, double noise, uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0, 1);
  std::vector<Sample> all;
  for (unsigned k = 0; k < count; ++k) {
    const double angle = 0.01 * k;
    const Eigen::Vector3d x(std::sin(angle), std::cos(angle), 1);
    all.push_back({x, x.dot(Eigen::Vector3d(0.6, 0.05, 0.13)) + noise * normal(random),
                   x.dot(Eigen::Vector3d(-0.03, 0.62, -0.18)) + noise * normal(random)});
  }
  return all;
}

estimator begun(double forgetting, double drift) {
  estimator state = {forgetting, drift, {{0, 0, 0}, {0, 0, 0}}, {}};
  estimator_begin(&state);
  return state;
}

Eigen::Vector3d weights(const estimator& state, int channel) {
  return {state.weights[channel][0], state.weights[channel][1], state.weights[channel][2]};
}

TEST(Estimator, LeastSquaresOfAllSamples) {
  for (const double forgetting : {0.0, 1e-3, 0.05}) {
    estimator state = begun(forgetting, 0);
    // What was known in the beginning: nothing, with a variance of 1e9.
    Eigen::Matrix3d normal = Eigen::Matrix3d::Identity() * 1e-9;
    Eigen::Vector3d right_u = Eigen::Vector3d::Zero(), right_v = right_u;
    for (const Sample& s : samples(1500, 1e-3, 7)) {
      estimator_update(&state, s.x[0], s.x[1], s.u, s.v);
      normal = (1 - forgetting) * normal + s.x * s.x.transpose();
      right_u = (1 - forgetting) * right_u + s.x * s.u;
      right_v = (1 - forgetting) * right_v + s.x * s.v;
    }
    EXPECT_LT((weights(state, 0) - normal.ldlt().solve(right_u)).norm(), 1e-9) << forgetting;
    EXPECT_LT((weights(state, 1) - normal.ldlt().solve(right_v)).norm(), 1e-9) << forgetting;
  }
}

TEST(Estimator, KalmanFilterOfWeightsThatWalk) {
  estimator state = begun(0, 1e-4);
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity() * 1e9;
  Eigen::Vector3d u = Eigen::Vector3d::Zero(), v = u;
  for (const Sample& s : samples(1500, 1e-2, 11)) {
    estimator_update(&state, s.x[0], s.x[1], s.u, s.v);
    const Eigen::Vector3d gain = covariance * s.x / (s.x.dot(covariance * s.x) + 1);
    u += gain * (s.u - s.x.dot(u));
    v += gain * (s.v - s.x.dot(v));
    const Eigen::Matrix3d kept = Eigen::Matrix3d::Identity() - gain * s.x.transpose();
    covariance = kept * covariance * kept.transpose() + gain * gain.transpose() +
                 1e-4 * Eigen::Matrix3d::Identity();
  }
  EXPECT_LT((weights(state, 0) - u).norm(), 1e-7);
  EXPECT_LT((weights(state, 1) - v).norm(), 1e-7);
  EXPECT_GT((u - Eigen::Vector3d(0.6, 0.05, 0.13)).norm(), 1e-5);  // there was noise
}

TEST(Estimator, TheCovarianceStaysOne) {
  estimator state = begun(1e-4, 0);
  for (const Sample& s : samples(200000, 0, 1)) estimator_update(&state, s.x[0], s.x[1], s.u, s.v);
  const Eigen::Matrix3d covariance =
      Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(&state.covariance[0][0]);
  EXPECT_EQ(covariance, covariance.transpose());
  EXPECT_GT(covariance.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff(), 0);
}

}  // namespace
