// What an application of CLI11 declares, as data.
#pragma once

#include <CLI/CLI.hpp>

#include "manual/command.h"

namespace capsoc::cli {

/// `app` and all its visible subcommands and options. Reads declarations only; not const because
/// CLI11's validators cannot be asked otherwise.
manual::Command command_tree(CLI::App& app);

}  // namespace capsoc::cli
