#pragma once

#include "accuracy/report.h"

namespace capsoc::accuracy {

/// The coprocessor's model next to the methods of `capsoc fit --method all`, on the records of the
/// other tables: angle errors in degrees peak to peak with the parameters that each has at the end.
void print_peers(Report& report);

}  // namespace capsoc::accuracy
