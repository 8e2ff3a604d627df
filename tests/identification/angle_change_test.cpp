// The simultaneous band of the angle's error over the turn, against drawn changes of the circle.
#include "identification/angle_change.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "base/constants.h"
#include "base/random.h"
#include "identification/distributions.h"

namespace capsoc::identification {
namespace {

constexpr double freedom = 15, risk = 0.01;

double normal_of(Random& random) {
  const double radius = std::sqrt(-2 * std::log(1 - random.uniform()));
  return radius * std::cos(2 * pi * random.uniform());
}

/// The part of drawn changes whose angle leaves the band somewhere, noise estimated with `freedom`.
double exceeded(const Eigen::Matrix<double, 5, 5>& root, double factor,
                const std::function<bool(double)>& within, Random& random) {
  constexpr int draws = 40'000, angles = 120;
  Eigen::Matrix<double, angles, 5> by;
  for (int i = 0; i < angles; ++i) {
    const double theta = 2 * pi * i / angles;
    by.row(i) = (root.transpose() * angle_by_change(theta)).normalized();
    if (within && !within(theta)) by.row(i).setZero();
  }
  int beyond = 0;
  for (int draw = 0; draw < draws; ++draw) {
    Eigen::Matrix<double, 5, 1> change;
    for (double& one : change) one = normal_of(random);
    double square = 0;
    for (int i = 0; i < static_cast<int>(freedom); ++i) square += std::pow(normal_of(random), 2);
    beyond += (by * change).cwiseAbs().maxCoeff() > factor * std::sqrt(square / freedom) ? 1 : 0;
  }
  return static_cast<double>(beyond) / draws;
}

TEST(SimultaneousFactor, HoldsAtAllAnglesAtOnceAndIsNarrowerThanScheffes) {
  Random random(7);
  const double scheffe = std::sqrt(5 * f_quantile(risk, 5, freedom));
  const std::function<bool(double)> third = [](double theta) { return theta < 2; };
  for (int sensor = 0; sensor < 3; ++sensor) {
    Eigen::Matrix<double, 5, 5> root;
    std::generate_n(root.data(), root.size(), [&] { return normal_of(random); });
    for (const auto& within : {std::function<bool(double)>(), third}) {
      const double factor = simultaneous_factor(root * root.transpose(), freedom, risk, within);
      EXPECT_LT(factor, 0.97 * scheffe);
      const double share = exceeded(root, factor, within, random);
      EXPECT_LT(share, risk + 4 * std::sqrt(risk / 40'000));
      EXPECT_GT(share, 0.3 * risk);
    }
  }
}

}  // namespace
}  // namespace capsoc::identification
