// Whether the distances from a fitted ellipse are noise, or repeat with the angle.
#pragma once

#include "identification/distance_fit.h"
#include "identification/scores.h"

namespace capsoc::identification {

/// A harmonic h of a channel bends the ellipse's radius at the orders h - 1 and h + 1 of the angle.
/// The orders 0 to 2 are the ellipse's own, so what is looked for is orders 3 to 8.
struct Structure {
  bool found = false;
  int order =
      0;  ///< the one with the largest amplitude; 0: the samples do not tell the orders apart
  double amplitude = 0;  ///< root of the sum of all orders' squares, relative to the radius
  /// What noise alone leaves in it (its root mean square), the same unit.
  double noise = 0;
  /// Probability that noise alone gives a test value as extreme as the largest one; found: below
  /// structure_false_alarms.
  double probability = 1;
  int last_order = 0;  ///< the highest that the samples suffice for; below 3: nothing was tested.
  /// Combinations of the orders' terms that were tested: all of them when the samples cover the
  /// turn, fewer on an arc or at few angles, where the ellipse takes the others up.
  int directions = 0;
  ScoreVector terms = ScoreVector::Zero();  ///< of the radius, least squares; unused ones are 0
  /// Covariance of the terms for scores of covariance `information`; unused ones are 0.
  ScoreMatrix inverse = ScoreMatrix::Zero();
  /// Covariance of the ellipse's change for orders of amplitude 1 that the samples do not show on
  /// an arc; 0 when all directions were tested.
  Eigen::Matrix<double, 5, 5> leak = Eigen::Matrix<double, 5, 5>::Zero();
};

/// Records with noise alone in which structure is found.
constexpr double structure_false_alarms = 1e-3;

/// F tests of every order and of orders 3 to k together, against what remains. resolution: an
/// amplitude below this (unit of the samples) is rounding. With `covariance`, that of the scores'
/// sum, noise is not taken as independent and what remains is no measure of it.
Structure structure_of(const Scores& scores, const DistanceFit& fit, double resolution,
                       const ScoreMatrix* covariance = nullptr);

}  // namespace capsoc::identification
