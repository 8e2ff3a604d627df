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
#include "rtl/verilated_pins.h"
#include "rtl_hash.h"
#include "verilated.h"
#include "verilated_fst_c.h"
#include "verilated_save.h"
#if CAPSOC_RTL_COVERAGE
#include "verilated_cov.h"
#endif

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

struct capsoc_rtl {
  VerilatedContext context;
  std::unique_ptr<Vcoprocessor_probe> top;
  std::unique_ptr<VerilatedFstC> waves;
  uint64_t rise_ns = 0, fall_ns = 0;
  capsoc_rtl_pins pins{};
};

namespace {

void drive(capsoc_rtl& r) {
  capsoc::rtl::drive_pins(*r.top, r.pins);
  r.top->drive_i = 1;
  r.top->eval();
  r.top->drive_i = 0;
  r.top->eval();
}

void sample(capsoc_rtl& r) {
  const Vcoprocessor_probe& top = *r.top;
  capsoc_rtl_pins& p = r.pins;
  capsoc::rtl::fetch_pins(top, p);
  p.boundary = top.boundary_o;
  p.enter = top.enter_o;
  p.cycle = top.cycle_o;
  p.stage = top.stage_o;
  p.load = top.load_o;
  p.load_start = top.load_start_o;
  p.held = top.held_o;
  p.load_pending = top.load_pending_o;
  p.running = top.running_o;
  p.commit = top.commit_o;
}

void toggle(capsoc_rtl& r) {
  r.top->pclk_i = 1;
  r.top->eval();
  if (r.waves) r.waves->dump(r.rise_ns);
  r.top->pclk_i = 0;
  r.top->eval();
  if (r.waves) r.waves->dump(r.fall_ns);
}

capsoc_rtl* create() try {
  auto r = std::make_unique<capsoc_rtl>();
  r->context.traceEverOn(true);
  r->context.timeunit(-9);
  r->context.timeprecision(-9);
  r->top = std::make_unique<Vcoprocessor_probe>(&r->context, "rtl");
  // The first evaluation sees no edges, and the asynchronous reset needs its falling one.
  r->top->eval();
  r->pins.presetn = 1;
  drive(*r);
  r->pins.presetn = 0;
  drive(*r);
  sample(*r);
  return r.release();
} catch (const std::bad_alloc&) {
  return nullptr;
}

void close_waves(capsoc_rtl* r) {
  if (r->waves) r->waves->close();
  r->waves.reset();
}

void destroy(capsoc_rtl* r) {
  if (r == nullptr) return;
  close_waves(r);
  r->top->final();
  delete r;
}

capsoc_rtl_pins* pins(capsoc_rtl* r) {
  return &r->pins;
}

void eval(capsoc_rtl* r) {
  drive(*r);
  sample(*r);
}

void clock(capsoc_rtl* r) {
  toggle(*r);
  sample(*r);
}

uint64_t clock_on(capsoc_rtl* r, uint64_t count) {
  const Vcoprocessor_probe& top = *r->top;
  uint64_t made = 0;
  while (made < count && !top.boundary_o && !top.idle_o) {
    toggle(*r);
    ++made;
  }
  sample(*r);
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
  sample(*r);
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
  sample(*r);
}

int open_waves(capsoc_rtl* r, const char* file) {
  close_waves(r);
  r->waves = std::make_unique<VerilatedFstC>();
  r->top->trace(r->waves.get(), 99);
  r->waves->open(file);
  if (r->waves->isOpen()) return 1;
  r->waves.reset();
  return 0;
}

void model_nodes(capsoc_rtl* r, const int64_t* values) {
#define NODE(name, stage, format, model, when, rtl) \
  r->top->model_##name##_i = static_cast<uint64_t>(*values++);
#include "coprocessor/nodes.def"
}

void wave_time(capsoc_rtl* r, uint64_t rise_ns, uint64_t fall_ns) {
  r->rise_ns = rise_ns;
  r->fall_ns = fall_ns;
}

int write_coverage(capsoc_rtl* r, const char* file) {
#if CAPSOC_RTL_COVERAGE
  r->context.coveragep()->write(file);
  return 1;
#else
  static_cast<void>(r);
  static_cast<void>(file);
  return 0;
#endif
}

constexpr capsoc_rtl_api api = {CAPSOC_RTL_ABI_VERSION,
                                sizeof(capsoc_rtl_pins),
                                sizeof(capsoc_rtl_state),
                                CAPSOC_RTL_SOURCE_HASH,
                                CAPSOC_RTL_PAPER,
                                CAPSOC_RTL_OPERAND_BITS,
                                CAPSOC_RTL_REFERENCE_LEAD,
                                CAPSOC_RTL_STEP_SHIFT,
                                CAPSOC_RTL_PLAIN_ARCTANGENT,
                                CAPSOC_RTL_COVERAGE,
                                sizeof names / sizeof names[0],
                                names,
                                create,
                                destroy,
                                pins,
                                eval,
                                clock,
                                clock_on,
                                nodes,
                                pairs,
                                save,
                                restore,
                                get_state,
                                set_state,
                                open_waves,
                                model_nodes,
                                wave_time,
                                close_waves,
                                write_coverage};

}  // namespace

extern "C" __attribute__((visibility("default"))) const capsoc_rtl_api* capsoc_rtl_entry() {
  return &api;
}
