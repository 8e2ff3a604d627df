#include "identification/lms_reference.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/constants.h"

namespace capsoc::identification::lms {
namespace {

const Steps unequal_steps = {{0.1, 0.2, 0.3}, {0.4, 0.05, 0.06}};

TEST(LmsReference, MakesTheUpdateOfEquation20ByHand) {
  LmsReference lms(unequal_steps, Gain::with_factor_two);
  lms.update(0.6, 0.8, 0.5, -0.25);
  EXPECT_DOUBLE_EQ(lms.error_u(), 0.5);
  EXPECT_DOUBLE_EQ(lms.error_v(), -0.25);
  EXPECT_DOUBLE_EQ(lms.coefficients().u[0], 2 * 0.5 * 0.1 * 0.6);
  EXPECT_DOUBLE_EQ(lms.coefficients().u[1], 2 * 0.5 * 0.2 * 0.8);
  EXPECT_DOUBLE_EQ(lms.coefficients().u[2], 2 * 0.5 * 0.3);
  EXPECT_DOUBLE_EQ(lms.coefficients().v[0], 2 * -0.25 * 0.4 * 0.6);
  EXPECT_DOUBLE_EQ(lms.coefficients().v[1], 2 * -0.25 * 0.05 * 0.8);
  EXPECT_DOUBLE_EQ(lms.coefficients().v[2], 2 * -0.25 * 0.06);
  lms.update(0.6, 0.8, 0.5, -0.25);  // err = 0.5 - (0.06 0.6 + 0.16 0.8 + 0.3)
  EXPECT_NEAR(lms.error_u(), 0.036, 1e-15);
}

TEST(LmsReference, MovesHalfAsFarWithoutTheFactorTwo) {
  LmsReference with(unequal_steps, Gain::with_factor_two);
  LmsReference without(unequal_steps, Gain::without_factor_two);
  with.update(0.6, 0.8, 0.5, -0.25);
  without.update(0.6, 0.8, 0.5, -0.25);
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_DOUBLE_EQ(with.coefficients().u[i], 2.0 * without.coefficients().u[i]);
    EXPECT_DOUBLE_EQ(with.coefficients().v[i], 2.0 * without.coefficients().v[i]);
  }
}

TEST(LmsReference, FindsTheParametersOfAnUndisturbedSignal) {
  const Parameters preset{0.6079, 0.6228, 0.1336, -0.1831, 0.0629, -2.1};
  LmsReference lms({{0.02, 0.02, 0.02}, {0.02, 0.02, 0.02}}, Gain::with_factor_two);
  for (int k = 0; k < 20000; ++k) {
    const double w = 0.04 * k;
    lms.update(std::sin(w), std::cos(w), preset.a1 * std::sin(w + preset.phi) + preset.b1,
               preset.a2 * std::cos(w + preset.phi + preset.beta) + preset.b2);
  }
  const Parameters found = lms.parameters();
  // 16 bits of slack above the double's rounding: the loop is at its fixed point.
  EXPECT_NEAR(found.a1, preset.a1, 1e-12);
  EXPECT_NEAR(found.a2, preset.a2, 1e-12);
  EXPECT_NEAR(found.b1, preset.b1, 1e-12);
  EXPECT_NEAR(found.b2, preset.b2, 1e-12);
  EXPECT_NEAR(found.beta, preset.beta, 1e-12);
  EXPECT_NEAR(found.phi, preset.phi, 1e-12);
  lms.reset();
  EXPECT_EQ(lms.parameters().a1, 0.0);
}

double deviation_after(double mu, Gain gain) {
  LmsReference lms({{mu, mu, mu}, {mu, mu, mu}}, gain);
  for (int k = 0; k < 4000; ++k) {
    const double w = 0.25 * k;
    lms.update(std::sin(w), std::cos(w), 0.5, 0.5);
  }
  return std::abs(lms.coefficients().u[2] - 0.5);
}

TEST(LmsReference, IsStableBelowAndDivergesAboveTheStepLimit) {
  // 2 mu (sin^2 + cos^2 + 1) < 2 with the factor 2. Near the limit the error vector is hardly
  // shortened, only turned: so bounded by its start value 0.5 is all that can be asked.
  EXPECT_LT(deviation_after(0.495, Gain::with_factor_two), 0.5);
  EXPECT_GT(deviation_after(0.505, Gain::with_factor_two), 1e3);
  EXPECT_LT(deviation_after(0.99, Gain::without_factor_two), 0.5);
  EXPECT_GT(deviation_after(1.01, Gain::without_factor_two), 1e3);
}

TEST(LmsReference, TurnsParametersIntoCoefficientsAndBack) {
  for (double phi = -3.0; phi < 3.1; phi += 0.75) {
    for (double beta = -3.0; beta < 3.1; beta += 0.75) {
      const Parameters preset{0.3, 0.7, -0.1, 0.2, beta, phi};
      const Parameters back = parameters_of(coefficients_of(preset));
      EXPECT_NEAR(back.a1, preset.a1, 1e-15);
      EXPECT_NEAR(back.a2, preset.a2, 1e-15);
      EXPECT_NEAR(back.phi, phi, 1e-14);
      EXPECT_NEAR(wrapped(back.beta - beta), 0.0, 1e-14);
      EXPECT_EQ(back.b1, preset.b1);
      EXPECT_EQ(back.b2, preset.b2);
    }
  }
}

TEST(LmsReference, GivesTheAngleInAllFourQuadrantsAlsoWithNegativeCosineOfBeta) {
  for (const double beta : {0.0629, -1.2, 3.0796}) {
    const Parameters preset{0.3428, 0.2537, 0.0485, -0.0224, beta, 0.0};
    for (double theta = -3.1; theta < 3.1; theta += 0.1) {
      const double u = preset.a1 * std::sin(theta) + preset.b1;
      const double v = preset.a2 * std::cos(theta + beta) + preset.b2;
      EXPECT_NEAR(wrapped(calibrated_angle(preset, u, v) - theta), 0.0, 1e-14)
          << theta << " " << beta;
    }
  }
}

TEST(LmsReference, WrapsDifferencesIntoOneTurn) {
  EXPECT_DOUBLE_EQ(wrapped(pi), pi);
  EXPECT_DOUBLE_EQ(wrapped(-pi), pi);
  EXPECT_NEAR(wrapped(7.0 * pi / 2.0), -pi / 2.0, 1e-15);
  EXPECT_NEAR(wrapped(-0.25), -0.25, 0.0);
}

}  // namespace
}  // namespace capsoc::identification::lms
