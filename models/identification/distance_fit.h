// The ellipse that is nearest to the samples, with the bias of noise taken off, and its covariance.
#pragma once

#include <Eigen/Core>

#include "identification/samples.h"

namespace capsoc::identification {

/// Noise is independent and normal with the same standard deviation in both channels; the samples'
/// angles are unknown and may be any (docs/explanation/fitting.md).
struct DistanceFit {
  Parameters parameters;
  double noise = 0;  ///< standard deviation of each channel, unit of the samples
  /// Of the change (circle_plane.h) of the parameters found, for that noise. For a covariance of
  /// the parameters: D covariance D^T with D = parameters_by_change().
  Eigen::Matrix<double, 5, 5> covariance = Eigen::Matrix<double, 5, 5>::Zero();
  /// For a noise of 1 and without its bias: what any scatter of that size would leave.
  Eigen::Matrix<double, 5, 5> unit_covariance = Eigen::Matrix<double, 5, 5>::Zero();
  int iterations = 0;
  bool converged = false;
};

/// Solves sum of (terms - NoiseExpectation) = 0 by Gauss and Newton's method. Channels of more than
/// five samples that check_samples() takes. The covariance is only there when converged.
DistanceFit fit_distances(const Channel& u, const Channel& v, const Parameters& start);

}  // namespace capsoc::identification
