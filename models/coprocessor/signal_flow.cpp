#include "coprocessor/signal_flow.h"

#include <algorithm>
#include <functional>
#include <set>

#include "base/split.h"

namespace capsoc::coprocessor {
namespace {

struct Line {
  std::string_view node, precise, paper;
};

constexpr Line lines[] = {
#define MADE_FROM(node, precise, paper) {#node, precise, paper},
#include "coprocessor/signal_flow.def"
};

std::vector<MadeFrom> flow_of(Arithmetic arithmetic) {
  std::vector<MadeFrom> flow(node_count);
  for (const Line& line : lines) {
    const std::size_t index = node_index(line.node).value();
    const bool is_paper = arithmetic == Arithmetic::paper && !line.paper.empty();
    flow[index] = {&node_names()[index], split(is_paper ? line.paper : line.precise, ' ')};
  }
  return flow;
}

}  // namespace

std::optional<std::size_t> node_index(std::string_view name) {
  const auto& names = node_names();
  const auto* const found = std::find_if(
      names.begin(), names.end(), [name](const NamedNode& node) { return node.name == name; });
  if (found == names.end()) return std::nullopt;
  return static_cast<std::size_t>(found - names.begin());
}

const std::vector<MadeFrom>& signal_flow(Arithmetic arithmetic) {
  static const std::vector<MadeFrom> precise = flow_of(Arithmetic::precise);
  static const std::vector<MadeFrom> paper = flow_of(Arithmetic::paper);
  return arithmetic == Arithmetic::paper ? paper : precise;
}

Origin origin_of(std::size_t node, Arithmetic arithmetic) {
  const std::vector<MadeFrom>& flow = signal_flow(arithmetic);
  Origin origin;
  std::set<std::size_t> known;
  const std::function<void(std::size_t)> visit = [&](std::size_t at) {
    if (!known.insert(at).second) return;
    for (const std::string& source : flow[at].sources)
      if (const auto index = node_index(source)) visit(*index);
    origin.nodes.push_back(at);
  };
  visit(node);
  std::reverse(origin.nodes.begin(), origin.nodes.end());
  for (const std::size_t each : origin.nodes)
    for (const std::string& source : flow[each].sources)
      if (!node_index(source) &&
          std::find(origin.inputs.begin(), origin.inputs.end(), source) == origin.inputs.end())
        origin.inputs.push_back(source);
  return origin;
}

}  // namespace capsoc::coprocessor
