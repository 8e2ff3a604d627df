#pragma once

#include <string>

#include "reproduce/report.h"

namespace capsoc::reproduce {

/// The CSFN paper's tables: Table 1 and Figures 12 and 14 (simulations), Table 2 and Figure 22 (the
/// experiment, on the trace that was rebuilt from it). `traces`: the folder of the traces.
void csfn_tables(Report& report, const std::string& traces);

}  // namespace capsoc::reproduce
