// The golden check of a run, and what it does to the exit code.
#pragma once

#include <vector>

#include "metrics/sample_record.h"
#include "run/results.h"
#include "soc/soc.h"

namespace capsoc::run {

/// Fits the recorded samples and compares. A pass whose angle disagrees is none.
/// `words`: the coprocessor's answer.
void take_golden(soc::Soc& soc, const metrics::SampleRecord& record,
                 const metrics::ParameterWords& words, RunResult& result);

}  // namespace capsoc::run
