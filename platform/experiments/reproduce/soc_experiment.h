#pragma once

#include <string>

#include "reproduce/report.h"

namespace capsoc::reproduce {

/// The SoC paper's section 4.3 on the trace that was rebuilt from it: Table 9 and Figures 17 and 18
/// by the coprocessor model, Table 10 by the CSFN. `traces`: the folder of the traces.
void soc_experiment_tables(Report& report, const std::string& traces);

}  // namespace capsoc::reproduce
