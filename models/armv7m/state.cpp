#include "armv7m/state.h"

#include <utility>

#include "base/archive.h"

namespace capsoc::armv7m {

void LostWrite::visit(Archive& archive) {
  archive("known", known);
  archive("address", address);
  archive("value", value);
  archive("instruction", instruction);
  archive("cycle", cycle);
}

void InterruptedRegisters::visit(Archive& archive) {
  archive("r", r);
  archive("msp", msp);
  archive("psp", psp);
  archive("ipsr", ipsr);
}

void FaultReport::visit(Archive& archive) {
  archive.at_most("kind", kind, Kind::lockup);
  archive("exception", exception);
  archive("cfsr", cfsr);
  archive("hfsr", hfsr);
  archive("mmfar", mmfar);
  archive("bfar", bfar);
  archive("frame", frame);
  archive("address", address);
  archive("nesting", nesting);
  archive("cycle", cycle);
  archive("registers", registers);
  archive("lost_write", lost_write);
}

// Without `fpu`, which is only of some cores: Core::visit().
void State::visit(Archive& archive) {
  // Executors leave different words with the same flags; equal states are equal bytes.
  if (!archive.loading()) {
    n &= 0x80000000u;
    z = z == 0 ? 0 : 1;
  }
  archive("r", r);
  archive("n", n);
  archive("z", z);
  archive("c", c);
  archive("v", v);
  // GE lies above Q: the layout is that of a processor without.
  auto q_and_ge = static_cast<uint8_t>((q ? 1 : 0) | ge << 1);
  archive.at_most("q", q_and_ge, uint8_t{0x1F});
  q = (q_and_ge & 1) != 0;
  ge = q_and_ge >> 1;
  archive("pc", pc);
  archive("cycles", cycles);
  archive("instructions", instructions);
  archive("it_state", it_state);
  archive("stalled", stalled);
  archive("refilling", refilling);
  archive("trail", trail);
  archive("entered_at", entered_at);
  archive("thumb", thumb);
  archive("sleeping", sleeping);
  archive("sleeping_for_event", sleeping_for_event);
  archive("locked_up", locked_up);
  archive("reset_request", reset_request);
  archive("semihosting_exit", semihosting_exit);
  archive("semihosting_waits", semihosting_waits);
  archive("event_register", event_register);
  archive.at_most("ipsr", ipsr, 47u);
  archive.at_most("control", control, 7u);
  archive.at_most("primask", primask, 1u);
  archive.at_most("faultmask", faultmask, 1u);
  archive.at_most("basepri", basepri, 255u);
  archive("other_sp", other_sp);
  archive("exclusive", exclusive);
  archive("exclusive_address", exclusive_address);
  archive("nvic", nvic);
  archive("scb", scb);
  archive("systick", systick);
  archive("dwt", dwt);
  archive("itm", itm);
  archive("mpu", mpu);
  archive("last_fault", last_fault);
  archive("first_fault", first_fault);
  archive("fault_count", fault_count);
  archive("lost_write", lost_write);
  archive("unpredictable_seen", unpredictable_seen);
  archive("priority_told", priority_told);
  if ((pc & 1) != 0) archive.refuse("has an odd program counter");
}

void State::reset(const SystemRegisters& registers) {
  r.fill(0);
  n = 0;
  z = 1;
  c = v = q = false;
  ge = 0;
  control = primask = faultmask = basepri = ipsr = other_sp = 0;
  it_state = 0;
  trail = timing::no_trail;
  entered_at = never;
  sleeping = locked_up = reset_request = semihosting_exit = semihosting_waits = false;
  event_register = exclusive = false;
  last_fault = {};
  first_fault = {};
  lost_write = {};
  nvic.reset();
  scb.reset(registers);
  systick.reset(cycles);
  dwt.reset();
  itm.reset();
  mpu.reset();
  fpu.reset();
}

void State::set_reg(unsigned number, uint32_t value) {
  if (number == 13) {
    r[13] = value & ~3u;
  } else if (number == 15) {
    pc = value & ~1u;
    it_state = 0;
    trail = timing::no_trail;
    sleeping = locked_up = false;  // it continues there
  } else if (number < 15) {
    r[number] = value;
  }
}

uint32_t State::xpsr() const {
  const uint32_t it = it_state;
  return (n & 0x80000000u) | (z == 0 ? 1u << 30 : 0) | (c ? 1u << 29 : 0) | (v ? 1u << 28 : 0) |
         (q ? 1u << 27 : 0) | (it & 3) << 25 | (thumb ? 1u << 24 : 0) | uint32_t{ge} << 16 |
         (it >> 2) << 10 | ipsr;
}

void State::set_apsr(uint32_t value) {
  n = value;
  z = (value >> 30 & 1) != 0 ? 0 : 1;
  c = (value >> 29 & 1) != 0;
  v = (value >> 28 & 1) != 0;
  q = (value >> 27 & 1) != 0;
  ge = static_cast<uint8_t>(value >> 16 & 0xF);
}

void State::set_xpsr(uint32_t value) {
  set_apsr(value);
  thumb = (value >> 24 & 1) != 0;
  it_state = static_cast<uint8_t>((value >> 25 & 3) | (value >> 10 & 0x3F) << 2);
}

void State::select_stack(bool process) {
  if (process != uses_psp()) std::swap(r[13], other_sp);
}

void State::set_control(uint32_t value) {
  if (ipsr == 0) {
    select_stack((value & 2) != 0);
    control = value & 7;
  } else {
    control = (control & 2) | (value & 5);
  }
}

}  // namespace capsoc::armv7m
