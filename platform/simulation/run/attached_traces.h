// The traces and the coverage that the settings ask for.
#pragma once

#include <memory>

#include "run/program_view.h"
#include "support/result.h"
#include "trace/coverage.h"
#include "trace/tracer.h"

namespace capsoc::run {

class RunSettings;

/// What they ask for, attached, or null. The waves of a run with the model alone are the SoC's, so
/// results.waves names them, too. An Error as Tracer::attach() has it.
Result<std::unique_ptr<trace::Tracer>> attach_tracer(const RunSettings& settings,
                                                     const ProgramView& view);

/// The same for the coverage.
Result<std::unique_ptr<trace::Coverage>> attach_coverage(const RunSettings& settings,
                                                         const ProgramView& view);

/// Behind both: a warning for each part of the debug information that they could not read.
void warn_of_missing_lines(const RunSettings& settings, const ProgramView& view);

}  // namespace capsoc::run
