// Exit codes of the program, out of exit_codes.def.
#pragma once

namespace capsoc::run::exit_code {

enum : int {
#define EXIT_CODE(name, number, text) name = (number),
#include "results/exit_codes.def"
#undef EXIT_CODE
  signal_base = 128  ///< + signal number
};

struct Text {
  int code;
  const char* meaning;
};

/// Those that no signal makes, in order.
inline constexpr Text texts[] = {
#define EXIT_CODE(name, number, text) {(number), (text)},
#include "results/exit_codes.def"
#undef EXIT_CODE
};

}  // namespace capsoc::run::exit_code
