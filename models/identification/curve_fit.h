// The curve of SignalModel fitted to samples by their distances from it, angles unknown.
#pragma once

#include <Eigen/Core>
#include <array>

#include "identification/calibration.h"
#include "identification/samples.h"

namespace capsoc::identification {

/// a1, a2, b1, b2, beta, then for U and for V: sine and cosine of the second, of the third.
constexpr int curve_terms = 13;
using CurveVector = Eigen::Matrix<double, curve_terms, 1>;

CurveVector to_vector(const SignalModel& model);
SignalModel to_model(const CurveVector& vector);

/// Derivatives of point_at() by the 13 terms.
struct PointDerivatives {
  CurveVector u, v;
};
PointDerivatives derivatives_at(const SignalModel& model, double theta);

/// The sample's signed distance from the curve and where on it its foot is.
struct Foot {
  double theta;
  double distance;            ///< along the normal
  double normal_u, normal_v;  ///< of length 1
};
Foot foot_of(const SignalModel& model, double u, double v);

enum class CurveShape {
  free,       ///< every channel has its own harmonics
  symmetric,  ///< V is the waveform of U, a quarter turn + beta later
};

struct CurveFit {
  SignalModel model;
  double noise = 0;  ///< rms distance
  bool converged = false;
  /// Of the 13 terms, for the noise found.
  Eigen::Matrix<double, curve_terms, curve_terms> covariance;
  /// Largest of N |mean of distance e^(i m theta)|^2/noise^2 for m = 0 .. 12: about 3 for noise
  /// alone, above 12 for what the model lacks.
  double structure = 0;
};

/// Levenberg-Marquardt on the distances; harmonics up to `highest` (2 or 3). With `angle_noise`,
/// the rms distance, also on the spread of the angles, taken as random from the whole
/// circle: the means of e^(i m theta), m = 1 .. 3, of N such angles have a variance of 1/N. 0: not
/// used.
CurveFit fit_curve(const Channel& u, const Channel& v, const SignalModel& start, int highest,
                   CurveShape shape, double angle_noise = 0);

}  // namespace capsoc::identification
