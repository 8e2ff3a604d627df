// Parameters from a file, for a SoC that starts in calibration mode.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "base/result.h"
#include "loader/elf_image.h"
#include "metrics/metrics.h"

namespace capsoc::metrics {

/// Reads the words of `parameters` from a JSON file that `capsoc fit` or `capsoc run --json` wrote.
/// Every parameter has to have its word and its value, and they have to agree to the last place.
Result<ParameterWords> read_parameters(const std::string& path);

/// Nodes of the coprocessor's harmonic correction, 2^-24 turn, within 20 bits.
using ErrorTable = std::array<int32_t, 128>;

/// Reads `error_table` of a file that `capsoc fit --use-angle` wrote. Nothing: the file has none.
Result<std::optional<ErrorTable>> read_error_table(const std::string& path);

/// Writes it in the program's object `calibration_table` (the same header). Error: the program has
/// no such place.
std::optional<Error> write_in_program(loader::ElfImage& image, const ErrorTable& table);

/// Writes them in the program, where firmware/apps/common/parameter_block.h has its object
/// `calibration_parameters`. Error: the program has no such place.
std::optional<Error> write_in_program(loader::ElfImage& image, const ParameterWords& words);

}  // namespace capsoc::metrics
