// A map of the hardware: what injected faults did, place by place.
#pragma once

#include <string>

#include "report/result_file.h"

namespace capsoc::report {

/// Of a campaign of faults a drawing for each list of units or places that it tells apart (`by` of
/// fault.unit, fault.place). A rectangle is as large as the number of its faults, and so of its
/// bits, and is divided by their verdicts. Nothing for other campaigns.
std::string fault_maps_of(const Json& result);

}  // namespace capsoc::report
