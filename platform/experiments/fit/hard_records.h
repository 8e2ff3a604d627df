// Records as people make them: noise with a memory, few angles, arcs, drift, one-sided outliers.
#pragma once

#include <string>
#include <vector>

#include "fit/drawn_records.h"

namespace capsoc::fit {

/// A kind of record for the table of coverage.
struct HardKind {
  const char* name;
  DrawnRecord (*draw)(Random& random);
};

/// Correlated noise (AR(1) with 0.5 and 0.9 in order of time and at random angles, 1/f), drift,
/// indexed positions, arcs of 60 to 350 degrees, one-sided outliers. The truth of a sensor that
/// drifts is its mean over the record.
const std::vector<HardKind>& hard_kinds();

}  // namespace capsoc::fit
