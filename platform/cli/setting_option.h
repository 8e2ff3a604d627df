// Options of the command line that settings declare.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

#include "base/settings.h"

namespace capsoc::cli {

/// Gets a setting's path, the value that the command line has for it, and the option's name.
using TakeOption = std::function<void(const std::string& path, const std::string& value,
                                      const std::string& option)>;

/// Adds the option that the setting declares, which it must have.
void add_setting_option(CLI::App& command, const Setting& setting, TakeOption take);

}  // namespace capsoc::cli
