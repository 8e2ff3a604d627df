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

}  // namespace capsoc::fit
