// The settings of the traces.
#pragma once

#include <memory>
#include <vector>

#include "support/result.h"
#include "support/settings.h"
#include "trace/tracer.h"

namespace capsoc::run {

/// Adds the settings trace.*.
void add_trace_settings(Settings& settings);

/// What they ask for, attached, or null. The waves of a run with the model alone are the SoC's, so
/// results.waves names them, too. An Error as Tracer::attach() has it.
Result<std::unique_ptr<trace::Tracer>> attach_tracer(
    const Settings& settings, soc::Soc& soc, const loader::ElfImage& program,
    const std::vector<loader::ElfImage>& further_images);

}  // namespace capsoc::run
