#pragma once

#include "accuracy/report.h"

namespace capsoc::accuracy {

/// The table of sensors that drift by 0.1 % a second, on shafts that stop, turn back and turn up to
/// 100 times a second. The program `follow` runs on the coprocessor's model (following.h). The
/// largest angle error of all samples after its lock is compared with a bound, and LMS is there for
/// comparison.
void print_drift(Report& report);

}  // namespace capsoc::accuracy
