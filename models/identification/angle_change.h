// What a change of the circle does to the calibrated angle.
#pragma once

#include <functional>

#include "identification/circle_plane.h"

namespace capsoc::identification {

/// Derivatives of the angle at theta by the change of the circle. Its origin turns along: where U's
/// sine has its peak a stretch moves nothing.
Change angle_by_change(double theta);

/// Largest change of the angle over the turn, radians.
double largest_angle_of(const Change& change);

/// Largest standard deviation of the angle over the turn for a covariance of the change, or over
/// the angles (radians) that `within` takes.
double largest_angle_of(const Eigen::Matrix<double, 5, 5>& covariance,
                        const std::function<bool(double)>& within = nullptr);

/// Factor of the angle's standard deviation within which the error stays at all angles at once,
/// except in a part `risk` of the records. It is the volume of the tube about the curve of the
/// directions (Hotelling 1939; an upper bound: Naiman 1986), or Scheffe's factor where that is
/// smaller. `freedom`: of the noise that the covariance was scaled with.
double simultaneous_factor(const Eigen::Matrix<double, 5, 5>& covariance, double freedom,
                           double risk, const std::function<bool(double)>& within);

}  // namespace capsoc::identification
