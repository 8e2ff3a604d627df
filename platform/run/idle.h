// When a program has nothing left to do (run.end_on_idle).
#pragma once

#include "soc/soc.h"
#include "support/settings.h"

namespace capsoc::run {

void add_idle_settings(Settings& settings);

/// Lets the processor end the simulation as the setting says; docs/bringup.md has the rule.
void watch_for_idle(const Settings& settings, soc::Soc& soc);

}  // namespace capsoc::run
