// Whether the samples that a fit left out are disturbances, or a part of the turn where the sensor
// is no ellipse.
#pragma once

#include "identification/gates.h"
#include "identification/robust_fit.h"

namespace capsoc::identification {

/// "places": disturbances strike at any angle. Outliers near the ellipse may be at the same angles
/// more often than the kept samples explain, or a part of the turn may have no sample without them.
/// Then they are no disturbances but a dead zone, a stuck code or a broken contact.
Gate check_left_out(const Samples& samples, const RobustFit& robust);

}  // namespace capsoc::identification
