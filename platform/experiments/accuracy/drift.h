#pragma once

#include "accuracy/report.h"

namespace capsoc::accuracy {

/// The table of sensors that drift by 0.1 % a second, on shafts that stop, turn back and turn up to
/// 100 times a second: the program `follow` on the coprocessor's model (following.h), the largest
/// angle error of all samples after its lock against a bound, and LMS for comparison.
void print_drift(Report& report);

}  // namespace capsoc::accuracy
