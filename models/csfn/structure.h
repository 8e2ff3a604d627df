// Whether the distances from a fitted ellipse are noise, or repeat with the angle.
#pragma once

#include "csfn/distance_fit.h"
#include "csfn/samples.h"

namespace capsoc::csfn {

/// A harmonic h of a channel bends the ellipse's radius at the orders h - 1 and h + 1 of the angle.
/// The orders 0 to 2 are the ellipse's own, so what is looked for is orders 3 to 8.
struct Structure {
  bool found = false;
  int order = 0;         ///< the one with the largest amplitude
  double amplitude = 0;  ///< root of the sum of all orders' squares, relative to the radius
  /// What noise alone leaves in it (its root mean square), the same unit.
  double noise = 0;
  /// Probability that noise alone gives a test value as extreme as the largest one; found: below
  /// structure_false_alarms.
  double probability = 1;
  int last_order = 0;  ///< the highest that the samples suffice for; below 3: nothing was tested
};

/// Records with noise alone in which structure is found.
constexpr double structure_false_alarms = 1e-3;

/// F tests of every order and of orders 3 to k together, against what remains. resolution: an
/// amplitude below this (unit of the samples) is rounding.
Structure structure_of(const Channel& u, const Channel& v, const DistanceFit& fit,
                       double resolution);

}  // namespace capsoc::csfn
