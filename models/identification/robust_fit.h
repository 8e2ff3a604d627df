// Samples that do not belong to the ellipse, and the fit of the others.
#pragma once

#include <optional>
#include <vector>

#include "identification/distance_fit.h"
#include "identification/samples.h"

namespace capsoc::identification {

struct RobustFit {
  DistanceFit fit;  ///< of the kept samples
  /// Nothing: all samples were kept. They are not copied then.
  std::optional<Samples> kept;
  const Samples& of(const Samples& all) const { return kept ? *kept : all; }
  /// Places in the record, ascending, and the smallest and largest distance in units of the noise.
  std::vector<Eigen::Index> outliers;
  double nearest = 0, farthest = 0;
};

/// An ellipse near most of the samples, whatever the others are as long as they are well under one
/// half: the one of the smallest median distance (Rousseeuw, J. Am. Stat. Ass. 79, 1984) among
/// closed-form fits of everything and of small draws, then refined on the samples near it. Nothing
/// when no draw gives an ellipse. Samples that check_samples() takes; the draws are the same on
/// every run. Where a sensor rests, most of its samples say the same: a place counts as often as
/// eight of the others at most.
struct RobustStart {
  Parameters parameters;
  double noise = 0;  ///< 1.4826 times the median distance
};
std::optional<RobustStart> robust_start(const Channel& u, const Channel& v);

/// Leaves out what is farther from the ellipse than noise reaches in one record of a thousand, and
/// fits the others, until both agree. resolution: distances below are no outliers, unit of the
/// samples.
RobustFit fit_robustly(const Channel& u, const Channel& v, const RobustStart& start,
                       double resolution);

/// Distance of a sample from the ellipse, unit of the samples, negative inside.
double distance_from(const Parameters& parameters, double u, double v);

}  // namespace capsoc::identification
