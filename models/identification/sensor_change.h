// Whether the samples that a fit left out show that the sensor was another one for a time.
#pragma once

#include "identification/gates.h"
#include "identification/robust_fit.h"

namespace capsoc::identification {

/// "change": disturbances strike one sample, or scatter. Consecutive outliers that follow a curve,
/// as an ellipse with other parameters has it, are samples of a sensor that changed, and what the
/// others say of it did not hold for them. Samples that all lie at one point are a signal that was
/// lost: they follow no curve.
Gate check_change(const Samples& samples, const RobustFit& robust);

}  // namespace capsoc::identification
