// The files of a run.
#pragma once

#include <vector>

#include "host/file_uses.h"

namespace capsoc::run {

class RunSettings;

/// Every file that these settings make a run read or write, for host::check_uses(). What the
/// semihosting directory holds is the program's affair.
std::vector<host::FileUse> files_of(const RunSettings& settings);

}  // namespace capsoc::run
