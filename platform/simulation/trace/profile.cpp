#include "trace/profile.h"

#include <fmt/format.h>

#include <map>
#include <set>
#include <vector>

namespace capsoc::trace {
namespace {

/// What a function's record in the file holds.
struct Record {
  std::map<uint32_t, Cost> lines;
  std::vector<std::pair<CallTree::Edge, CallTree::Calls>> calls;
};

/// "(3) name" where a function is named first, "(3)" from then on (name compression).
class Names {
 public:
  explicit Names(const Functions& functions) : functions_(functions) {}
  std::string operator()(uint32_t function) {
    if (!named_.insert(function).second) return fmt::format("({})", function + 1);
    return fmt::format("({}) {}", function + 1, functions_[function].name);
  }

 private:
  const Functions& functions_;
  std::set<uint32_t> named_;
};

std::map<uint32_t, Record> records_of(const CallTree& tree, Functions& functions) {
  std::map<uint32_t, Record> records;
  for (const auto& [address, cost] : tree.by_address())
    records[functions.at(address)].lines[address] += cost;
  for (const auto& [name, cost] : tree.by_name()) records[name].lines[0] += cost;
  for (const auto& [edge, calls] : tree.calls())
    records[edge.caller].calls.emplace_back(edge, calls);
  return records;
}

}  // namespace

std::string to_callgrind(const CallTree& tree, Functions& functions, const std::string& program) {
  const std::map<uint32_t, Record> records = records_of(tree, functions);
  Cost sum;
  std::string body;
  Names name(functions);
  for (const auto& [function, record] : records) {
    body += fmt::format("\nfn={}\n", name(function));
    for (const auto& [address, cost] : record.lines) {
      body += fmt::format("{:#x} {} {}\n", address, cost.cycles, cost.instructions);
      sum += cost;
    }
    for (const auto& [edge, calls] : record.calls) {
      body += fmt::format("cfn={}\n", name(edge.callee));
      body += fmt::format("calls={} {:#x}\n", calls.count, functions[edge.callee].address);
      body += fmt::format("{:#x} {} {}\n", edge.site, calls.inclusive.cycles,
                          calls.inclusive.instructions);
    }
  }
  return fmt::format(
             "# callgrind format\nversion: 1\ncreator: capsoc\npid: 1\ncmd: {}\npart: 1\n\n"
             "positions: instr\nevents: Cycles Instructions\nsummary: {} {}\n\nob={}\nfl=???\n",
             program, sum.cycles, sum.instructions, program) +
         body + fmt::format("\ntotals: {} {}\n", sum.cycles, sum.instructions);
}

std::string to_folded(const CallTree& tree, const Functions& functions) {
  std::string text;
  tree.each_path([&](const std::vector<uint32_t>& path, const Cost& self) {
    for (std::size_t i = 0; i < path.size(); ++i)
      text += (i == 0 ? "" : ";") + functions[path[i]].name;
    text += fmt::format(" {}\n", self.cycles);
  });
  return text;
}

}  // namespace capsoc::trace
