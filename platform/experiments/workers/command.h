// A program of the user, run to its end by the shell.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/result.h"

namespace capsoc::workers {

using Variables = std::vector<std::pair<std::string, std::string>>;

struct CommandEnd {
  int code = 0;        ///< as the shell has it: 128 + n for signal n
  std::string output;  ///< of its standard output
};

/// `/bin/sh -c LINE` with these variables next to those of this process, and with its stderr and
/// its limits. The shell ends with this process. Error: there is no shell, or more than 16 MiB of
/// output.
Result<CommandEnd> run_command(const std::string& line, const Variables& variables);

/// What the shell says against a line, which is not run.
std::optional<Error> check_command(const std::string& line);

}  // namespace capsoc::workers
