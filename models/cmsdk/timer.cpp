#include "cmsdk/timer.h"

namespace capsoc::cmsdk {
namespace {

using registers::Access;

using kit::all_bits;

constexpr registers::RegisterDescription timer_interrupts = {
    "INTSTATUS", 0x00c, Access::read_write, 0, 0, 1, 1};

}  // namespace

Timer::Timer(const sc_core::sc_module_name& name, kit::ClockDomain& clock)
    : kit::ClockedBank(name, clock),
      CTRL(*this, describe_register("CTRL", 0x000, Access::read_write, 0xf)),
      VALUE(*this, describe_register("VALUE", 0x004, Access::read_write, all_bits)),
      RELOAD(*this, describe_register("RELOAD", 0x008, Access::read_write, all_bits)),
      INTSTATUS(*this, timer_interrupts),
      id(*this, PartNumber::timer) {
  CTRL.on_write([this](uint32_t value) {
    CTRL.store(value);
    const bool external = CTRL.any(ctrl_external_enable | ctrl_external_clock);
    if (external) report("EXTIN is not connected: the timer does not count");
    if (CTRL.any(ctrl_enable) && !external) {
      counter_.start();
    } else {
      counter_.stop();
    }
  });
  // Every access first advances the counter to its edge (ClockedBank), a debugger's excepted.
  VALUE.on_peek([this] { return counter_.value_at(now()); });
  VALUE.on_write([this](uint32_t value) { counter_.set_value(value); });
  RELOAD.on_write([this](uint32_t value) {
    RELOAD.store(value);
    counter_.reload = value;
    counter_.set_value(value);
  });
  INTSTATUS.on_write([this](uint32_t value) {
    INTSTATUS.store(value);
    interrupt.set(INTSTATUS.any(1));
  });
}

void Timer::reset() {
  reset_registers();
  counter_.stop();
  counter_.advance(now());
  counter_.reload = 0;
  counter_.set_value(0);
  interrupt.set(false);
  plan();
}

void Timer::advance(uint64_t cycle) {
  if (counter_.advance(cycle) && CTRL.any(ctrl_interrupt)) INTSTATUS.raise(1);
  interrupt.set(INTSTATUS.any(1));
}

uint64_t Timer::next_change() const {
  // A zero that finds the interrupt pending, or not enabled, changes nothing outside.
  return CTRL.any(ctrl_interrupt) && !INTSTATUS.any(1) ? counter_.next_zero() : never;
}

void Timer::visit(Archive& archive) {
  ClockedBank::visit(archive);
  counter_.visit(archive, edge_of(archive));
}

}  // namespace capsoc::cmsdk
