// The settings of the program that runs on the processor: `program.NAME`, short `-P NAME`.
#pragma once

#include <string>

#include "base/result.h"
#include "inputs/input_settings.h"
#include "loader/program_settings.h"

namespace capsoc::run {

/// Writes those that were set in the image and returns all of them. An Error is one that the
/// program does not have or that it does not take.
Result<loader::ProgramSettings> change_program(const FirmwareSettings& settings,
                                               loader::ElfImage& image);

/// All settings of the program of a run, a line each: value, unit, range, where the value is from.
Result<std::string> list_program_settings(const FirmwareSettings& settings);

}  // namespace capsoc::run
