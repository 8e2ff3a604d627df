// What kinds of work do with their settings.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "base/settings.h"
#include "campaign/axis.h"
#include "session/run_settings.h"

namespace capsoc::campaign {

/// Error: one that does not exist, cannot have its value, or says where something goes.
std::optional<Error> set_all(const std::vector<Assignment>& assignments, Settings& settings);

/// A line for each setting that bears on a result; input files are for input_identity().
std::string settings_identity(const Settings& settings);

/// A line for a file that is read: its hash, wherever it lies. What is no file (a built-in sensor)
/// is part of the program and counts by its name. A file is hashed once a process.
std::string input_identity(const std::string& path);

/// Both of `capsoc run`.
std::string run_identity(const run::RunSettings& settings);

}  // namespace capsoc::campaign
