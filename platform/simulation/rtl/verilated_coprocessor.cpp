// The inside of a Verilated library: rtl_abi.h over Verilator's class for the probe. Compiled once
// for each library, with CAPSOC_RTL_* for its parameters.
#include <cstring>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include "Vcoprocessor_probe.h"
#include "Vcoprocessor_probe___024root.h"
#include "rtl/rtl_abi.h"
#include "rtl/verilated_instance.h"
#include "verilated_save.h"

// Verilator's: all combinational logic anew, as at its first evaluation. eval() would not do it,
// for nothing that it looks at has changed.
// NOLINTNEXTLINE(bugprone-reserved-identifier): the name is Verilator's
void Vcoprocessor_probe___024root___eval_settle(Vcoprocessor_probe___024root* top);

namespace {

constexpr const char* names[] = {
#define NODE(name, stage, format, model, when, rtl) #name,
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

struct capsoc_rtl : capsoc::rtl::VerilatedInstance<Vcoprocessor_probe> {
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
  }
};

namespace {

uint64_t clock_on(capsoc_rtl* r, uint64_t count) {
  const Vcoprocessor_probe& top = *r->top;
  uint64_t made = 0;
  while (made < count && !top.boundary_o && !top.idle_o) {
    r->toggle();
    ++made;
  }
  r->sample();
  return made;
}

void nodes(capsoc_rtl* r, int64_t* values) {
  const Vcoprocessor_probe& top = *r->top;
#define NODE(name, stage, format, model, when, rtl) \
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
  MemorySave stream;
  stream << *r->top;
  stream.flush();
  if (stream.bytes.size() <= size) std::memcpy(bytes, stream.bytes.data(), stream.bytes.size());
  return stream.bytes.size();
}

void restore(capsoc_rtl* r, const void* bytes, size_t size) {
  MemoryRestore stream(bytes, size);
  stream >> *r->top;
  r->sample();
}
#endif

#define REGISTER(instance, variable) \
  top.coprocessor_probe__DOT__dut__DOT__##instance##__DOT__##variable

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

void model_nodes(capsoc_rtl* r, const int64_t* values) {
#define NODE(name, stage, format, model, when, rtl) \
  r->top->model_##name##_i = static_cast<uint64_t>(*values++);
#include "coprocessor/nodes.def"
}

constexpr capsoc_rtl_inside inside = {capsoc_rtl_state_layout,
                                      sizeof names / sizeof names[0],
                                      names,
                                      clock_on,
                                      nodes,
                                      model_nodes,
                                      pairs,
                                      save,
                                      restore,
                                      get_state,
                                      set_state};

constexpr capsoc_rtl_api api = capsoc::rtl::api_of<capsoc_rtl>(0, &inside);

}  // namespace

extern "C" __attribute__((visibility("default"))) const capsoc_rtl_api* capsoc_rtl_entry() {
  return &api;
}
