#include "coprocessor/signal_flow.h"

#include <algorithm>
#include <array>
#include <functional>
#include <set>
#include <utility>

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

// The sources that count, each once.
std::vector<std::string> sources_in(std::string_view line, bool is_watched) {
  std::vector<std::string> sources;
  for (std::string& source : split(line, ' ')) {
    if (source.back() == '?') {
      if (!is_watched) continue;
      source.pop_back();
    }
    if (std::find(sources.begin(), sources.end(), source) == sources.end())
      sources.push_back(std::move(source));
  }
  return sources;
}

std::vector<MadeFrom> flow_of(Arithmetic arithmetic, bool is_watched) {
  std::vector<MadeFrom> flow(node_count);
  for (const Line& line : lines) {
    const std::size_t index = node_index(line.node).value();
    const bool is_paper = arithmetic == Arithmetic::paper && !line.paper.empty();
    flow[index] = {&node_names()[index],
                   sources_in(is_paper ? line.paper : line.precise, is_watched)};
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

const std::vector<MadeFrom>& signal_flow(Arithmetic arithmetic, bool is_watched) {
  using Flows = std::array<std::vector<MadeFrom>, 2>;  // without and with the safety mechanisms
  static const Flows precise = {flow_of(Arithmetic::precise, false),
                                flow_of(Arithmetic::precise, true)};
  static const Flows paper = {flow_of(Arithmetic::paper, false), flow_of(Arithmetic::paper, true)};
  return (arithmetic == Arithmetic::paper ? paper : precise)[is_watched ? 1 : 0];
}

Origin origin_of(std::size_t node, Arithmetic arithmetic, bool is_watched) {
  const std::vector<MadeFrom>& flow = signal_flow(arithmetic, is_watched);
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
