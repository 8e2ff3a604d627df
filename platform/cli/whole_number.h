// What a number on the command line may be.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>

namespace capsoc::cli {

/// A whole number within bounds, decimal or 0x.. CLI11 alone would take -5 for 2^64 - 5 and 010 for
/// 8, so this also writes it again, for Option::transform().
CLI::Validator whole_number(uint64_t least, uint64_t greatest);

/// A number within bounds; neither "nan" nor "inf" is one.
CLI::Validator real_number(double least, double greatest);

/// A text that says something: a file that an empty variable of a script was to name.
CLI::Validator not_empty();

}  // namespace capsoc::cli
