#include "cmsdk/timer.h"

#include <algorithm>

namespace capsoc::peripherals {
namespace {

using registers::Access;

constexpr uint8_t part_number = 0x22;
constexpr uint32_t all_bits = 0xffffffff;

constexpr registers::RegisterDescription interrupt_description = {
    "INTSTATUS", 0x00c, Access::read_write, 0, 0, 1, 1};

}  // namespace

Timer::Timer(const sc_core::sc_module_name& name, tlm_util::ClockDomain& clock)
    : ClockedBank(name, clock),
      CTRL(*this, describe_register("CTRL", 0x000, Access::read_write, 0xf)),
      VALUE(*this, describe_register("VALUE", 0x004, Access::read_write, all_bits)),
      RELOAD(*this, describe_register("RELOAD", 0x008, Access::read_write, all_bits)),
      INTSTATUS(*this, interrupt_description),
      id(*this, part_number) {
  CTRL.on_write([this](uint32_t value) {
    CTRL.store(value);
    if (CTRL.any(ctrl_external_enable | ctrl_external_clock))
      report("EXTIN is not connected: the timer does not count");
  });
  VALUE.on_peek([this] { return value_at(std::max(now(), anchor_cycle_)); });
  VALUE.on_write([this](uint32_t value) { set_counter(value); });
  RELOAD.on_write([this](uint32_t value) {
    RELOAD.store(value);
    set_counter(value);
  });
  INTSTATUS.on_write([this](uint32_t value) {
    INTSTATUS.store(value);
    interrupt.set(INTSTATUS.any(1));
  });
}

void Timer::reset() {
  reset_registers();
  anchor_cycle_ = now();
  interrupt.set(false);
  plan();
}

bool Timer::counting() const {
  return CTRL.any(ctrl_enable) && !CTRL.any(ctrl_external_enable | ctrl_external_clock);
}

uint32_t Timer::value_at(uint64_t cycle) const {
  const uint64_t start = VALUE.get();
  const uint64_t elapsed = cycle - anchor_cycle_;
  if (!counting()) return static_cast<uint32_t>(start);
  if (elapsed <= start) return static_cast<uint32_t>(start - elapsed);
  const uint64_t period = uint64_t{RELOAD.get()} + 1;
  return static_cast<uint32_t>(RELOAD.get() - (elapsed - start - 1) % period);
}

uint64_t Timer::next_zero() const {
  if (!counting()) return never;
  if (VALUE.get() != 0) return anchor_cycle_ + VALUE.get();
  return RELOAD.get() != 0 ? anchor_cycle_ + 1 + RELOAD.get() : never;
}

void Timer::set_counter(uint32_t value) {
  VALUE.set(value);  // advance() has put the anchor at the edge of this access
}

void Timer::advance(uint64_t cycle) {
  if (cycle <= anchor_cycle_) return;
  if (CTRL.any(ctrl_interrupt) && next_zero() <= cycle) INTSTATUS.raise(1);
  VALUE.set(value_at(cycle));
  anchor_cycle_ = cycle;
  interrupt.set(INTSTATUS.any(1));
}

uint64_t Timer::next_change() const {
  // A zero that finds the interrupt pending, or not enabled, changes nothing outside.
  return CTRL.any(ctrl_interrupt) && !INTSTATUS.any(1) ? next_zero() : never;
}

}  // namespace capsoc::peripherals
