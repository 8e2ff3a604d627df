// The function profile as files that other tools read.
#pragma once

#include <string>

#include "trace/call_tree.h"
#include "trace/functions.h"

namespace capsoc::trace {

/// Callgrind's profile format 1: costs by instruction address, calls with their inclusive costs;
/// events Cycles and Instructions. For kcachegrind and callgrind_annotate.
std::string to_callgrind(const CallTree& tree, Functions& functions, const std::string& program);

/// One line for each call path with its own cycles, "main;work;fetch 1234": for flame graphs.
std::string to_folded(const CallTree& tree, const Functions& functions);

}  // namespace capsoc::trace
