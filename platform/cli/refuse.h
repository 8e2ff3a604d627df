// How a command says that it cannot do what it was asked for.
#pragma once

#include <string>

#include "host/console.h"
#include "results/results.h"

namespace capsoc::cli {

inline int refuse(const std::string& text, int code = run::exit_code::usage) {
  host::say("capsoc: {}\n", text);
  return code;
}

}  // namespace capsoc::cli
