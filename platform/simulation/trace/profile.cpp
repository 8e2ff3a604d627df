#include "trace/profile.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <tuple>
#include <vector>

namespace capsoc::trace {
namespace {

/// What a function's record in the file holds.
struct Record {
  std::map<uint32_t, Cost> lines;
  std::vector<std::pair<CallTree::Edge, CallTree::Calls>> calls;
};

/// "(3) name" where a name comes first, "(3)" from then on (name compression).
class Names {
 public:
  std::string operator()(const std::string& name) {
    const auto [found, added] = numbers_.try_emplace(name, numbers_.size() + 1);
    return added ? fmt::format("({}) {}", found->second, name) : fmt::format("({})", found->second);
  }

 private:
  std::map<std::string, std::size_t> numbers_;
};

/// The same for functions, which may share a name.
class FunctionNames {
 public:
  explicit FunctionNames(const Functions& functions) : functions_(functions) {}
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

/// Writes the records one after the other.
class CallgrindText {
 public:
  CallgrindText(Functions& functions, const LineOf& line_of)
      : functions_(functions), line_of_(line_of), function_name_(functions) {}

  void add(uint32_t function, const Record& record) {
    file_ = file_of(function);
    text_ += fmt::format("\nfl={}\nfn={}\n", file_name_(file_), function_name_(function));
    for (const auto& [address, cost] : record.lines) {
      const source::SourceLine line = line_at(address);
      go_to(line.file);
      text_ += fmt::format("{:#x} {} {} {}\n", address, line.line, cost.cycles, cost.instructions);
      sum_ += cost;
    }
    for (const auto& [edge, calls] : record.calls) add(edge, calls);
  }
  const std::string& text() const { return text_; }
  const Cost& sum() const { return sum_; }

 private:
  void add(const CallTree::Edge& edge, const CallTree::Calls& calls) {
    const source::SourceLine line = line_at(edge.site);
    const uint32_t target = functions_[edge.callee].address;
    go_to(line.file);
    text_ += fmt::format("cfi={}\ncfn={}\n", file_name_(file_of(edge.callee)),
                         function_name_(edge.callee));
    text_ += fmt::format("calls={} {:#x} {}\n", calls.count, target, line_at(target).line);
    text_ += fmt::format("{:#x} {} {} {}\n", edge.site, line.line, calls.inclusive.cycles,
                         calls.inclusive.instructions);
  }
  source::SourceLine line_at(uint32_t address) const {
    return line_of_(address).value_or(source::SourceLine{unknown_file, 0});
  }
  std::string file_of(uint32_t function) const {
    return line_at(functions_[function].address).file;
  }
  /// Lines of another file are inside an inlined function of it.
  void go_to(const std::string& file) {
    if (file == file_) return;
    file_ = file;
    text_ += fmt::format("fi={}\n", file_name_(file));
  }

  static constexpr const char* unknown_file = "???";
  Functions& functions_;
  const LineOf& line_of_;
  FunctionNames function_name_;
  Names file_name_;
  std::string file_, text_;
  Cost sum_;
};

}  // namespace

std::string to_callgrind(const CallTree& tree, Functions& functions, const std::string& program,
                         const LineOf& line_of) {
  CallgrindText body(functions, line_of);
  for (const auto& [function, record] : records_of(tree, functions)) body.add(function, record);
  return fmt::format(
             "# callgrind format\nversion: 1\ncreator: capsoc\npid: 1\ncmd: {}\npart: 1\n\n"
             "positions: instr line\nevents: Cycles Instructions\nsummary: {} {}\n\nob={}\n",
             program, body.sum().cycles, body.sum().instructions, program) +
         body.text() + fmt::format("\ntotals: {} {}\n", body.sum().cycles, body.sum().instructions);
}

std::vector<FunctionCost> top_functions(const CallTree& tree, Functions& functions,
                                        std::size_t count) {
  std::map<uint32_t, Cost> costs;
  for (const auto& [address, cost] : tree.by_address()) costs[functions.at(address)] += cost;
  for (const auto& [name, cost] : tree.by_name()) costs[name] += cost;
  std::vector<FunctionCost> top;
  top.reserve(costs.size());
  for (const auto& [function, cost] : costs) top.push_back({functions[function].name, cost});
  std::sort(top.begin(), top.end(), [](const FunctionCost& a, const FunctionCost& b) {
    return std::tie(b.cost.cycles, a.name) < std::tie(a.cost.cycles, b.name);
  });
  if (top.size() > count) top.resize(count);
  return top;
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
