// Moments of a record: what its checks and the closed-form fits work on.
#pragma once

#include <Eigen/Core>

#include "base/result.h"
#include "identification/samples.h"

namespace capsoc::identification {

/// Means of the products of two of the conic's monomials x^2, xy, y^2, x, y, 1.
using ConicMoments = Eigen::Matrix<double, 6, 6>;

struct Moments {
  /// Of x = (U - mean_u)/spread_u and y = (V - mean_v)/spread_v.
  ConicMoments m = ConicMoments::Zero();
  double mean_u = 0, mean_v = 0;
  double spread_u = 1, spread_v = 1;  ///< standard deviations
};

/// Error: the sentences of check_samples().
Result<Moments> moments_of(const Channel& u, const Channel& v);

}  // namespace capsoc::identification
