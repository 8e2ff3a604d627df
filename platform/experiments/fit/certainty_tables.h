// What capsoc fit claims, held against drawn records.
#pragma once

#include <iosfwd>

namespace capsoc::fit {

/// How often the 95 % intervals hold the truth, over noise and number of samples, `records` of each
/// (of 20,000 samples a fifth). Marks with MISSED and counts the cells outside 93 to 97 % by more
/// than the number of records explains.
int print_coverage(std::ostream& out, int records);

/// Records of every kind: accepted with an angle error within the stated bound, accepted with
/// harmonics said, or rejected for a reason that is true. Counts what is neither.
int print_drawn(std::ostream& out, int records);

/// How large the angle's error is in units of the harmonics' amplitude that the samples show, for
/// several orders and for single ones, `sensors` of each. Counts the first row when the factor 6 of
/// the bound holds for less than 95 % of it; for single harmonics it is not claimed.
int print_allowance(std::ostream& out, int sensors);

}  // namespace capsoc::fit
