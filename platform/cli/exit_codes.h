// The exit codes as --help and the man pages tell them.
#pragma once

#include <string>
#include <vector>

#include "results/exit_codes.h"

namespace capsoc::cli {

struct ExitCodeText {
  std::string code, meaning;
};

inline std::vector<ExitCodeText> exit_codes() {
  std::vector<ExitCodeText> all;
  for (const run::exit_code::Text& text : run::exit_code::texts)
    all.push_back({std::to_string(text.code), text.meaning});
  all.push_back({std::to_string(run::exit_code::signal_base) + "+n", "ended by signal n"});
  return all;
}

}  // namespace capsoc::cli
