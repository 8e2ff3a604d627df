// What capsoc fit claims, compared with random records.
#pragma once

#include <cstdint>
#include <iosfwd>

#include "fit/drawn_records.h"

namespace capsoc::fit {

/// How often the 95 % intervals hold the truth, over noise and number of samples, `records` of each
/// (of 20,000 samples a fifth). Marks with MISSED and counts the cells outside 93 to 97 % by more
/// than the number of records explains.
int print_coverage(std::ostream& out, int records, uint64_t from = seed);

/// Records of every kind: accepted with an angle error within the stated bound, accepted with
/// harmonics said, or rejected for a reason that is true. Counts what is neither.
int print_drawn(std::ostream& out, int records);

/// Ratio of the stated bound to the true error for random sensors without harmonics, `sensors` a
/// row: median, 95 % and the least. Counts the records whose error is beyond the bound.
int print_bounds(std::ostream& out, int sensors, uint64_t from = seed);

/// How large the angle's error is in units of the harmonics' amplitude that the samples show, for
/// several orders and for single ones, `sensors` of each. Counts the first row when the factor 6 of
/// the bound holds for less than 95 % of it; for single harmonics it is not claimed.
int print_allowance(std::ostream& out, int sensors);

}  // namespace capsoc::fit
