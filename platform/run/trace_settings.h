// The settings of the traces.
#pragma once

#include "support/settings.h"
#include "trace/tracer.h"

namespace capsoc::run {

/// Adds the settings trace.*.
void add_trace_settings(Settings& settings);

/// What they ask for. The waves of a run with the model alone are the SoC's, so results.waves names
/// them, too.
trace::TraceOptions trace_options(const Settings& settings);

}  // namespace capsoc::run
