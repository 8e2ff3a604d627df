#include "cmsdk/dual_timer.h"

#include <algorithm>

namespace capsoc::cmsdk {
namespace {

using registers::Access;
using registers::RegisterDescription;

using kit::all_bits;
constexpr uint32_t unit_size = 0x20;
constexpr uint32_t control_bits = DualTimer::control_one_shot | DualTimer::control_32_bit |
                                  DualTimer::control_prescale | DualTimer::control_interrupt |
                                  DualTimer::control_periodic | DualTimer::control_enable;

// Register names in the order of both units; the description keeps a pointer.
constexpr const char* names[2][7] = {{"TIMER1LOAD", "TIMER1VALUE", "TIMER1CONTROL", "TIMER1INTCLR",
                                      "TIMER1RIS", "TIMER1MIS", "TIMER1BGLOAD"},
                                     {"TIMER2LOAD", "TIMER2VALUE", "TIMER2CONTROL", "TIMER2INTCLR",
                                      "TIMER2RIS", "TIMER2MIS", "TIMER2BGLOAD"}};

RegisterDescription describe(unsigned number, unsigned index, Access access, uint32_t bits,
                             uint32_t reset = 0) {
  RegisterDescription description =
      describe_register(names[number][index], number * unit_size + index * 4, access, bits);
  description.reset = reset;
  return description;
}

}  // namespace

DualTimer::Unit::Unit(DualTimer& owner, unsigned number)
    : LOAD(owner, describe(number, 0, Access::read_write, all_bits)),
      VALUE(owner, describe(number, 1, Access::read_only, all_bits, all_bits)),
      CONTROL(owner, describe(number, 2, Access::read_write, control_bits, control_interrupt)),
      INTCLR(owner, describe(number, 3, Access::write_only, all_bits)),
      RIS(owner, describe(number, 4, Access::read_only, 1)),
      MIS(owner, describe(number, 5, Access::read_only, 1)),
      BGLOAD(owner, describe(number, 6, Access::read_write, all_bits)),
      owner_(owner) {
  LOAD.on_write([this](uint32_t value) { write_load(value); });
  BGLOAD.on_peek([this] { return LOAD.get(); });
  BGLOAD.on_write([this](uint32_t value) {
    LOAD.set(value);
    configure();
  });
  VALUE.on_peek([this] { return shown(counter_.value_at(owner_.now())); });
  CONTROL.on_write([this](uint32_t value) { write_control(value); });
  INTCLR.on_write([this](uint32_t) {
    RIS.set(0);
    owner_.follow();
  });
  MIS.on_peek([this] { return masked_interrupt() ? 1u : 0u; });
}

void DualTimer::Unit::reset() {
  counter_.stop();
  counter_.advance(owner_.now());
  counter_.set_value(0xffff);
  upper_ = 0xffff0000;
  configure();
}

void DualTimer::Unit::advance(uint64_t cycle) {
  if (counter_.advance(cycle)) RIS.set(1);
}

uint32_t DualTimer::Unit::shown(uint32_t count) const {
  return wide() ? count : upper_ | count;
}

void DualTimer::Unit::write_load(uint32_t value) {
  LOAD.set(value);
  upper_ = value & 0xffff0000;
  counter_.set_value(value & width_mask());
  configure();
}

void DualTimer::Unit::write_control(uint32_t value) {
  if ((value & control_prescale) == control_prescale)
    owner_.report("PRESCALE 3 is undefined: the timer divides by 256");
  const uint32_t count = shown(counter_.value());
  CONTROL.store(value);
  upper_ = count & 0xffff0000;
  if ((count & width_mask()) != counter_.value()) counter_.set_value(count & width_mask());
  configure();
  owner_.follow();
}

/// Brings the counter's settings in line with CONTROL and LOAD.
void DualTimer::Unit::configure() {
  constexpr uint32_t divisors[4] = {1, 16, 256, 256};
  counter_.set_divisor(divisors[(CONTROL.get() & control_prescale) >> 2]);
  counter_.one_shot = CONTROL.any(control_one_shot);
  counter_.reload = CONTROL.any(control_periodic) ? LOAD.get() & width_mask() : width_mask();
  if (CONTROL.any(control_enable)) {
    counter_.start();
  } else {
    counter_.stop();
  }
}

DualTimer::DualTimer(const sc_core::sc_module_name& name, kit::ClockDomain& clock)
    : kit::ClockedBank(name, clock),
      timer1(*this, 0),
      timer2(*this, 1),
      ITCR(*this, describe_register("TIMERITCR", 0xf00, Access::read_write, 1)),
      ITOP(*this, describe_register("TIMERITOP", 0xf04, Access::write_only, 3)),
      id(*this, PartNumber::dual_timer) {
  for (kit::Register* test : {&ITCR, &ITOP})
    test->on_write([this, test](uint32_t value) {
      test->store(value);
      follow();
    });
  reset();
}

void DualTimer::reset() {
  reset_registers();
  timer1.reset();
  timer2.reset();
  follow();
  plan();
}

void DualTimer::advance(uint64_t cycle) {
  timer1.advance(cycle);
  timer2.advance(cycle);
  follow();
}

uint64_t DualTimer::next_change() const {
  // A zero that finds the interrupt pending, or not enabled, changes nothing outside.
  uint64_t next = never;
  for (const Unit* unit : {&timer1, &timer2})
    if (unit->CONTROL.any(control_interrupt) && !unit->RIS.any(1))
      next = std::min(next, unit->counter_.next_zero());
  return next;
}

void DualTimer::follow() {
  // Integration test mode drives the outputs from TIMERITOP.
  interrupt.set(ITCR.any(1) ? ITOP.any(3) : timer1.masked_interrupt() || timer2.masked_interrupt());
}

void DualTimer::visit(Archive& archive) {
  ClockedBank::visit(archive);
  for (Unit* unit : {&timer1, &timer2}) {
    unit->counter_.visit(archive, edge_of(archive));
    archive("upper", unit->upper_);
  }
}

}  // namespace capsoc::cmsdk
