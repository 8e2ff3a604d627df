#include "cmsdk/watchdog.h"

#include <fmt/format.h>

namespace capsoc::cmsdk {
namespace {

using registers::Access;
using registers::RegisterDescription;

using kit::all_bits;
constexpr uint32_t lock_offset = 0xc00;
constexpr uint32_t test_reset = 1u << 0;
constexpr uint32_t test_interrupt = 1u << 1;

RegisterDescription starting_full(const char* name, uint32_t offset, Access access) {
  RegisterDescription description = describe_register(name, offset, access, all_bits);
  description.reset = all_bits;
  return description;
}

}  // namespace

Watchdog::Watchdog(const sc_core::sc_module_name& name, kit::ClockDomain& clock)
    : kit::ClockedBank(name, clock),
      LOAD(*this, starting_full("WDOGLOAD", 0x000, Access::read_write)),
      VALUE(*this, starting_full("WDOGVALUE", 0x004, Access::read_only)),
      CONTROL(*this, describe_register("WDOGCONTROL", 0x008, Access::read_write, 3)),
      INTCLR(*this, describe_register("WDOGINTCLR", 0x00c, Access::write_only, all_bits)),
      RIS(*this, describe_register("WDOGRIS", 0x010, Access::read_only, 1)),
      MIS(*this, describe_register("WDOGMIS", 0x014, Access::read_only, 1)),
      LOCK(*this, describe_register("WDOGLOCK", lock_offset, Access::read_write, all_bits)),
      ITCR(*this, describe_register("WDOGITCR", 0xf00, Access::read_write, 1)),
      ITOP(*this, describe_register("WDOGITOP", 0xf04, Access::write_only, 3)),
      id(*this, PartNumber::watchdog) {
  LOAD.on_write([this](uint32_t value) {
    LOAD.store(value);
    restart();
  });
  VALUE.on_peek([this] { return counter_.value_at(now()); });
  CONTROL.on_write([this](uint32_t value) { write_control(value); });
  INTCLR.on_write([this](uint32_t) {
    RIS.set(0);
    restart();
    follow();
  });
  MIS.on_peek([this] { return masked_interrupt() ? 1u : 0u; });
  // Reads 1 while locked.
  LOCK.on_write([this](uint32_t value) { LOCK.set(value == unlock_word ? 0 : 1); });
  for (kit::Register* test : {&ITCR, &ITOP})
    test->on_write([this, test](uint32_t value) {
      test->store(value);
      follow();
    });
  reset();
}

void Watchdog::reset() {
  reset_registers();
  expired_ = false;
  counter_.stop();
  counter_.advance(now());
  restart();
  follow();
  plan();
}

void Watchdog::restart() {
  counter_.reload = LOAD.get();
  counter_.set_value(LOAD.get());
}

void Watchdog::write_control(uint32_t value) {
  const bool was_counting = CONTROL.any(control_interrupt);
  CONTROL.store(value);
  if (!CONTROL.any(control_interrupt)) {
    counter_.stop();
  } else if (!was_counting) {
    restart();
    counter_.start();
  }
  follow();
}

bool Watchdog::write_word(uint32_t offset, uint32_t value, uint32_t lanes) {
  if (LOCK.any(1) && offset != lock_offset) {
    report(
        fmt::format("write of 0x{:08x} at 0x{:03x} while locked; write 0x{:08x} to WDOGLOCK first",
                    value, offset, unlock_word));
    return true;
  }
  return ClockedBank::write_word(offset, value, lanes);
}

void Watchdog::advance(uint64_t cycle) {
  // Zero by zero: the second one in a row means something else than the first.
  while (counter_.next_zero() <= cycle) {
    counter_.advance(counter_.next_zero());
    if (RIS.any(1)) {
      expired_ = true;
      counter_.stop();
    }
    RIS.set(1);
  }
  counter_.advance(cycle);
  follow();
}

uint64_t Watchdog::next_change() const {
  return counter_.next_zero();
}

void Watchdog::follow() {
  if (ITCR.any(1)) {  // integration test mode drives the outputs from WDOGITOP
    interrupt.set(ITOP.any(test_interrupt));
    reset_request.set(ITOP.any(test_reset));
    return;
  }
  interrupt.set(masked_interrupt());
  reset_request.set(expired_ && CONTROL.any(control_reset));
}

void Watchdog::visit(Archive& archive) {
  ClockedBank::visit(archive);
  counter_.visit(archive, edge_of(archive));
  archive("expired", expired_);
}

}  // namespace capsoc::cmsdk
