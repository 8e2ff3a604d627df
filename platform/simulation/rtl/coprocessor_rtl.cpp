#include "rtl/coprocessor_rtl.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <list>
#include <string>
#include <vector>

#include "coprocessor/channel_register.h"
#include "coprocessor/register_map.h"
#include "coprocessor/sequencer.h"
#include "rtl/rtl_state.h"

namespace capsoc::rtl {

using coprocessor::commit_stage;
using coprocessor::IdleState;
using coprocessor::load_stage_count;
using coprocessor::NamedNode;
using coprocessor::node_names;
using coprocessor::Nodes;
using coprocessor::RegisterAccess;
using coprocessor::stage_count;

namespace {

constexpr uint32_t last_offset = 0xFFF;  // paddr_i has 12 bits

}  // namespace

/// One instance and its place in time. What is on the pins for the coming edge stays there until
/// that edge is made, which is when something asks for the state after it.
class CoprocessorRtl::Pins {
 public:
  Pins(RtlLibrary::Handle library, Clocking clocking)
      : library_(std::move(library)),
        api_(library_->api()),
        inside_(*api_.inside),
        clocking_(clocking),
        instance_(api_.create(), api_.destroy),
        tick_(coprocessor::tick_cycles * static_cast<unsigned>(api_.iteration_clocks)),
        pins_(*api_.pins(instance_.get())),
        values_(inside_.node_count) {
    // RtlLibrary has seen to it that the library's are these.
    std::size_t index = 0;
    for (const NamedNode& node : node_names()) wires_[node.stage].push_back({node.value, index++});
    reset();
  }

  std::unique_ptr<Pins> copy() {
    settle();
    std::string bytes(inside_.save(instance_.get(), nullptr, 0), 0);
    if (bytes.empty()) return nullptr;
    auto other = std::make_unique<Pins>(library_, clocking_);
    inside_.save(instance_.get(), bytes.data(), bytes.size());
    other->pins_ = pins_;
    inside_.restore(other->instance_.get(), bytes.data(), bytes.size());
    other->edge_ = edge_;
    other->named_ = named_;
    other->acts_ = acts_;
    other->reading_ = reading_;
    other->changed_ = changed_;
    other->flight_ = flight_;
    other->taken_ = taken_;
    other->nodes_ = nodes_;
    return other;
  }

  void visit(Archive& archive) {
    settle();
    std::string rtl = library_->api().source_hash;
    archive("rtl", rtl);
    if (rtl != library_->api().source_hash)
      return archive.refuse("is of other RTL than this program has");
    visit_verilated(archive);
    auto* const pins = reinterpret_cast<std::array<uint8_t, sizeof(capsoc_rtl_pins)>*>(&pins_);
    archive("pins", *pins);
    archive("edge", edge_);
    archive("acts", acts_);
    archive("reading", reading_);
    archive("changed", changed_);
    archive("flight", flight_);
    archive("taken", taken_);
    archive("nodes", nodes_);
    archive("clocks", clocks_);
    if (archive.loading()) named_ = edge_;
  }

  bool save_idle(IdleState& state) {
    settle();
    // The contexts of other channels are words of a memory, and no code translates those.
    if (!pins_.idle || (acts_ && !reading_) || api_.channels > 1) return false;
    capsoc_rtl_state registers{};
    inside_.get_state(instance_.get(), &registers);
    state = to_model(registers, nodes_);
    state.cycle = edge_;
    // A read of HI fills its latch at the coming edge; in the model it has done so.
    if (reading_)
      state.latched_low.at(coprocessor::pair_index(pins_.paddr)) = present_low(pins_.paddr - 4u);
    return true;
  }

  const capsoc_rtl_inside& inside() const { return inside_; }
  unsigned tick() const { return tick_; }
  unsigned channels() const { return static_cast<unsigned>(api_.channels); }

  uint64_t get_flip_flops(uint32_t index, uint32_t part) {
    settle();
    return inside_.get_flip_flops(instance_.get(), index, part);
  }

  void set_flip_flops(uint32_t index, uint32_t part, uint64_t value) {
    settle();
    inside_.set_flip_flops(instance_.get(), index, part, value);
  }

  void hold(uint32_t index, uint32_t part, uint64_t mask, uint64_t value) {
    settle();
    held_.push_back({index, part, mask, value & mask});
    keep_held();
  }

  void release(uint32_t index, uint32_t part, uint64_t mask) {
    settle();
    held_.remove_if([&](const Held& held) {
      return held.index == index && held.part == part && held.mask == mask;
    });
  }

  void load_idle(const IdleState& state) {
    reset();
    const capsoc_rtl_state registers = to_rtl(state);
    inside_.set_state(instance_.get(), &registers);
    edge_ = named_ = state.cycle;
    changed_ = false;
    nodes_ = state.nodes;
  }

  void reset() {
    settle();
    release();
    pins_.presetn = 0;
    api_.eval(instance_.get());
    pins_.presetn = 1;
    api_.eval(instance_.get());
    changed_ = false;
    flight_ = {};
    taken_ = {};
    nodes_ = {};
    keep_held();
  }

  /// The edge may still get inputs, so only those before it are made.
  void name(uint64_t cycle) {
    named_ = std::max(named_, cycle);
    if (named_ > 0) run_to(named_ - 1);
  }

  void settle() { run_to(named_); }

  bool submit(unsigned channel, uint64_t cycle, int32_t u, int32_t v, bool clip) {
    if (channel >= channels()) return name(cycle), false;
    open(cycle);
    pins_.sample_channel = static_cast<uint8_t>(channel);
    pins_.sample_valid = 1;
    pins_.sample_u = static_cast<uint32_t>(u);
    pins_.sample_v = static_cast<uint32_t>(v);
    pins_.sample_clip = clip ? 1 : 0;
    api_.eval(instance_.get());
    acts_ = true;
    if (pins_.sample_ready == 0) return false;
    if (taken_.back() != 0) forget_oldest();  // a design whose stages are not seen
    *std::find(taken_.begin(), taken_.end(), 0u) = cycle;
    return true;
  }

  bool write(uint64_t cycle, uint32_t offset, uint32_t value, uint8_t strobes) {
    if (offset > last_offset) return false;
    open(reading_ ? std::max(cycle, edge_ + 2) : cycle);
    drive_bus(offset, strobes, value);
    acts_ = true;
    return pins_.pslverr == 0;
  }

  RegisterAccess read(uint64_t cycle, uint32_t offset, bool debug) {
    name(cycle);
    settle();
    if (offset > last_offset) return {};
    const capsoc_rtl_pins before = pins_;
    const bool shown = pins_.ready != 0 || coprocessor::is_shared(offset);
    if (debug && coprocessor::is_pair(offset) && !coprocessor::is_pair_high(offset))
      return {true, shown ? present_low(offset) : 0};
    drive_bus(offset, std::nullopt, 0);
    const RegisterAccess result{pins_.pslverr == 0, pins_.pslverr == 0 ? pins_.prdata : 0};
    // Reads of a HI word fill the latch at the coming edge, and one that is refused is noted;
    // others change nothing and need no clock.
    if (!debug &&
        (coprocessor::is_pair_high(offset) || (!shown && coprocessor::is_register(offset)))) {
      acts_ = reading_ = true;
    } else {
      pins_.psel = before.psel;
      pins_.penable = before.penable;
      pins_.paddr = before.paddr;
      changed_ = true;
    }
    return result;
  }

  std::optional<uint64_t> next_event() {
    settle();
    if (pins_.idle) return std::nullopt;
    const uint64_t boundary = edge_ + (pins_.stage || pins_.load ? tick_ - pins_.cycle : 1u);
    for (unsigned stage = stage_count; stage-- > 0;)
      if (pins_.stage >> stage & 1) return boundary + uint64_t{stage_count - 1 - stage} * tick_;
    for (unsigned stage = load_stage_count; stage-- > 0;)
      if (pins_.load >> stage & 1) return boundary + uint64_t{load_stage_count - 1 - stage} * tick_;
    if (pins_.change != 0) return edge_ + pins_.change;
    if (!pins_.load_pending && pins_.blocked != 0) return std::nullopt;
    return boundary + uint64_t{pins_.load_pending ? load_stage_count : stage_count} * tick_;
  }

  bool interrupt() {
    settle();
    return pins_.irq != 0;
  }

  bool idle() {
    settle();
    return pins_.idle != 0;
  }

  const Nodes& nodes() {
    settle();
    return nodes_;
  }

  bool stage_nodes(unsigned stage, Nodes& nodes) {
    settle();
    if (stage >= stage_count || !pins_.boundary || !(pins_.stage >> stage & 1)) return false;
    inside_.nodes(instance_.get(), values_.data());
    take(stage, nodes);
    return true;
  }

  std::optional<Error> open_waves(const std::string& file, unsigned period_ns) {
    settle();
    // The writer removes what has the name and makes its own file.
    std::error_code ignored;
    if (const auto status = std::filesystem::status(file, ignored);
        std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
      return Error{fmt::format("{}: is no file; name one for the waves", file)};
    std::FILE* test = std::fopen(file.c_str(), "wb");
    const int reason = errno;
    if (test != nullptr) std::fclose(test);
    if (test == nullptr || !api_.open_waves(instance_.get(), file.c_str()))
      return Error{fmt::format("{}: cannot be written ({}); name another file for the waves", file,
                               std::strerror(reason))};
    period_ns_ = period_ns;
    return std::nullopt;
  }

  void show_model(const Nodes& nodes) {
    std::fill(values_.begin(), values_.end(), 0);
    for (const auto& stage : wires_)
      for (const Wire& wire : stage) values_[wire.index] = nodes.*wire.node;
    inside_.model_nodes(instance_.get(), values_.data());
  }

  void close_waves() {
    settle();
    api_.close_waves(instance_.get());
    period_ns_ = 0;
  }

  bool write_coverage(const std::string& file) {
    settle();
    return api_.write_coverage(instance_.get(), file.c_str()) != 0;
  }

  uint64_t clocks() {
    settle();
    return clocks_;
  }

 private:
  struct Wire {
    int64_t Nodes::*node;
    std::size_t index;
  };

  /// Flip-flops that do not follow their input.
  struct Held {
    uint32_t index, part;
    uint64_t mask, value;
  };

  void keep_held() {
    for (const Held& held : held_) {
      const uint64_t present = inside_.get_flip_flops(instance_.get(), held.index, held.part);
      if ((present & held.mask) != held.value)
        inside_.set_flip_flops(instance_.get(), held.index, held.part,
                               (present & ~held.mask) | held.value);
    }
  }

  void visit_verilated(Archive& archive) {
    const std::size_t size = inside_.save(instance_.get(), nullptr, 0);
    if (size == 0) return archive.refuse("cannot be saved with coverage");
    std::string bytes(size, 0);
    inside_.save(instance_.get(), reinterpret_cast<uint8_t*>(bytes.data()), size);
    archive("verilated", bytes);
    if (!archive.loading() || !archive.ok()) return;
    if (bytes.size() != size) return archive.refuse("has another size than this RTL");
    inside_.restore(instance_.get(), bytes.data(), size);
  }

  /// Ready for inputs of edge `cycle`.
  void open(uint64_t cycle) {
    named_ = std::max({named_, cycle, edge_ + 1});
    run_to(named_ - 1);
  }

  /// A write has strobes.
  void drive_bus(uint32_t offset, std::optional<uint8_t> strobes, uint32_t value) {
    pins_.psel = pins_.penable = 1;
    pins_.pwrite = strobes ? 1 : 0;
    pins_.paddr = static_cast<uint16_t>(offset & 0xFFF);
    pins_.pwdata = value;
    pins_.pstrb = strobes.value_or(0);
    api_.eval(instance_.get());
  }

  void release() {
    pins_.psel = pins_.penable = pins_.pwrite = pins_.sample_valid = 0;
    acts_ = reading_ = false;
    changed_ = true;
  }

  void run_to(uint64_t target) {
    while (edge_ < target) {
      if (!acts_ && pins_.idle && clocking_ == Clocking::skip) {
        edge_ = target;
      } else if (acts_ || pins_.boundary || pins_.idle || period_ns_ != 0 || !held_.empty()) {
        make_edge();
      } else {
        if (changed_) api_.eval(instance_.get());
        changed_ = false;
        const uint64_t made = inside_.clock_on(instance_.get(), target - edge_);
        edge_ += made;
        clocks_ += made;
      }
    }
  }

  void make_edge() {
    if (changed_) api_.eval(instance_.get());
    changed_ = false;
    const bool boundary = pins_.boundary != 0;
    const bool commit = boundary && pins_.commit;
    const bool soft_reset = pins_.psel && pins_.pwrite && pins_.pstrb == coprocessor::all_strobes &&
                            pins_.paddr == coprocessor::reg_ctrl &&
                            (pins_.pwdata & coprocessor::ctrl_srst) != 0 && pins_.ready != 0;
    if (boundary && pins_.stage != 0) end_tick(commit);
    ++edge_;
    ++clocks_;
    if (period_ns_ != 0)
      api_.wave_time(instance_.get(), edge_ * period_ns_, edge_ * period_ns_ + period_ns_ / 2);
    api_.clock(instance_.get());
    keep_held();
    if (soft_reset) {
      // Another channel's sample still waits.
      const uint64_t waiting =
          pins_.held != 0 ? *std::max_element(taken_.begin(), taken_.end()) : 0;
      taken_ = {waiting, 0, 0};
      nodes_ = {};
    }
    if (acts_) release();
  }

  void forget_oldest() { taken_ = {taken_[1], taken_[2], 0}; }

  /// The edge at which the sample in T0 was taken, at the end of its tick; 0: software wrote it.
  /// It entered at the beginning of the tick, so it was latched before.
  uint64_t taken_of_t0() {
    const uint64_t taken = taken_.front();
    if (taken == 0 || taken + tick_ >= edge_ + 1) return 0;
    forget_oldest();
    return taken;
  }

  /// The samples move on, and with them what their stages made.
  void end_tick(bool commit) {
    inside_.nodes(instance_.get(), values_.data());
    // The oldest sample first: each makes room for the next.
    for (unsigned stage = stage_count; stage-- > 0;) {
      if (!(pins_.stage >> stage & 1)) continue;
      take(stage, flight_[stage]);
      if (stage == 0) flight_[0].taken = taken_of_t0();
      if (stage + 1 < stage_count) {
        flight_[stage + 1] = flight_[stage];
      } else if (commit) {
        const uint64_t commits = nodes_.commits;
        nodes_ = flight_[stage];
        take(commit_stage, nodes_);
        nodes_.commits = commits + 1;
        nodes_.channel = pins_.active;
      }
    }
  }

  void take(unsigned stage, Nodes& nodes) {
    for (const Wire& wire : wires_[stage]) nodes.*wire.node = values_[wire.index];
  }

  /// The LO word of a 48-bit register as a debugger sees it.
  uint32_t present_low(uint32_t offset) {
    std::array<int64_t, 8> pairs{};
    inside_.pairs(instance_.get(), pairs.data());
    const unsigned pair = coprocessor::pair_index(offset);
    return coprocessor::pair_words(pair, pairs.at(pair)).low;
  }

  RtlLibrary::Handle library_;
  const capsoc_rtl_api& api_;
  const capsoc_rtl_inside& inside_;
  Clocking clocking_;
  std::unique_ptr<capsoc_rtl, void (*)(capsoc_rtl*)> instance_;
  const unsigned tick_;  // cycles
  capsoc_rtl_pins& pins_;

  uint64_t edge_ = 0;     // made; the pins show the interval after it
  uint64_t named_ = 0;    // the latest edge that a caller has named
  bool acts_ = false;     // an input is set for the coming edge
  bool reading_ = false;  // it is a read
  bool changed_ = false;  // inputs were taken back and not evaluated since
  uint64_t clocks_ = 0;
  unsigned period_ns_ = 0;  // 0: no waves
  std::list<Held> held_;

  std::array<std::vector<Wire>, commit_stage + 1> wires_;
  std::vector<int64_t> values_;
  std::array<Nodes, stage_count> flight_;
  // Edges of the samples in T0, before it and at the pins, the oldest first; 0: none. Software's
  // are not among them.
  std::array<uint64_t, 3> taken_{};
  Nodes nodes_;
};

CoprocessorRtl::CoprocessorRtl(RtlLibrary::Handle library, Clocking clocking)
    : pins_(std::make_unique<Pins>(std::move(library), clocking)) {}

CoprocessorRtl::CoprocessorRtl(std::unique_ptr<Pins> pins) : pins_(std::move(pins)) {}

CoprocessorRtl::~CoprocessorRtl() = default;

void CoprocessorRtl::reset() {
  pins_->reset();
}

void CoprocessorRtl::advance(uint64_t cycle) {
  pins_->name(cycle);
}

std::optional<uint64_t> CoprocessorRtl::next_event() const {
  return pins_->next_event();
}

bool CoprocessorRtl::submit_of(unsigned channel, uint64_t cycle, int32_t u, int32_t v, bool clip) {
  return pins_->submit(channel, cycle, u, v, clip);
}

unsigned CoprocessorRtl::channels() const {
  return pins_->channels();
}

RegisterAccess CoprocessorRtl::read(uint64_t cycle, uint32_t offset, bool debug) {
  return pins_->read(cycle, offset, debug);
}

bool CoprocessorRtl::write(uint64_t cycle, uint32_t offset, uint32_t value) {
  return pins_->write(cycle, offset, value, coprocessor::all_strobes);
}

bool CoprocessorRtl::write_bytes(uint64_t cycle, uint32_t offset, uint32_t value, uint8_t strobes) {
  return pins_->write(cycle, offset, value, strobes);
}

bool CoprocessorRtl::interrupt() const {
  return pins_->interrupt();
}

bool CoprocessorRtl::idle() const {
  return pins_->idle();
}

const Nodes& CoprocessorRtl::nodes() const {
  return pins_->nodes();
}

bool CoprocessorRtl::stage_nodes(unsigned stage, Nodes& nodes) const {
  return pins_->stage_nodes(stage, nodes);
}

unsigned CoprocessorRtl::tick() const {
  return pins_->tick();
}

void CoprocessorRtl::visit(Archive& archive) {
  pins_->visit(archive);
}

bool CoprocessorRtl::save_idle(IdleState& state) const {
  return pins_->save_idle(state);
}

bool CoprocessorRtl::load_idle(const IdleState& state) {
  if (channels() > 1) return false;
  pins_->load_idle(state);
  return true;
}

std::unique_ptr<coprocessor::Device> CoprocessorRtl::clone() const {
  auto pins = pins_->copy();
  if (pins == nullptr) return nullptr;
  return std::unique_ptr<CoprocessorRtl>(new CoprocessorRtl(std::move(pins)));
}

const capsoc_rtl_flip_flops* CoprocessorRtl::flip_flops() const {
  return pins_->inside().flip_flops;
}

std::size_t CoprocessorRtl::flip_flop_count() const {
  return pins_->inside().flip_flop_count;
}

uint64_t CoprocessorRtl::get_flip_flops(uint32_t index, uint32_t part) const {
  return pins_->get_flip_flops(index, part);
}

void CoprocessorRtl::set_flip_flops(uint32_t index, uint32_t part, uint64_t value) {
  pins_->set_flip_flops(index, part, value);
}

void CoprocessorRtl::hold_flip_flops(uint32_t index, uint32_t part, uint64_t mask, uint64_t value) {
  pins_->hold(index, part, mask, value);
}

void CoprocessorRtl::release_flip_flops(uint32_t index, uint32_t part, uint64_t mask) {
  pins_->release(index, part, mask);
}

uint64_t CoprocessorRtl::clocks() const {
  return pins_->clocks();
}

std::optional<Error> CoprocessorRtl::open_waves(const std::string& file, unsigned period_ns) {
  return pins_->open_waves(file, period_ns);
}

void CoprocessorRtl::show_model(const Nodes& nodes) {
  pins_->show_model(nodes);
}

void CoprocessorRtl::close_waves() {
  pins_->close_waves();
}

std::optional<Error> CoprocessorRtl::write_coverage(const std::string& file) const {
  if (pins_->write_coverage(file)) return std::nullopt;
  return Error{
      fmt::format("{}: no coverage can be written; build the library for it with `cmake --build "
                  "BUILD --target capsoc_rtl_coverage`",
                  file)};
}

}  // namespace capsoc::rtl
