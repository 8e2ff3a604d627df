// The settings of a run.
#pragma once

#include <string>

#include "support/settings.h"

namespace capsoc::run {

/// Every setting of a run with its built-in value.
Settings make_settings();

/// The folder of the program itself, where the built firmware and the traces are found.
std::string program_folder();

/// The path of a file that comes with the program: built firmware and traces lie beside it or one
/// level up. Where it should be if it is missing.
std::string installed(const std::string& relative);

/// A command line that gives the same run.
std::string reproducing_command(const Settings& settings);

}  // namespace capsoc::run
