// Why an exception that waits is not taken.
#pragma once

#include <string>

#include "soc/soc.h"

namespace capsoc::run {

/// A line for each pending exception with the reason for which the processor does not take it,
/// indented by four; "" if none is pending.
std::string describe_pending(const soc::Soc& soc);

/// The priority that code has in addition to its faults, in words: what masks it, or which
/// exception runs.
std::string describe_priority(const soc::Soc& soc);

}  // namespace capsoc::run
