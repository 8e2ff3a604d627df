#pragma once

#include <string>

#include "base/curve.h"
#include "base/result.h"
#include "reproduce/report.h"

namespace capsoc::reproduce {

/// The SoC paper's section 4.3 on the trace that was rebuilt from it: Table 9 and Figures 17 and 18
/// by the coprocessor model, Table 10 by the CSFN. `traces`: the folder of the traces.
void soc_experiment_tables(Report& report, const std::string& traces);

/// Figures 17 and 18: the errors of one turn about their mean, degrees over the true angle in
/// degrees. `calibration`: with the parameters stored at the end of demodulation.
struct ExperimentErrors {
  Curve uncalibrated, demodulation, calibration, csfn;
};
Result<ExperimentErrors> soc_experiment_errors(const std::string& traces);

}  // namespace capsoc::reproduce
