// What a change of the circle does to the calibrated angle.
#pragma once

#include <functional>

#include "csfn/circle_plane.h"

namespace capsoc::csfn {

/// Derivatives of the angle at theta by the change of the circle. Its origin turns along: where U's
/// sine has its peak a stretch moves nothing.
Change angle_by_change(double theta);

/// Largest change of the angle over the turn, radians.
double largest_angle_of(const Change& change);

/// Largest standard deviation of the angle over the turn for a covariance of the change, or over
/// the angles (radians) that `within` takes.
double largest_angle_of(const Eigen::Matrix<double, 5, 5>& covariance,
                        const std::function<bool(double)>& within = nullptr);

}  // namespace capsoc::csfn
