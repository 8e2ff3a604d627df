#include "rtl/lockstep.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <deque>
#include <utility>
#include <vector>

#include "capsoc_registers.h"
#include "coprocessor/idle_state.h"
#include "coprocessor/register_map.h"
#include "coprocessor/sequencer.h"
#include "rtl/coprocessor_rtl.h"

namespace capsoc::rtl {

using coprocessor::commit_stage;
using coprocessor::Device;
using coprocessor::IdleState;
using coprocessor::NamedNode;
using coprocessor::node_names;
using coprocessor::Nodes;
using coprocessor::RegisterAccess;
using coprocessor::stage_count;

namespace {

constexpr std::size_t shown_operations = 16;
constexpr std::size_t operations_between_checkpoints = 2048;
// Clocks before and after the difference in the wave file.
constexpr uint64_t cycles_before = 2000;
constexpr uint64_t cycles_after = 64;
// The tick under way, five that empty the pipeline, and the three of the LOAD.
constexpr uint64_t load_ticks = 9;

std::string stage_name(unsigned stage) {
  return stage == commit_stage ? "commit" : fmt::format("T{}", stage);
}

std::string hex(int64_t value) {
  return fmt::format("0x{:x}", static_cast<uint64_t>(value));
}

}  // namespace

std::string register_name(uint32_t offset) {
  for (const auto& entry : registers::coprocessor::table)
    if (entry.offset == offset) return fmt::format("0x{:03x} ({})", offset, entry.name);
  return fmt::format("0x{:03x}", offset);
}

std::string describe(const Operation& o) {
  switch (o.kind) {
    case Operation::Kind::sample:
      return fmt::format("{:>14}  sample      u 0x{:08x} v 0x{:08x}{}{}", o.cycle, o.offset_or_u,
                         o.value_or_v, o.clip ? " clipped" : "",
                         o.channel != 0 ? fmt::format(" of channel {}", o.channel) : "");
    case Operation::Kind::write:
      return fmt::format("{:>14}  write       {} = 0x{:08x}{}", o.cycle,
                         register_name(o.offset_or_u), o.value_or_v,
                         o.strobes == coprocessor::all_strobes
                             ? std::string()
                             : fmt::format(" strobes {:04b}", o.strobes));
    case Operation::Kind::read:
      return fmt::format("{:>14}  read        {}", o.cycle, register_name(o.offset_or_u));
    case Operation::Kind::debug_read:
      return fmt::format("{:>14}  debug read  {}", o.cycle, register_name(o.offset_or_u));
    case Operation::Kind::reset:
      return fmt::format("{:>14}  reset", o.cycle);
  }
  return {};
}

class Lockstep::Pair {
 public:
  Pair(std::unique_ptr<Device> model, std::unique_ptr<Device> rtl)
      : model_(std::move(model)), rtl_(std::move(rtl)) {}

  void reset() {
    close();
    record({Operation::Kind::reset, present_, 0, 0, false});
    model_->reset();
    if (same()) rtl_->reset();
    level_ = false;
    commits_ = 0;
    compare_outputs();
  }

  void run_to(uint64_t cycle) {
    while (present_ < cycle) {
      close();
      const uint64_t stop = std::min(cycle, next_stop());
      checkpoint();
      model_->advance(stop);
      if (same()) rtl_->advance(stop);
      present_ = stop;
      closed_ = false;
    }
  }

  bool submit(unsigned channel, uint64_t cycle, int32_t u, int32_t v, bool clip) {
    open(cycle);
    record({Operation::Kind::sample, present_, static_cast<uint32_t>(u), static_cast<uint32_t>(v),
            clip, channel});
    ++counters_.samples;
    const bool latched = model_->submit_of(channel, present_, u, v, clip);
    if (same()) {
      const bool theirs = rtl_->submit_of(channel, present_, u, v, clip);
      compare("sample taken", latched, theirs);
    }
    return latched;
  }

  bool write(uint64_t cycle, uint32_t offset, uint32_t value, uint8_t strobes) {
    open(last_read_ ? std::max(cycle, *last_read_ + 2) : cycle);
    record({Operation::Kind::write, present_, offset, value, false, 0, strobes});
    ++counters_.writes;
    const bool mapped = model_->write_bytes(present_, offset, value, strobes);
    if (mapped && offset == coprocessor::reg_cmd && (value & coprocessor::cmd_load) != 0)
      load_until_ = present_ + load_ticks * model_->tick();
    if (same()) {
      const bool theirs = rtl_->write_bytes(present_, offset, value, strobes);
      compare("response to the write of " + register_name(offset), mapped, theirs);
    }
    return mapped;
  }

  RegisterAccess read(uint64_t cycle, uint32_t offset, bool debug) {
    run_to(!debug && last_read_ ? std::max(cycle, *last_read_ + 1) : cycle);
    close();
    if (!debug) last_read_ = present_;
    record(
        {debug ? Operation::Kind::debug_read : Operation::Kind::read, present_, offset, 0, false});
    ++counters_.reads;
    const RegisterAccess ours = model_->read(present_, offset, debug);
    if (same()) {
      const RegisterAccess theirs = rtl_->read(present_, offset, debug);
      const std::string what = (debug ? "debug read of " : "read of ") + register_name(offset);
      compare("response to the " + what, ours.ok, theirs.ok);
      compare(what, ours.value, theirs.value);
    }
    return ours;
  }

  /// Nothing more acts at the present edge: compares what it left.
  void close() {
    if (closed_) return;
    closed_ = true;
    compare_outputs();
    compare_commit();
    if (present_ <= load_until_) compare_loaded();
    compare_stages();
  }

  std::string report(const std::string& command, double cycle_ns) const {
    if (!difference_) return "the model and the RTL agree\n";
    const Difference& d = *difference_;
    std::string text = fmt::format(
        "model and RTL differ at cycle {} ({:.9f} s)\n"
        "  what        {}\n"
        "  model       {}\n"
        "  rtl         {}\n"
        "  first node  {}\n",
        d.cycle, static_cast<double>(d.cycle) * cycle_ns * 1e-9, d.what, d.model, d.rtl,
        d.node.empty() ? "none: every node agreed so far" : d.node);
    if (!d.registers.empty()) text += "  registers   " + d.registers + " (model, rtl)\n";
    const auto list = [&](const char* title, const std::deque<Operation>& operations) {
      text += fmt::format("{} (at their edges, the newest last)\n", title);
      for (const Operation& o : operations) text += describe(o) + "\n";
    };
    list("last accesses", accesses_);
    list("last samples", samples_);
    if (!command.empty()) text += fmt::format("to reproduce: {}\n", command);
    return text;
  }

  std::optional<Error> write_waves(const std::string& file) const {
    const Checkpoint& from = older_.model ? older_ : newer_;
    if (!difference_ || !from.model) return std::nullopt;
    const auto model = from.model->clone();
    const auto copy = from.rtl->clone();
    auto* rtl = dynamic_cast<CoprocessorRtl*>(copy.get());
    if (model == nullptr || rtl == nullptr) return std::nullopt;
    std::vector<Operation> operations = from.since;
    if (&from == &older_)
      operations.insert(operations.end(), newer_.since.begin(), newer_.since.end());
    const uint64_t until = difference_->cycle;
    const uint64_t begin = std::max(from.cycle, until > cycles_before ? until - cycles_before : 0);
    uint64_t present = from.cycle;
    bool open = false;
    std::optional<Error> error;
    const auto run = [&](uint64_t cycle) {
      while (present < cycle && !error) {
        Nodes nodes = model->nodes();
        for (unsigned stage = 0; stage < stage_count; ++stage) model->stage_nodes(stage, nodes);
        if (open) rtl->show_model(nodes);
        const bool idle = model->idle() && rtl->idle();
        uint64_t next = present + 1;
        if (idle) next = cycle;
        if (present < begin && !idle) next = std::min(cycle, begin);
        if (next >= begin && !open) {
          error = rtl->open_waves(file);
          open = true;
        }
        model->advance(next);
        rtl->advance(next);
        present = next;
      }
    };
    for (const Operation& o : operations) {
      run(o.cycle);
      replay(*model, o);
      replay(*rtl, o);
    }
    run(until + cycles_after);
    rtl->close_waves();
    return error;
  }

  History history(uint64_t before, uint64_t after, std::size_t most) const {
    const Checkpoint& from = older_.model ? older_ : newer_;
    if (!difference_ || !from.model) return {};
    const auto model = from.model->clone(), rtl = from.rtl->clone();
    if (model == nullptr || rtl == nullptr) return {};
    std::vector<Operation> operations = from.since;
    if (&from == &older_)
      operations.insert(operations.end(), newer_.since.begin(), newer_.since.end());
    const uint64_t until = difference_->cycle;
    History history{std::max(from.cycle, until > before ? until - before : 0), {}};
    std::vector<std::pair<Nodes, Nodes>> clocks;
    uint64_t present = from.cycle;
    const auto run = [&](uint64_t cycle) {
      while (present < cycle) {
        present =
            present < history.first_cycle ? std::min(cycle, history.first_cycle) : present + 1;
        model->advance(present);
        rtl->advance(present);
        if (present < history.first_cycle) continue;
        auto& [ours, theirs] = clocks.emplace_back(model->nodes(), rtl->nodes());
        for (unsigned stage = 0; stage < stage_count; ++stage) {
          model->stage_nodes(stage, ours);
          rtl->stage_nodes(stage, theirs);
        }
      }
    };
    for (const Operation& o : operations) {
      run(o.cycle);
      replay(*model, o);
      replay(*rtl, o);
    }
    run(until + after);
    history.first_cycle = present + 1 - std::min<uint64_t>(clocks.size(), present + 1);
    const auto add = [&](const NamedNode& node) {
      NodeHistory one{node.name, {}, {}};
      for (const auto& [ours, theirs] : clocks) {
        one.model.push_back(node.format.value(ours.*node.value));
        one.rtl.push_back(node.format.value(theirs.*node.value));
      }
      history.nodes.push_back(std::move(one));
    };
    const std::string first = difference_->node.substr(0, difference_->node.find(' '));
    for (const NamedNode& node : node_names())
      if (first == node.name) add(node);
    for (const NamedNode& node : node_names()) {
      if (history.nodes.size() >= most) break;
      const bool differs = std::any_of(clocks.begin(), clocks.end(), [&](const auto& clock) {
        return clock.first.*node.value != clock.second.*node.value;
      });
      if (differs && first != node.name) add(node);
    }
    return history;
  }

  void visit(Archive& archive) {
    close();
    model_->visit(archive);
    rtl_->visit(archive);
    archive("counters", counters_);
    archive("present", present_);
    archive("last_read", last_read_);
    archive("level", level_);
    archive("commits", commits_);
    archive("load_until", load_until_);
    if (archive.loading()) forget();
  }

  bool save_idle(IdleState& state) {
    close();
    return rtl_->channels() == 1 && model_->save_idle(state);
  }

  bool load_idle(const IdleState& state) {
    if (!rtl_->load_idle(state) || !model_->load_idle(state)) return false;
    counters_ = {};
    present_ = state.cycle;
    last_read_.reset();
    level_ = model_->interrupt();
    commits_ = state.nodes.commits;
    load_until_ = 0;
    forget();
    return true;
  }

  /// Call before a side is changed from outside: the recording cannot be replayed over that.
  void open_sides() {
    close();
    forget();
  }

  std::unique_ptr<Device> model_, rtl_;
  std::optional<Difference> difference_;
  std::function<void()> on_difference_;
  Counters counters_;
  uint64_t present_ = 0;

 private:
  struct Checkpoint {
    uint64_t cycle = 0;
    std::unique_ptr<Device> model, rtl;
    std::vector<Operation> since;
  };

  bool same() const { return !difference_; }

  /// What was before the present edge.
  void forget() {
    closed_ = true;
    accesses_.clear();
    samples_.clear();
    older_ = {};
    newer_ = {};
  }

  void open(uint64_t cycle) { run_to(closed_ ? std::max(cycle, present_ + 1) : cycle); }

  static void replay(Device& device, const Operation& o) {
    switch (o.kind) {
      case Operation::Kind::sample:
        device.submit_of(o.channel, o.cycle, static_cast<int32_t>(o.offset_or_u),
                         static_cast<int32_t>(o.value_or_v), o.clip);
        break;
      case Operation::Kind::write:
        device.write_bytes(o.cycle, o.offset_or_u, o.value_or_v, o.strobes);
        break;
      case Operation::Kind::read:
      case Operation::Kind::debug_read:
        device.read(o.cycle, o.offset_or_u, o.kind == Operation::Kind::debug_read);
        break;
      case Operation::Kind::reset:
        device.reset();
        break;
    }
  }

  /// The last interval of the tick under way or its end, whichever comes next; far away when idle.
  uint64_t next_stop() const {
    const auto event = model_->next_event();
    if (!event) return UINT64_MAX;
    const uint64_t boundary = *event - (*event - present_ - 1) / model_->tick() * model_->tick();
    return boundary - 1 > present_ ? boundary - 1 : boundary;
  }

  /// The present edge is closed.
  void checkpoint() {
    if (!same() || !copies_) return;
    if (newer_.model && newer_.since.size() < operations_between_checkpoints) return;
    if (newer_.cycle == present_ && newer_.model) return;
    Checkpoint next{present_, model_->clone(), rtl_->clone(), {}};
    copies_ = next.model && next.rtl;
    if (!copies_) return;
    older_ = std::move(newer_);
    newer_ = std::move(next);
  }

  void record(const Operation& operation) {
    if (!same()) return;
    auto& recent = operation.kind == Operation::Kind::sample ? samples_ : accesses_;
    recent.push_back(operation);
    if (recent.size() > shown_operations) recent.pop_front();
    if (newer_.model) newer_.since.push_back(operation);
  }

  void compare_outputs() {
    if (!same()) return;
    const bool level = model_->interrupt();
    compare_output("interrupt line", level, rtl_->interrupt());
    if (level != level_) ++counters_.interrupt_edges;
    level_ = level;
    compare_output("idle", model_->idle(), rtl_->idle());
    compare_output("next event", static_cast<int64_t>(model_->next_event().value_or(0)),
                   static_cast<int64_t>(rtl_->next_event().value_or(0)));
  }

  /// A pin says little of why; what software would read at this edge says more.
  void compare_output(const std::string& what, int64_t model, int64_t rtl) {
    if (model != rtl && same()) found(what, model, rtl, "", differing_registers());
  }

  std::string differing_registers() const {
    std::string text;
    for (const auto& entry : registers::coprocessor::table) {
      const RegisterAccess ours = model_->read(present_, entry.offset, true);
      const RegisterAccess theirs = rtl_->read(present_, entry.offset, true);
      if (ours.ok && theirs.ok && ours.value != theirs.value)
        text += fmt::format("{}{} 0x{:08x} 0x{:08x}", text.empty() ? "" : ", ", entry.name,
                            ours.value, theirs.value);
    }
    return text;
  }

  void compare_commit() {
    if (!same()) return;
    const Nodes& ours = model_->nodes();
    const Nodes& theirs = rtl_->nodes();
    compare("number of results", static_cast<int64_t>(ours.commits),
            static_cast<int64_t>(theirs.commits));
    if (ours.commits == commits_) return;
    commits_ = ours.commits;
    ++counters_.commits;
    if (ours.commits == 0) return;
    for (const NamedNode& node : node_names()) compare_node(node, ours, theirs);
    compare("edge that took the sample", static_cast<int64_t>(ours.taken),
            static_cast<int64_t>(theirs.taken));
    compare("channel of the sample", ours.channel, theirs.channel);
    compare_results();
  }

  /// Every result word as a debugger sees it.
  void compare_results() {
    for (const auto& entry : registers::coprocessor::table) {
      const bool result =
          entry.access == registers::Access::read_only && entry.offset >= coprocessor::reg_status;
      if (!same() || !(result || entry.offset == coprocessor::reg_flags)) continue;
      const RegisterAccess ours = model_->read(present_, entry.offset, true);
      const RegisterAccess theirs = rtl_->read(present_, entry.offset, true);
      compare("result " + register_name(entry.offset), ours.value, theirs.value);
    }
  }

  /// The coefficients that a LOAD has just computed, before a sample meets them.
  void compare_loaded() {
    static constexpr std::array<const char*, 6> names = {"a_u", "b_u", "c_u", "a_v", "b_v", "c_v"};
    for (uint32_t word = 0; word < 2 * names.size(); ++word) {
      if (!same()) return;
      const uint32_t offset = coprocessor::reg_au_lo + 4 * word;
      const int64_t ours = model_->read(present_, offset, true).value;
      const int64_t theirs = rtl_->read(present_, offset, true).value;
      if (ours != theirs)
        found(register_name(offset) + " at LOAD", ours, theirs,
              fmt::format("{} (LOAD)", names[word / 2]));
    }
  }

  void compare_stages() {
    if (!same()) return;
    for (unsigned stage = 0; stage < stage_count; ++stage) {
      Nodes ours, theirs;
      if (!model_->stage_nodes(stage, ours) || !rtl_->stage_nodes(stage, theirs)) continue;
      for (const NamedNode& node : node_names())
        if (node.stage == stage) compare_node(node, ours, theirs);
    }
  }

  void compare_node(const NamedNode& node, const Nodes& ours, const Nodes& theirs) {
    ++counters_.nodes;
    const int64_t model = ours.*node.value;
    const int64_t rtl = theirs.*node.value;
    if (model == rtl || !same()) return;
    found(fmt::format("node {} at the end of {}", node.name, stage_name(node.stage)), model, rtl,
          fmt::format("{} ({}, {})", node.name, stage_name(node.stage), name_of(node.unit)));
  }

  void compare(const std::string& what, int64_t model, int64_t rtl) {
    if (model != rtl && same()) found(what, model, rtl, "");
  }

  void found(std::string what, int64_t model, int64_t rtl, std::string node,
             std::string registers = "") {
    difference_ = Difference{present_, std::move(what), hex(model),
                             hex(rtl), std::move(node), std::move(registers)};
    if (on_difference_) on_difference_();
  }

  std::deque<Operation> accesses_, samples_;
  Checkpoint older_, newer_;
  bool copies_ = true;  // both sides can be copied, as far as is known
  std::optional<uint64_t> last_read_;
  bool closed_ = false;
  bool level_ = false;
  uint64_t commits_ = 0;
  uint64_t load_until_ = 0;  // a LOAD has ended by this edge
};

Lockstep::Lockstep(std::unique_ptr<Device> model, std::unique_ptr<Device> rtl)
    : pair_(std::make_unique<Pair>(std::move(model), std::move(rtl))) {}

Lockstep::~Lockstep() = default;

void Lockstep::Counters::visit(Archive& archive) {
  archive("samples", samples);
  archive("reads", reads);
  archive("writes", writes);
  archive("commits", commits);
  archive("nodes", nodes);
  archive("interrupt_edges", interrupt_edges);
}

unsigned Lockstep::tick() const {
  return pair_->model_->tick();
}

void Lockstep::visit(Archive& archive) {
  pair_->visit(archive);
}

bool Lockstep::save_idle(IdleState& state) const {
  return pair_->save_idle(state);
}

bool Lockstep::load_idle(const IdleState& state) {
  return pair_->load_idle(state);
}

bool Lockstep::change_idle(const IdleChange& change) {
  const IdleChange nothing = [](IdleState&) { return false; };
  if (!model().change_idle(nothing) || !rtl().change_idle(nothing)) return false;
  return model().change_idle(change) && rtl().change_idle(change);
}

Device& Lockstep::model() {
  pair_->open_sides();
  return *pair_->model_;
}

Device& Lockstep::rtl() {
  pair_->open_sides();
  return *pair_->rtl_;
}

void Lockstep::reset() {
  pair_->reset();
}

void Lockstep::advance(uint64_t cycle) {
  pair_->run_to(cycle);
}

std::optional<uint64_t> Lockstep::next_event() const {
  pair_->close();
  return pair_->model_->next_event();
}

bool Lockstep::submit_of(unsigned channel, uint64_t cycle, int32_t u, int32_t v, bool clip) {
  return pair_->submit(channel, cycle, u, v, clip);
}

unsigned Lockstep::channels() const {
  return pair_->model_->channels();
}

RegisterAccess Lockstep::read(uint64_t cycle, uint32_t offset, bool debug) {
  return pair_->read(cycle, offset, debug);
}

bool Lockstep::write(uint64_t cycle, uint32_t offset, uint32_t value) {
  return pair_->write(cycle, offset, value, coprocessor::all_strobes);
}

bool Lockstep::write_bytes(uint64_t cycle, uint32_t offset, uint32_t value, uint8_t strobes) {
  return pair_->write(cycle, offset, value, strobes);
}

bool Lockstep::interrupt() const {
  pair_->close();
  return pair_->model_->interrupt();
}

bool Lockstep::idle() const {
  pair_->close();
  return pair_->model_->idle();
}

const Nodes& Lockstep::nodes() const {
  pair_->close();
  return pair_->model_->nodes();
}

const std::optional<Difference>& Lockstep::difference() const {
  return pair_->difference_;
}

void Lockstep::on_difference(std::function<void()> callback) {
  pair_->on_difference_ = std::move(callback);
}

std::string Lockstep::report(const std::string& command, double cycle_ns) const {
  return pair_->report(command, cycle_ns);
}

History Lockstep::history(uint64_t before, uint64_t after, std::size_t most) const {
  return pair_->history(before, after, most);
}

std::optional<Error> Lockstep::write_waves(const std::string& file) const {
  return pair_->write_waves(file);
}

const Lockstep::Counters& Lockstep::counters() const {
  return pair_->counters_;
}

}  // namespace capsoc::rtl
