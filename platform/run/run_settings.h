// The settings of a run.
#pragma once

#include <string>

#include "support/settings.h"

namespace capsoc::run {

/// Every setting of a run with its built-in value.
Settings make_settings();

/// A command line that gives the same run.
std::string reproducing_command(const Settings& settings);

}  // namespace capsoc::run
