// Which program a run has, and what its file holds.
#pragma once

#include <string>

#include "loader/elf_image.h"
#include "support/result.h"

namespace capsoc::run {

class RunSettings;

/// The program: of the settings, or the one that has a place for parameters from outside.
std::string program_of(const RunSettings& settings);

/// The program of a run as its file has it.
Result<loader::ElfImage> read_program(const RunSettings& settings);

}  // namespace capsoc::run
