#include "identification/lms_reference.h"

#include <cmath>

#include "base/constants.h"

namespace capsoc::identification::lms {
namespace {

// Returns err(k), the error before the update.
double adapt(std::array<double, 3>& weights, const std::array<double, 3>& gains,
             const std::array<double, 3>& reference, double input) {
  double error = input;
  for (size_t i = 0; i < 3; ++i) error -= weights[i] * reference[i];
  for (size_t i = 0; i < 3; ++i) weights[i] += gains[i] * error * reference[i];
  return error;
}

}  // namespace

LmsReference::LmsReference(const Steps& steps, Gain gain) : gains_(steps) {
  if (gain == Gain::without_factor_two) return;
  for (double& step : gains_.u) step *= 2.0;
  for (double& step : gains_.v) step *= 2.0;
}

void LmsReference::update(double sine, double cosine, double u, double v) {
  const std::array<double, 3> reference = {sine, cosine, 1.0};
  error_u_ = adapt(weights_.u, gains_.u, reference, u);
  error_v_ = adapt(weights_.v, gains_.v, reference, v);
}

Parameters LmsReference::parameters() const {
  return parameters_of(weights_);
}

void LmsReference::reset() {
  weights_ = Coefficients();
  error_u_ = error_v_ = 0.0;
}

Parameters parameters_of(const Coefficients& coefficients) {
  const auto& [a_u, b_u, c_u] = coefficients.u;
  const auto& [a_v, b_v, c_v] = coefficients.v;
  Parameters parameters;
  parameters.a1 = std::hypot(a_u, b_u);
  parameters.a2 = std::hypot(a_v, b_v);
  parameters.b1 = c_u;
  parameters.b2 = c_v;
  parameters.phi = std::atan2(b_u, a_u);
  parameters.beta = wrapped(std::atan2(-a_v, b_v) - parameters.phi);
  return parameters;
}

Coefficients coefficients_of(const Parameters& parameters) {
  const double psi = parameters.phi + parameters.beta;
  return {{parameters.a1 * std::cos(parameters.phi), parameters.a1 * std::sin(parameters.phi),
           parameters.b1},
          {-parameters.a2 * std::sin(psi), parameters.a2 * std::cos(psi), parameters.b2}};
}

double calibrated_angle(const Parameters& parameters, double u, double v) {
  const double sine = (u - parameters.b1) / parameters.a1;
  const double cosine = (v - parameters.b2) / (parameters.a2 * std::cos(parameters.beta)) +
                        sine * std::tan(parameters.beta);
  return std::atan2(sine, cosine);
}

double wrapped(double radians) {
  const double rest = std::remainder(radians, 2.0 * pi);
  return rest <= -pi ? pi : rest;
}

}  // namespace capsoc::identification::lms
