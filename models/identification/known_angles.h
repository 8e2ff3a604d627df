// Least squares of both channels with harmonics on angles that are known.
#pragma once

#include "identification/calibration.h"
#include "identification/samples.h"

namespace capsoc::identification {
struct LinearFit {
  SignalModel model;
  double slope = 0;  ///< correction of the angle's slope over `place`, radians
};

/// Harmonics up to `highest`, angles in radians. With `place` (-1 .. 1) also the correction of the
/// angle's slope over it: one Gauss-Newton step about the model `last`.
LinearFit fit_on_angles(const Channel& u, const Channel& v, const Eigen::ArrayXd& theta,
                        int highest, const Eigen::ArrayXd* place, const SignalModel& last);

/// Median peak-to-peak error of the angle, radians, for `count` samples spread over whole turns:
/// the basis is orthogonal.
double expected_error_on_angles(const SignalModel& model, double noise, double count, int highest);

}  // namespace capsoc::identification
