// A fit as curves for a report.
#pragma once

#include "base/curve.h"
#include "fit/fit.h"

namespace capsoc::fit {

/// - `samples`, `ellipse`: V over U of some samples, and of the curve that was identified
/// - `residual`, `residual_by_angle`: 1 - Y by sample and by the angle that was found, degrees
/// - `error_by_angle`, `raw_by_angle`: errors of the angle about their mean, degrees, with the
///   parameters and by atan2(U, V), over the true angle where it is known
/// - `loss`, `iteration.NAME`: on the way to the answer, with IdentifyOptions::trace
Curves curves_of(const Fit& fit);

/// Errors of angles about their mean in degrees over the true angle in degrees, in its order; both
/// given in radians. The way of counting that is nearer to the truth: samples do not tell it.
Curve angle_error_curve(const Eigen::ArrayXd& angles, const Eigen::ArrayXd& truth);

}  // namespace capsoc::fit
