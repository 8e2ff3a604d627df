// When a program has nothing left to do (run.end_on_idle).
#pragma once

#include "soc/soc.h"

namespace capsoc::run {

/// Lets the processor end the simulation after it was idle for `seconds` of simulated time; 0:
/// never. docs/guide/bringup.md has the rule.
void end_on_idle(double seconds, soc::Soc& soc);

}  // namespace capsoc::run
