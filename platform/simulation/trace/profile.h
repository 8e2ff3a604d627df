// The function profile as files that other tools read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "source/debug_information.h"
#include "trace/call_tree.h"
#include "trace/functions.h"

namespace capsoc::trace {

/// The line of source of an instruction, nothing where it is not known.
using LineOf = std::function<std::optional<source::SourceLine>(uint32_t address)>;

/// Callgrind's profile format 1: costs by instruction address and line of source, calls with their
/// inclusive costs; events Cycles and Instructions. For kcachegrind and callgrind_annotate.
std::string to_callgrind(const CallTree& tree, Functions& functions, const std::string& program,
                         const LineOf& line_of);

/// What a function took itself, without what it called.
struct FunctionCost {
  std::string name;
  Cost cost;
};

/// The functions that took the most cycles, in that order, equal ones by name; at most `count`.
std::vector<FunctionCost> top_functions(const CallTree& tree, Functions& functions,
                                        std::size_t count);

/// One line for each call path with its own cycles, "main;work;fetch 1234": for flame graphs.
std::string to_folded(const CallTree& tree, const Functions& functions);

}  // namespace capsoc::trace
