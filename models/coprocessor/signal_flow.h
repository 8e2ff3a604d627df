// What each node of a sample is made from (coprocessor/signal_flow.def), for questions about a
// value: which values made it, back to the sample and the registers.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "coprocessor/nodes.h"
#include "coprocessor/types.h"

namespace capsoc::coprocessor {

/// One line of the table.
struct MadeFrom {
  const NamedNode* node = nullptr;
  std::vector<std::string> sources;  ///< nodes of the same sample, and inputs (signal_flow.def)
};

/// In the order of node_names(). `is_watched`: a safety mechanism is on, or its flag is set.
const std::vector<MadeFrom>& signal_flow(Arithmetic arithmetic, bool is_watched);

/// The index of a node in node_names(); nothing: there is none of that name.
std::optional<std::size_t> node_index(std::string_view name);

/// What a node was made from, directly or not.
struct Origin {
  std::vector<std::size_t> nodes;   ///< of the same sample, each before its sources
  std::vector<std::string> inputs;  ///< in the order in which the nodes name them
};
Origin origin_of(std::size_t node, Arithmetic arithmetic, bool is_watched);

}  // namespace capsoc::coprocessor
