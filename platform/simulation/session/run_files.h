// The files of a run.
#pragma once

#include <vector>

#include "base/result.h"
#include "host/file_uses.h"
#include "inputs/input_file.h"
#include "inputs/run_inputs.h"

namespace capsoc::run {

class RunSettings;

/// What the settings make a run read before it begins. An Error as read_inputs() of its parts has
/// it, or two readers of standard input.
Result<RunInputs> read_inputs(const RunSettings& settings);

/// Every file that a run reads and that counts, with its hash.
std::vector<Input> input_files(const RunSettings& settings, const RunInputs& inputs);

/// Every file that these settings make a run read or write, for host::check_uses(). The contents of
/// the semihosting directory are not checked: the program alone uses them.
std::vector<host::FileUse> files_of(const RunSettings& settings);

}  // namespace capsoc::run
