// Separates samples of the ellipse from outliers and clipped samples.
#pragma once

#include "identification/identification.h"
#include "identification/robust_fit.h"

namespace capsoc::identification {
/// Distances that say nothing: the converter's step, or the arithmetic; unit of the samples.
double resolution_of(const Samples& samples, const IdentifyOptions& options);

/// Takes back a gate "clipping" that failed for a pile of equal values which lie on the ellipse of
/// the other samples: those are of a sensor that stands still at its peak. Values at full scale
/// stay clipped.
void confirm_clipping(const Samples& samples, const IdentifyOptions& options, Gate& clipping);

/// The failed gate of a plateau that lies inside the ellipse of the other samples; otherwise the
/// last one passed.
Gate check_plateaus(const Samples& samples, double resolution, const IdentifyOptions& options);

/// Gates of what belongs to the ellipse; fills in the outliers.
RobustFit separate(const Samples& samples, double resolution, const IdentifyOptions& options,
                   Identification& found);

}  // namespace capsoc::identification
