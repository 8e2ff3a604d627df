// The Verilated netlist of the mutants, with the interface of mutants_abi.h.
#include <new>

#include "Vmutants.h"
#include "mutants_abi.h"
#ifdef CAPSOC_FAULTS
#include "Vmutants_faults.h"
#endif
#include "rtl/verilated_pins.h"
#include "verilated.h"

struct capsoc_mutants {
  VerilatedContext context;
  Vmutants top{&context};
  capsoc_rtl_pins pins{};
};

namespace {

void drive(capsoc_mutants& m) {
  capsoc::rtl::drive_pins(m.top, m.pins);
}

void fetch(capsoc_mutants& m) {
  capsoc::rtl::fetch_pins(m.top, m.pins);
}

capsoc_mutants* create(unsigned mutant) {
  auto* m = new (std::nothrow) capsoc_mutants;
  if (m == nullptr) return nullptr;
#ifdef CAPSOC_FAULTS
  m->top.__PVT__faults->selected = mutant;  // scripts/tool regression_faults
#else
  m->top.mutant = mutant;  // scripts/tool mutation
#endif
  m->top.pclk_i = 0;
  drive(*m);
  m->top.eval();
  return m;
}

void eval(capsoc_mutants* m) {
  drive(*m);
  m->top.eval();
  fetch(*m);
}

void clock(capsoc_mutants* m) {
  // What the inputs lead to settles before the registers take it.
  drive(*m);
  m->top.pclk_i = 1;
  m->top.eval();
  m->top.pclk_i = 0;
  m->top.eval();
  fetch(*m);
}

const capsoc_mutants_api api = {create, [](capsoc_mutants* m) { delete m; },
                                [](capsoc_mutants* m) { return &m->pins; }, eval, clock};

}  // namespace

extern "C" __attribute__((visibility("default"))) const capsoc_mutants_api* capsoc_mutants_entry() {
  return &api;
}
