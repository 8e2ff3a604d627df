#include "cortex_m3/state.h"

#include "kit/archive.h"

namespace capsoc::cortex_m3 {
void NvicState::visit(kit::Archive& archive) {
  archive("pending", pending);
  archive("active", active);
  archive("enabled", enabled);
  archive("lines", lines);
  archive("priority", priority);
  constexpr uint64_t exceptions = (uint64_t{1} << 48) - 1;
  if (((pending | active | enabled) & ~exceptions) != 0) archive.refuse("has exceptions above 47");
}

void ScbState::visit(kit::Archive& archive) {
  archive("vtor", vtor);
  archive.at_most("prigroup", prigroup, 7u);
  archive("scr", scr);
  archive("ccr", ccr);
  archive("shcsr", shcsr);
  archive("cfsr", cfsr);
  archive("hfsr", hfsr);
  archive("mmfar", mmfar);
  archive("bfar", bfar);
  archive("dfsr", dfsr);
  archive("actlr", actlr);
  archive("demcr", demcr);
}

void SystickState::visit(kit::Archive& archive) {
  archive("csr", csr);
  archive("rvr", rvr);
  archive("start", start);
  archive("countflag", countflag);
  archive("start_cycle", start_cycle);
  archive("event", event);
  archive("reference", reference);
  if (reference == 0) archive.refuse("has a reference clock that stands still");
}

void DwtState::visit(kit::Archive& archive) {
  archive("ctrl", ctrl);
  archive("cyccnt_base", cyccnt_base);
  archive("cyccnt_stopped", cyccnt_stopped);
  archive("comparator", comparator);
  archive("mask", mask);
  archive("function", function);
  archive("count_seen", count_seen);
}

void ItmState::visit(kit::Archive& archive) {
  archive("ter", ter);
  archive("tpr", tpr);
  archive("tcr", tcr);
  archive("unlocked", unlocked);
}

void MpuState::visit(kit::Archive& archive) {
  archive("ctrl", ctrl);
  archive.at_most("rnr", rnr, 7u);
  archive("rbar", rbar);
  archive("rasr", rasr);
}

void FaultReport::visit(kit::Archive& archive) {
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
}

void State::visit(kit::Archive& archive) {
  archive("r", r);
  archive("n", n);
  archive("z", z);
  archive("c", c);
  archive("v", v);
  archive("q", q);
  archive("pc", pc);
  archive("cycles", cycles);
  archive("instructions", instructions);
  archive("it_state", it_state);
  archive("stalled", stalled);
  archive("trail", trail);
  archive("entered_at", entered_at);
  archive("thumb", thumb);
  archive("sleeping", sleeping);
  archive("sleeping_for_event", sleeping_for_event);
  archive("locked_up", locked_up);
  archive("reset_request", reset_request);
  archive("semihosting_exit", semihosting_exit);
  archive("event_register", event_register);
  archive.at_most("ipsr", ipsr, 47u);
  archive.at_most("control", control, 3u);
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
  archive("unpredictable_seen", unpredictable_seen);
  archive("priority_told", priority_told);
  if ((pc & 1) != 0) archive.refuse("has an odd program counter");
}

}  // namespace capsoc::cortex_m3
