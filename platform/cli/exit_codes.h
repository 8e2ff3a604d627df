// The exit codes as --help and the man pages tell them.
#pragma once

#include <array>

namespace capsoc::cli {

struct ExitCodeText {
  const char* code;
  const char* meaning;
};

inline constexpr std::array<ExitCodeText, 10> exit_codes = {{
    {"0", "pass"},
    {"1", "the firmware or a test failed"},
    {"2", "a wrong option or input"},
    {"3", "samples from which no sensor can be identified"},
    {"4", "model and RTL of the coprocessor differ"},
    {"5", "the firmware crashed"},
    {"70", "internal error"},
    {"74", "all went well, but an output did not take everything"},
    {"124", "a limit was hit"},
    {"128+n", "ended by signal n"},
}};

}  // namespace capsoc::cli
