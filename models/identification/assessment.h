// What an answer guarantees: intervals, the bound of the angle, or the sentence that takes it
// back.
#pragma once

#include "identification/distance_fit.h"
#include "identification/identification.h"

namespace capsoc::identification {
/// "noise": that of the samples against the ellipse's smaller half axis.
Gate check_noise(const DistanceFit& fit, double limit);

/// Tests what the fit leaves of the samples; fills in the tests' results, intervals, notes, bound
/// (with its gate) or warning. resolution: distances that say nothing, unit of the samples. Returns
/// what noise alone explains.
Intervals assess(const Samples& samples, const DistanceFit& fit, double resolution,
                 const IdentifyOptions& options, Identification& found);

/// The same when harmonics were identified.
void assess_harmonics(Identification& found);

}  // namespace capsoc::identification
