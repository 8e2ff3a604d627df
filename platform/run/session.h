// One run of the SoC from settings to result.
#pragma once

#include "run/results.h"
#include "support/result.h"
#include "support/settings.h"

namespace capsoc::run {

/// Every setting of a run with its built-in value.
Settings make_settings();

/// Builds the platform, runs the firmware to its end or a limit, and says what came out. An Error
/// is a wrong input: nothing was simulated and nothing written. One run a process: SystemC's kernel
/// cannot be started twice.
Result<RunResult> run(const Settings& settings);

/// The folder of the program itself, where the built firmware and the traces are found.
std::string program_folder();

}  // namespace capsoc::run
