// The routes to harmonics, one for each assumption about the motion, and what they share.
#pragma once

#include <string>

#include "identification/curve_fit.h"
#include "identification/harmonics.h"

namespace capsoc::identification {
/// Where a residual, relative to the smaller amplitude, is rounding.
inline constexpr double rounding_part = 1e-12;
/// What the model may leave in the distances (CurveFit::structure).
inline constexpr double largest_structure = 14;

/// One route's outcome; holds with a false `held` why it does not.
struct Attempt {
  Assumption assumption = Assumption::none;
  bool held = false;
  std::string reason;
  std::string check;
  double value = 0, limit = 0;
  SignalModel model;
  double distance = 0;        ///< rms distance of the samples from the curve
  double expected_error = 0;  ///< radians, peak to peak
  double coverage_error = 0;
  std::string unbounded;  ///< why it guarantees no angle, or ""
};

/// Samples in order of time, the shaft turning steadily. Angles by Eq (4) of `start` say how far.
Attempt at_constant_speed(const Channel& u, const Channel& v, const Parameters& start, int highest);

/// Samples in any order that cover the turn evenly, or at random angles.
Attempt at_even_coverage(const Channel& u, const Channel& v, const Parameters& start, int highest);

/// The curve alone, each channel with its own harmonics or both with the same waveform.
Attempt from_the_curve(const Channel& u, const Channel& v, const SignalModel& start, int highest,
                       CurveShape shape);

/// rms distance of the samples from the curve.
double distance_of(const Channel& u, const Channel& v, const SignalModel& model);

/// Median peak-to-peak error of the angle, radians, when the model's terms scatter with that
/// covariance.
double expected_error(const SignalModel& model, const Eigen::MatrixXd& covariance);

/// The angle of every sample, radians.
Eigen::ArrayXd angles_of(const Channel& u, const Channel& v, const SignalModel& model);

/// Whether a model is one of a sensor whose amplitudes are about `scale`.
bool plausible(const SignalModel& model, double scale);

}  // namespace capsoc::identification
