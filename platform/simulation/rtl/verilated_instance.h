// An instance of a class that Verilator made of a design with the coprocessor's pins, and those
// functions of rtl_abi.h that need no more. A library includes it once, after its `struct
// capsoc_rtl`, which has a member of this type.
#pragma once

#include <memory>
#include <new>

#include "rtl/rtl_abi.h"
#include "rtl/verilated_pins.h"
#include "rtl_hash.h"
#include "verilated.h"
#include "verilated_fst_c.h"
#if CAPSOC_RTL_COVERAGE
#include "verilated_cov.h"
#endif

namespace capsoc::rtl {

/// `Top` takes its inputs over at the rising edge of drive_i.
template <typename Top>
struct VerilatedInstance {
  VerilatedContext context;
  std::unique_ptr<Top> top;
  std::unique_ptr<VerilatedFstC> waves;
  uint64_t rise_ns = 0, fall_ns = 0;
  capsoc_rtl_pins pins{};

  VerilatedInstance() {
#if CAPSOC_RTL_RANDOM_START
    // What no reset reaches begins with anything, the same in every run.
    context.randReset(2);
    context.randSeed(CAPSOC_RTL_RANDOM_START);
#endif
    context.traceEverOn(true);
    context.timeunit(-9);
    context.timeprecision(-9);
    top = std::make_unique<Top>(&context, "rtl");
    top->pclk_i = top->drive_i = 0;
    // The first evaluation sees no edges, and an asynchronous reset needs its own.
    top->eval();
    pins.presetn = 1;
    drive();
    pins.presetn = 0;
    drive();
  }

  ~VerilatedInstance() {
    close_waves();
    top->final();
    // The scopes of a design with assertions leave the context of the thread, which may be
    // another instance's and gone.
    Verilated::threadContextp(&context);
  }

  VerilatedInstance(const VerilatedInstance&) = delete;
  VerilatedInstance& operator=(const VerilatedInstance&) = delete;

  void drive() {
    drive_pins(*top, pins);
    top->drive_i = 1;
    top->eval();
    top->drive_i = 0;
    top->eval();
  }

  void toggle() {
    top->pclk_i = 1;
    top->eval();
    if (waves) waves->dump(rise_ns);
    top->pclk_i = 0;
    top->eval();
    if (waves) waves->dump(fall_ns);
  }

  int open_waves(const char* file) {
    close_waves();
    waves = std::make_unique<VerilatedFstC>();
    top->trace(waves.get(), 99);
    waves->open(file);
    if (waves->isOpen()) return 1;
    waves.reset();
    return 0;
  }

  void close_waves() {
    if (waves) waves->close();
    waves.reset();
  }

  int write_coverage([[maybe_unused]] const char* file) {
#if CAPSOC_RTL_COVERAGE
    context.coveragep()->write(file);
    return 1;
#else
    return 0;
#endif
  }
};

/// The table of a library whose `capsoc_rtl` has `sample()`, by which outputs go to the pins.
template <typename Rtl>
constexpr capsoc_rtl_api api_of(uint32_t absent_pins, const capsoc_rtl_inside* inside) {
  capsoc_rtl_api api{};
  api.abi_version = CAPSOC_RTL_ABI_VERSION;
  api.pins_size = sizeof(capsoc_rtl_pins);
  api.source_hash = CAPSOC_RTL_SOURCE_HASH;
  api.paper = CAPSOC_RTL_PAPER;
  api.operand_bits = CAPSOC_RTL_OPERAND_BITS;
  api.reference_lead = CAPSOC_RTL_REFERENCE_LEAD;
  api.step_shift = CAPSOC_RTL_STEP_SHIFT;
  api.plain_arctangent = CAPSOC_RTL_PLAIN_ARCTANGENT;
  api.iteration_clocks = CAPSOC_RTL_ITERATION_CLOCKS;
  api.channels = CAPSOC_RTL_CHANNELS;
  api.coverage = CAPSOC_RTL_COVERAGE;
  api.absent_pins = absent_pins;
  api.create = []() -> Rtl* {
    try {
      auto r = std::make_unique<Rtl>();
      r->sample();
      return r.release();
    } catch (const std::bad_alloc&) {
      return nullptr;
    }
  };
  api.destroy = [](Rtl* r) { delete r; };
  api.pins = [](Rtl* r) { return &r->pins; };
  api.eval = [](Rtl* r) {
    r->drive();
    r->sample();
  };
  api.clock = [](Rtl* r) {
    r->toggle();
    r->sample();
  };
  api.open_waves = [](Rtl* r, const char* file) { return r->open_waves(file); };
  api.wave_time = [](Rtl* r, uint64_t rise_ns, uint64_t fall_ns) {
    r->rise_ns = rise_ns;
    r->fall_ns = fall_ns;
  };
  api.close_waves = [](Rtl* r) { r->close_waves(); };
  api.write_coverage = [](Rtl* r, const char* file) { return r->write_coverage(file); };
  api.inside = inside;
  return api;
}

}  // namespace capsoc::rtl
