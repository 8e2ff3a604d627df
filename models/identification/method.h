// The method that was asked for: from samples to the parameters of an identification.
#pragma once

#include "identification/distance_fit.h"
#include "identification/identification.h"

namespace capsoc::identification {
/// Fills in the method's parameters and how they were found; a failed gate when there are none.
/// `found` has the companions, `fit` is the fit of the same samples by their distances.
std::optional<Gate> apply_method(const Samples& samples, const DistanceFit& fit,
                                 const IdentifyOptions& options, Identification& found);

/// "training": whether it got where an ellipse fit shows that there is something to get to.
Gate check_training(const Identification& found);

}  // namespace capsoc::identification
