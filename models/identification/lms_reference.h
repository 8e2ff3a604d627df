#pragma once

#include <array>

namespace capsoc::identification::lms {

/// The signal model's parameters, Eq (1) of the SoC paper: amplitudes and offsets in units of full
/// scale, beta and phi in radians.
struct Parameters {
  double a1 = 0.0, a2 = 0.0, b1 = 0.0, b2 = 0.0, beta = 0.0, phi = 0.0;
};

/// The six coefficients of Eq (7), each channel in the order of r(k) = (sin, cos, 1).
struct Coefficients {
  std::array<double, 3> u{};
  std::array<double, 3> v{};
};

/// Step factors mu of Eq (20), each channel in the order of r(k) = (sin, cos, 1).
struct Steps {
  std::array<double, 3> u{};
  std::array<double, 3> v{};
};

/// Whether the update has Eq (20)'s factor 2. The paper's own simulation results only come out
/// without it; the stability limit (all steps equal) is mu < 1 without and mu < 1/2 with it.
enum class Gain { with_factor_two, without_factor_two };

/// The least mean square error demodulation (LMSED) in double precision: what the coprocessor
/// computes, without quantisation. Starts from coefficients 0.
class LmsReference {
 public:
  LmsReference(const Steps& steps, Gain gain);

  /// One sample of both channels against the reference sine and cosine, Eqs (16) and (20).
  void update(double sine, double cosine, double u, double v);

  const Coefficients& coefficients() const { return weights_; }
  Parameters parameters() const;

  /// err(k) of the last update, Eq (16).
  double error_u() const { return error_u_; }
  double error_v() const { return error_v_; }

  void reset();

 private:
  Steps gains_;  ///< mu, or 2 mu
  Coefficients weights_;
  double error_u_ = 0.0;
  double error_v_ = 0.0;
};

/// Eq (9) with the four-quadrant arctangent: phi and beta in (-pi, pi]. Coefficients of 0 give
/// amplitudes and angles of 0.
Parameters parameters_of(const Coefficients& coefficients);

/// Eq (8).
Coefficients coefficients_of(const Parameters& parameters);

/// theta in (-pi, pi] from Eq (4), phi included. Not for a1 = 0, a2 = 0 or cos(beta) = 0. With
/// cos(beta) < 0 it stays right: both of Eq (4)'s expressions keep their signs.
double calibrated_angle(const Parameters& parameters, double u, double v);

/// An angle difference in (-pi, pi].
double wrapped(double radians);

}  // namespace capsoc::identification::lms
