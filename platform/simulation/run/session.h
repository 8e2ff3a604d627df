// One run of the SoC from settings to result.
#pragma once

#include "run/results.h"
#include "support/result.h"

namespace capsoc::run {

class RunSettings;

/// Builds the platform, runs the firmware to its end or a limit, and says what came out. An Error
/// is a wrong input: nothing was simulated and nothing written. One run a process: SystemC's kernel
/// cannot be started twice.
Result<RunResult> run(const RunSettings& settings);

}  // namespace capsoc::run
