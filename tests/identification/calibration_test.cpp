#include "identification/calibration.h"

#include <gtest/gtest.h>

#include "signals.h"

namespace capsoc::identification {
namespace {

TEST(Calibration, RecoversTheAngleByEquation4) {
  for (const double beta : {-1.2, -0.3, 0.0, 0.9032, 1.2}) {
    Parameters p = table_1;
    p.beta = beta;
    SignalModel model;
    model.fundamental = p;
    for (double theta = -3; theta < 3.1; theta += 0.37) {
      const Point at = point_at(model, theta);
      EXPECT_NEAR(angle_of(p, at.u, at.v), theta, 1e-14);
      EXPECT_NEAR(angle_of(model, at.u, at.v), theta, 1e-14);
    }
  }
}

TEST(Calibration, RecoversTheAngleThroughHarmonics) {
  SignalModel model;
  model.fundamental = table_1;
  model.u = {HarmonicTerm{0.01, -0.02}, HarmonicTerm{0.015, 0.01}};
  model.v = {HarmonicTerm{-0.02, 0.01}, HarmonicTerm{0.005, 0.02}};
  for (double theta = -3; theta < 3.1; theta += 0.37) {
    const Point at = point_at(model, theta);
    EXPECT_NEAR(angle_of(model, at.u, at.v), theta, 1e-13);
    const double h = 1e-6;
    const Point ahead = point_at(model, theta + h), behind = point_at(model, theta - h);
    EXPECT_NEAR(tangent_at(model, theta).u, (ahead.u - behind.u) / (2 * h), 1e-9);
    EXPECT_NEAR(tangent_at(model, theta).v, (ahead.v - behind.v) / (2 * h), 1e-9);
  }
}

TEST(Calibration, ComparesReversedAndDirectRotation) {
  // The SoC paper's experiment: 3.0796 is a reversed rotation with 0.0620.
  const Canonical reversed = canonical({0.6, 0.62, 0.1, 0.2, 3.0796});
  EXPECT_TRUE(reversed.reversed);
  EXPECT_NEAR(reversed.parameters.beta, pi - 3.0796, 1e-15);
  const Canonical direct = canonical({0.6, 0.62, 0.1, 0.2, 0.062});
  EXPECT_FALSE(direct.reversed);
  EXPECT_NEAR(direct.parameters.beta, 0.062, 1e-15);
  // Every set of signs and branches is the same set of points.
  for (const Parameters& p :
       {Parameters{0.6, -0.62, 0.1, 0.2, 0.4}, Parameters{-0.6, 0.62, 0.1, 0.2, 2.4},
        Parameters{-0.6, -0.62, 0.1, 0.2, -4}}) {
    SignalModel model;
    model.fundamental = canonical(p).parameters;
    EXPECT_GT(model.fundamental.a1, 0);
    EXPECT_LE(std::abs(model.fundamental.beta), pi / 2);
    for (double theta = 0; theta < 6; theta += 0.7) {
      const double u = p.a1 * std::sin(theta) + p.b1;
      const double v = p.a2 * std::cos(theta + p.beta) + p.b2;
      const Point at = point_at(model, angle_of(model.fundamental, u, v));
      EXPECT_NEAR(at.u, u, 1e-14);
      EXPECT_NEAR(at.v, v, 1e-14);
    }
  }
}

TEST(Calibration, MeasuresThePeakToPeakErrorAcrossTurnsAndConstants) {
  const Eigen::ArrayXd truth = Eigen::ArrayXd::LinSpaced(1001, 0, 20);
  Eigen::ArrayXd angle = truth + 3.1 + 0.2 * truth.sin();
  for (double& x : angle) x = wrapped(x);
  EXPECT_NEAR(peak_to_peak_error(angle, truth), 0.4, 1e-4);
  EXPECT_EQ(peak_to_peak_error(Eigen::ArrayXd(0), Eigen::ArrayXd(0)), 0);
}

}  // namespace
}  // namespace capsoc::identification
