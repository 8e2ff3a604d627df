// Why the fits of the same samples differ, as a sentence.
#pragma once

#include <string>

#include "identification/identification.h"
#include "identification/uncertainty.h"

namespace capsoc::identification {
/// Names the companion that is farthest off and why; empty when all are within `half`, what noise
/// explains without the difference itself. `found` has parameters, loss, gates and companions.
std::string disagreement_of(const Samples& samples, const Identification& found,
                            const Scatter& scatter, const Intervals& half);

}  // namespace capsoc::identification
