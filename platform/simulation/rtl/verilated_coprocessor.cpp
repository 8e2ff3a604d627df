// The inside of a Verilated library: rtl_abi.h over Verilator's class for the probe. Compiled once
// for each library, with CAPSOC_RTL_* for its parameters.
#include <algorithm>
#include <cstring>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include "Vcoprocessor_probe.h"
#include "Vcoprocessor_probe__Syms.h"
#include "Vcoprocessor_probe___024root.h"
#include "coprocessor/sequencer.h"
#include "rtl/rtl_abi.h"
#include "rtl/specialised/edges.h"
#include "rtl/verilated_instance.h"
#include "verilated_save.h"

// Verilator's: all combinational logic again, as at its first evaluation. eval() would not do it,
// for nothing that it looks at has changed.
void Vcoprocessor_probe___024root___eval_settle(Vcoprocessor_probe___024root* top);

namespace {

constexpr const char* names[] = {
#define NODE(name, stage, unit, format, model, when, rtl) #name,
#include "coprocessor/nodes.def"
};

// Verilator's streams write to files; these keep the bytes.
class MemorySave final : public VerilatedSerialize {
 public:
  MemorySave() { m_isOpen = true; }
  ~MemorySave() override { m_isOpen = false; }
  void flush() override {
    bytes.insert(bytes.end(), m_bufp, m_cp);
    m_cp = m_bufp;
  }
  std::vector<uint8_t> bytes;
};

class MemoryRestore final : public VerilatedDeserialize {
 public:
  MemoryRestore(const void* data, size_t size)
      : next_(static_cast<const uint8_t*>(data)), left_(size) {
    m_isOpen = true;
    m_endp = m_bufp;
    m_cp = m_bufp;
    fill();
  }
  ~MemoryRestore() override { m_isOpen = false; }
  void fill() override {
    const auto kept = static_cast<size_t>(m_endp - m_cp);
    std::memmove(m_bufp, m_cp, kept);
    const size_t part = std::min(left_, bufferSize() - kept);
    std::memcpy(m_bufp + kept, next_, part);
    next_ += part;
    left_ -= part;
    m_cp = m_bufp;
    m_endp = m_bufp + kept + part;
  }

 private:
  const uint8_t* next_;
  size_t left_;
};

}  // namespace

#define REGISTER(instance, variable) \
  top.coprocessor_probe__DOT__dut__DOT__##instance##__DOT__##variable

namespace {

using capsoc::rtl::has_outputs;
using capsoc::rtl::held_alone;
using capsoc::rtl::nothing_at_all;
using capsoc::rtl::other_state;
using capsoc::rtl::outputs;
using capsoc::rtl::sample_alone;
using capsoc::rtl::specialised_edges;
using capsoc::rtl::specialised_outputs;
using capsoc::rtl::SpecialisedEdge;
using capsoc::rtl::SpecialisedState;
using capsoc::rtl::stage_0_alone;
constexpr unsigned last_cycle = capsoc::coprocessor::tick_cycles - 1;
using Root = Vcoprocessor_probe___024root;

unsigned cycle_of(const Root& top) {
  return REGISTER(u_sequencer, cycle_q);
}

/// Inputs as the probe has them on the design.
#define ON_PIN(name) top.coprocessor_probe__DOT__##name

SpecialisedState state_of(const Root& top) {
  if ((ON_PIN(psel) | ON_PIN(penable) | ON_PIN(pwrite) | (ON_PIN(presetn) ^ 1) |
       REGISTER(u_sequencer, load_q) | REGISTER(u_sequencer, load_pending_q)) != 0)
    return other_state;
  const unsigned stages = REGISTER(u_sequencer, stage_q);
  const unsigned waiting = REGISTER(u_sequencer, held_q) + 2U * ON_PIN(sample_valid);
  if (stages == 0) {
    constexpr SpecialisedState idle[] = {nothing_at_all, held_alone, sample_alone, other_state};
    return cycle_of(top) == 0 ? idle[waiting] : other_state;
  }
  if (waiting != 0 || (stages & (stages - 1)) != 0) return other_state;
  return static_cast<SpecialisedState>(stage_0_alone + __builtin_ctz(stages));
}

/// The state of a sample in one of the stages, which lasts for a tick.
constexpr bool in_pipeline(SpecialisedState state) {
  return state < held_alone;
}

/// Whether with these inputs there is one sample in the design at the most, and nothing else.
bool may_drive(const Root& top, const capsoc_rtl_pins& pins) {
  const unsigned stages = REGISTER(u_sequencer, stage_q);
  return pins.presetn == ON_PIN(presetn) &&
         (REGISTER(u_sequencer, load_q) | REGISTER(u_sequencer, load_pending_q) |
          (stages & (stages - 1))) == 0 &&
         (stages != 0) + REGISTER(u_sequencer, held_q) + pins.sample_valid <= 1;
}

/// What the probe does at the rising edge of drive_i, except the reset.
void put_on_design(Root& top, const capsoc_rtl_pins& pins) {
  ON_PIN(psel) = pins.psel;
  ON_PIN(penable) = pins.penable;
  ON_PIN(pwrite) = pins.pwrite;
  ON_PIN(paddr) = pins.paddr;
  ON_PIN(pwdata) = pins.pwdata;
  ON_PIN(pstrb) = pins.pstrb;
  ON_PIN(sample_valid) = pins.sample_valid;
  ON_PIN(sample_u) = pins.sample_u;
  ON_PIN(sample_v) = pins.sample_v;
  ON_PIN(sample_clip) = pins.sample_clip;
  ON_PIN(sample_channel) = pins.sample_channel;
}

}  // namespace

struct capsoc_rtl : capsoc::rtl::VerilatedInstance<Vcoprocessor_probe> {
  using Design = capsoc::rtl::VerilatedInstance<Vcoprocessor_probe>;

  void sample() {
    capsoc::rtl::fetch_pins(*top, pins);
    pins.boundary = top->boundary_o;
    pins.enter = top->enter_o;
    pins.cycle = top->cycle_o;
    pins.stage = top->stage_o;
    pins.load = top->load_o;
    pins.load_start = top->load_start_o;
    pins.held = top->held_o;
    pins.load_pending = top->load_pending_o;
    pins.running = top->running_o;
    pins.commit = top->commit_o;
    pins.active = top->active_o;
    pins.ready = top->ready_o;
    pins.blocked = top->blocked_o;
    pins.change = top->change_o;
  }

  void drive() {
    if (drive_specialised()) return show();
    settle();
    Design::drive();
  }

  void toggle() {
    if (clock_specialised(1) != 0) return show();
    settle();
    Design::toggle();
  }

  /// Up to `count` edges, and none after the interval that ends a tick; 0 unless edges were
  /// compiled for this state. show() or settle() has to follow.
  uint64_t clock_specialised(uint64_t count) {
    const SpecialisedState state = waves ? other_state : state_of(root());
    if (state == other_state) return 0;
    unsigned cycle = cycle_of(root());
    uint64_t made = 0;
    do {
      const SpecialisedEdge edge = specialised_edges[state][cycle];
      if (edge == nullptr) break;
      edge(&root());
      ++made;
      ++cycle;
    } while (made < count && in_pipeline(state) && cycle < last_cycle);
    if (made != 0) stale_ = true;
    return made;
  }

  /// The outputs after registers that were moved on.
  void show() {
    const SpecialisedState state = state_of(root());
    const SpecialisedEdge specialised =
        state == other_state ? nullptr : specialised_outputs[state][cycle_of(root())];
    (specialised != nullptr ? specialised : outputs)(&root());
  }

  /// Everything that is combinational after registers that were moved on.
  void settle() {
    if (stale_) Vcoprocessor_probe___024root___eval_settle(&root());
    stale_ = false;
  }

 private:
  Root& root() { return *top->rootp; }

  /// Puts the inputs on the design, if they do not write and the next edge can be specialised.
  bool drive_specialised() {
    if (waves || !has_outputs || (pins.psel && pins.pwrite) || !may_drive(root(), pins))
      return false;
    capsoc::rtl::drive_pins(*top, pins);
    put_on_design(root(), pins);
    stale_ = true;
    return true;
  }

  bool stale_ = false;  // registers are ahead of what is combinational
};

namespace {

uint64_t clock_on(capsoc_rtl* r, uint64_t count) {
  const Vcoprocessor_probe& top = *r->top;
  uint64_t made = 0;
  if (count != 0 && !top.boundary_o && !top.idle_o) {
    made = r->clock_specialised(count);
    if (made != 0) r->show();
  }
  while (made < count && !top.boundary_o && !top.idle_o) {
    r->toggle();
    ++made;
  }
  r->sample();
  return made;
}

void nodes(capsoc_rtl* r, int64_t* values) {
  const Vcoprocessor_probe& top = *r->top;
#define NODE(name, stage, unit, format, model, when, rtl) \
  *values++ = static_cast<int64_t>(top.node_##name##_o);
#include "coprocessor/nodes.def"
}

int64_t extended(uint64_t word48) {
  return static_cast<int64_t>(word48 << 16) >> 16;
}

void pairs(capsoc_rtl* r, int64_t* values) {
  const Vcoprocessor_probe& top = *r->top;
  *values++ = extended(top.freq_o);
  *values++ = static_cast<int64_t>(top.phase_o);
  for (const uint64_t weight : {top.au_o, top.bu_o, top.cu_o, top.av_o, top.bv_o, top.cv_o})
    *values++ = extended(weight);
}

// Verilator has either copies or coverage.
#if CAPSOC_RTL_COVERAGE
size_t save(capsoc_rtl*, void*, size_t) {
  return 0;
}

void restore(capsoc_rtl*, const void*, size_t) {}
#else
size_t save(capsoc_rtl* r, void* bytes, size_t size) {
  r->settle();
  // What the waves have seen is no state: all of it counts as new.
  r->top->rootp->vlSymsp->__Vm_activity = true;
  for (CData& changed : r->top->rootp->__Vm_traceActivity.m_storage) changed = 1;
  MemorySave stream;
  stream << *r->top;
  stream.flush();
  if (stream.bytes.size() <= size) std::memcpy(bytes, stream.bytes.data(), stream.bytes.size());
  return stream.bytes.size();
}

void restore(capsoc_rtl* r, const void* bytes, size_t size) {
  r->settle();
  MemoryRestore stream(bytes, size);
  stream >> *r->top;
  r->sample();
}
#endif

void get_state(capsoc_rtl* r, capsoc_rtl_state* state) {
  const Vcoprocessor_probe___024root& top = *r->top->rootp;
#define WORD(name, bits, instance, variable) state->name = REGISTER(instance, variable);
#define WORDS(name, count, bits, instance, variable) \
  for (size_t i = 0; i < (count); ++i) state->name[i] = REGISTER(instance, variable)[i];
#include "rtl/rtl_state.def"
#undef WORD
#undef WORDS
}

template <typename Register>
void assign(Register& place, uint64_t value, unsigned bits) {
  static_assert(sizeof(Register) <= sizeof value);
  place = static_cast<Register>(value & (~uint64_t{0} >> (64 - bits)));
}

void set_state(capsoc_rtl* r, const capsoc_rtl_state* state) {
  r->settle();
  Vcoprocessor_probe___024root& top = *r->top->rootp;
#define WORD(name, bits, instance, variable) \
  assign(REGISTER(instance, variable), state->name, bits);
#define WORDS(name, count, bits, instance, variable) \
  for (size_t i = 0; i < (count); ++i)               \
    assign(REGISTER(instance, variable)[i], state->name[i], bits);
#include "rtl/rtl_state.def"
#undef WORD
#undef WORDS
  Vcoprocessor_probe___024root___eval_settle(&top);
  r->sample();
}

/// Where Verilator keeps flip-flops: whole words, little-endian.
struct FlipFlopWord {
  uint8_t* (*place)(Root& top, size_t word);
  size_t word;
};

struct FlipFlopList {
  std::vector<std::string> names;
  std::vector<capsoc_rtl_flip_flops> flip_flops;
  std::vector<FlipFlopWord> places;

  void add(const std::string& name, uint32_t bits, FlipFlopWord place) {
    names.push_back(name);
    flip_flops.push_back({nullptr, bits});
    places.push_back(place);
  }

  FlipFlopList() {
#define FLIP_FLOP(name, bits, variable) \
  add(name, bits, {[](Root& top, size_t) { return reinterpret_cast<uint8_t*>(&top.variable); }, 0});
#define FLIP_FLOPS(name, words, bits, variable)                                                  \
  for (size_t i = 0; i < (words); ++i)                                                           \
    add(name "." + std::to_string(i), bits,                                                      \
        {[](Root& top, size_t word) { return reinterpret_cast<uint8_t*>(&top.variable[word]); }, \
         i});
#include "flip_flops.inc"
#undef FLIP_FLOP
#undef FLIP_FLOPS
    for (size_t i = 0; i < names.size(); ++i) flip_flops[i].name = names[i].c_str();
  }

  /// Bytes of a part, and where.
  size_t size(uint32_t index, uint32_t part) const {
    const uint32_t left = flip_flops[index].bits - 64 * part;
    return (std::min<uint32_t>(left, 64) + 7) / 8;
  }
  uint8_t* at(Root& top, uint32_t index, uint32_t part) const {
    return places[index].place(top, places[index].word) + size_t{8} * part;
  }
};

const FlipFlopList& flip_flop_list() {
  static const FlipFlopList list;
  return list;
}

uint64_t get_flip_flops(capsoc_rtl* r, uint32_t index, uint32_t part) {
  const FlipFlopList& list = flip_flop_list();
  uint64_t value = 0;
  std::memcpy(&value, list.at(*r->top->rootp, index, part), list.size(index, part));
  return value;
}

void set_flip_flops(capsoc_rtl* r, uint32_t index, uint32_t part, uint64_t value) {
  r->settle();
  const FlipFlopList& list = flip_flop_list();
  const uint32_t left = list.flip_flops[index].bits - 64 * part;
  if (left < 64) value &= ~(~uint64_t{0} << left);
  std::memcpy(list.at(*r->top->rootp, index, part), &value, list.size(index, part));
  Vcoprocessor_probe___024root___eval_settle(r->top->rootp);
  r->sample();
}

void model_nodes(capsoc_rtl* r, const int64_t* values) {
#define NODE(name, stage, unit, format, model, when, rtl) \
  r->top->model_##name##_i = static_cast<uint64_t>(*values++);
#include "coprocessor/nodes.def"
}

const capsoc_rtl_inside inside = {capsoc_rtl_state_layout,
                                  sizeof names / sizeof names[0],
                                  names,
                                  clock_on,
                                  nodes,
                                  model_nodes,
                                  pairs,
                                  save,
                                  restore,
                                  get_state,
                                  set_state,
                                  static_cast<uint32_t>(flip_flop_list().flip_flops.size()),
                                  flip_flop_list().flip_flops.data(),
                                  get_flip_flops,
                                  set_flip_flops};

const capsoc_rtl_api api = capsoc::rtl::api_of<capsoc_rtl>(0, &inside);

}  // namespace

extern "C" __attribute__((visibility("default"))) const capsoc_rtl_api* capsoc_rtl_entry() {
  return &api;
}
