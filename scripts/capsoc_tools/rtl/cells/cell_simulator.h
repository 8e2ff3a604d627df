// A netlist of cells with truth tables, flip-flops of one clock, and memories with one reading and
// one writing port. Simulated by events, with counted edges of every net (scripts/tool power).
#pragma once
#include <cstdint>
#include <fstream>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

/// Edges of one net since start(). `high` and `since` are in half clocks.
struct Edges {
  uint64_t rises = 0, falls = 0, high = 0, since = 0;
};

/// Reads the table that netlist.py writes. Nets 0 and 1 are constants. All nets begin at 0. The
/// reset has to last over a clock edge, for it acts there.
class CellSimulator {
 public:
  /// unit_delay: every cell takes the same time, so nets can glitch; else each net changes once
  /// after an edge. Throws std::runtime_error: no such file, or a loop of cells.
  CellSimulator(const std::string& table, bool unit_delay) : unit_delay_(unit_delay) {
    read(table);
    level();
    for (std::size_t i = 0; i < nodes_.size(); ++i) touch(static_cast<uint32_t>(i));
    settle();
  }

  const std::vector<uint32_t>& port(const std::string& name) const { return ports_.at(name); }

  void set(const std::vector<uint32_t>& port, uint32_t value) {
    for (std::size_t i = 0; i < port.size(); ++i) change(port[i], value >> i & 1);
  }
  uint32_t get(const std::vector<uint32_t>& port) const {
    uint32_t value = 0;
    for (std::size_t i = 0; i < port.size(); ++i) value |= uint32_t{values_[port[i]]} << i;
    return value;
  }

  /// Lets changes pass until no net changes any more.
  void settle() {
    if (unit_delay_) {
      pass_with_delay();
    } else {
      pass_by_level();
    }
  }

  /// A rising edge of the clock: flip-flops and memories take what is there, without settle().
  void clock() {
    next_.clear();
    for (const FlipFlop& flop : flops_) {
      const bool value = values_[flop.clear] && (!values_[flop.preset] || values_[flop.data]);
      if (value != values_[flop.output]) next_.emplace_back(flop.output, value);
    }
    for (Memory& memory : memories_) {
      if (memory.clocked && values_[memory.read_enable]) {
        const auto& word = memory.words[get(memory.read_address)];
        for (std::size_t i = 0; i < word.size(); ++i)
          next_.emplace_back(memory.read_data[i], word[i]);
      }
    }
    for (Memory& memory : memories_) write(memory);
    for (const auto& [net, value] : next_) change(net, value);
  }

  /// Counts from here.
  void start() {
    edges_.assign(values_.size(), {});
    now_ = changed_ = 0;
    for (Memory& memory : memories_) memory.writes = memory.reads = 0;
    counting_ = true;
  }
  void half_clock() { now_ += counting_; }
  /// Edges of all nets since start().
  uint64_t changed() const { return changed_; }
  std::size_t nets() const { return values_.size(); }
  Edges edges(std::size_t net) const {
    Edges edges = edges_[net];
    if (values_[net]) edges.high += now_ - edges.since;
    return edges;
  }
  std::size_t memories() const { return memories_.size(); }
  /// Words written, and changes of the word read, since start().
  std::pair<uint64_t, uint64_t> accesses(std::size_t memory) const {
    return {memories_[memory].writes, memories_[memory].reads};
  }

 private:
  // A cell's output, or (truth < 0) the reading port of memory -truth - 1.
  struct Node {
    int32_t truth = 0;
    uint32_t level = 0, output = 0;
    std::vector<uint32_t> inputs;
  };
  struct FlipFlop {
    uint32_t output, data, clear, preset;
  };
  struct Memory {
    bool clocked = false;
    uint32_t read_enable = 0, node = 0;
    std::vector<uint32_t> read_address, read_data, write_address, write_data, write_enable;
    std::vector<std::vector<uint8_t>> words;
    uint64_t writes = 0, reads = 0;
  };

  static std::vector<uint32_t> nets_of(std::istream& in) {
    std::size_t count = 0;
    in >> count;
    std::vector<uint32_t> nets(count);
    for (uint32_t& net : nets) in >> net;
    return nets;
  }

  void read(const std::string& table) {
    std::ifstream in(table);
    std::size_t count = 0;
    if (!(in >> count)) throw std::runtime_error("cannot read " + table);
    values_.assign(count, 0);
    values_[1] = 1;
    for (std::string word; in >> word;) {
      if (word == "port") {
        in >> word;
        ports_[word] = nets_of(in);
      } else if (word == "cell") {
        Node node;
        in >> node.truth >> node.output;
        node.inputs = nets_of(in);
        nodes_.push_back(node);
      } else if (word == "flop") {
        FlipFlop flop{};
        in >> flop.output >> flop.data >> flop.clear >> flop.preset;
        flops_.push_back(flop);
      } else {
        Memory memory;
        std::size_t width = 0, size = 0;
        in >> width >> size >> memory.clocked >> memory.read_enable;
        for (auto* nets : {&memory.read_address, &memory.read_data, &memory.write_address,
                           &memory.write_data, &memory.write_enable}) {
          *nets = nets_of(in);
        }
        memory.words.assign(std::size_t{1} << memory.read_address.size(),
                            std::vector<uint8_t>(width));
        if (memory.words.size() < size)
          throw std::runtime_error("a memory has more words than addresses");
        memories_.push_back(memory);
      }
    }
    for (std::size_t i = 0; i < memories_.size(); ++i) {
      if (memories_[i].clocked) continue;
      memories_[i].node = static_cast<uint32_t>(nodes_.size());
      nodes_.push_back({-1 - static_cast<int32_t>(i), 0, 0, memories_[i].read_address});
    }
  }

  std::vector<uint32_t> outputs_of(const Node& node) const {
    if (node.truth >= 0) return {node.output};
    return memories_[static_cast<std::size_t>(-1 - node.truth)].read_data;
  }

  void level() {
    readers_.assign(values_.size(), {});
    std::vector<uint8_t> driven(values_.size());
    for (uint32_t i = 0; i < nodes_.size(); ++i) {
      for (const uint32_t net : nodes_[i].inputs) readers_[net].push_back(i);
      for (const uint32_t net : outputs_of(nodes_[i])) driven[net] = 1;
    }
    std::vector<uint32_t> waits(nodes_.size()), ready;
    for (uint32_t i = 0; i < nodes_.size(); ++i) {
      for (const uint32_t net : nodes_[i].inputs) waits[i] += driven[net];
      if (waits[i] == 0) ready.push_back(i);
    }
    std::size_t deepest = 0;
    for (std::size_t done = 0; done < ready.size(); ++done) {
      const Node& node = nodes_[ready[done]];
      deepest = node.level > deepest ? node.level : deepest;
      for (const uint32_t net : outputs_of(node)) {
        for (const uint32_t reader : readers_[net]) {
          if (nodes_[reader].level <= node.level) nodes_[reader].level = node.level + 1;
          if (--waits[reader] == 0) ready.push_back(reader);
        }
      }
    }
    if (ready.size() != nodes_.size()) throw std::runtime_error("the netlist has a loop of cells");
    waiting_.resize(deepest + 1);
    is_waiting_.assign(nodes_.size(), 0);
  }

  void touch(uint32_t node) {
    if (is_waiting_[node]) return;
    is_waiting_[node] = 1;
    (unit_delay_ ? touched_ : waiting_[nodes_[node].level]).push_back(node);
  }

  void change(uint32_t net, bool value) {
    if (values_[net] == static_cast<uint8_t>(value)) return;
    values_[net] = value;
    for (const uint32_t reader : readers_[net]) touch(reader);
    if (!counting_) return;
    Edges& edges = edges_[net];
    ++changed_;
    if (value) {
      ++edges.rises;
      edges.since = now_;
    } else {
      ++edges.falls;
      edges.high += now_ - edges.since;
    }
  }

  // Puts what the node drives now into next_, if it differs.
  void evaluate(uint32_t number) {
    const Node& node = nodes_[number];
    is_waiting_[number] = 0;
    if (node.truth < 0) {
      Memory& memory = memories_[static_cast<std::size_t>(-1 - node.truth)];
      const auto& word = memory.words[get(memory.read_address)];
      memory.reads += counting_;
      for (std::size_t i = 0; i < word.size(); ++i)
        next_.emplace_back(memory.read_data[i], word[i]);
      return;
    }
    unsigned place = 0;
    for (std::size_t i = 0; i < node.inputs.size(); ++i)
      place |= unsigned{values_[node.inputs[i]]} << i;
    const bool value = node.truth >> place & 1;
    if (value != values_[node.output]) next_.emplace_back(node.output, value);
  }

  void pass_by_level() {
    for (auto& nodes : waiting_) {
      for (const uint32_t node : nodes) {
        next_.clear();
        evaluate(node);
        for (const auto& [net, value] : next_) change(net, value);
      }
      nodes.clear();
    }
  }

  void pass_with_delay() {
    while (!touched_.empty()) {
      next_.clear();
      turn_.swap(touched_);
      for (const uint32_t node : turn_) evaluate(node);
      turn_.clear();
      for (const auto& [net, value] : next_) change(net, value);
    }
  }

  void write(Memory& memory) {
    auto& word = memory.words[get(memory.write_address)];
    bool written = false;
    for (std::size_t i = 0; i < word.size(); ++i) {
      if (!values_[memory.write_enable[i]]) continue;
      word[i] = values_[memory.write_data[i]];
      written = true;
    }
    memory.writes += written && counting_;
    if (written && !memory.clocked) touch(memory.node);
  }

  bool unit_delay_, counting_ = false;
  std::vector<uint8_t> values_, is_waiting_;
  std::map<std::string, std::vector<uint32_t>> ports_;
  std::vector<Node> nodes_;
  std::vector<FlipFlop> flops_;
  std::vector<Memory> memories_;
  std::vector<std::vector<uint32_t>> readers_, waiting_;
  std::vector<uint32_t> touched_, turn_;
  std::vector<std::pair<uint32_t, bool>> next_;
  std::vector<Edges> edges_;
  uint64_t now_ = 0, changed_ = 0;
};
