#include "inject/bus_faults.h"

#include <utility>

namespace capsoc::inject {
namespace {

constexpr const char* no_access = "no such access came";

}  // namespace

BusFaults::~BusFaults() {
  if (!faults_.empty()) position_.soc.cpu.set_access_gate(nullptr);
}

std::optional<Error> BusFaults::add(Injected& injected, const Places& places) {
  const auto found = places.on_bus(injected.fault);
  if (!found) return Error{found.error()};
  injected.fault.bit = found.value().bit;
  faults_.push_back({&injected, found.value().address});
  return std::nullopt;
}

std::vector<const Injected*> BusFaults::waiting() const {
  std::vector<const Injected*> waiting;
  for (const OnBus& each : faults_)
    if (!each.is_armed && !each.injected->is_over) waiting.push_back(each.injected);
  return waiting;
}

void BusFaults::pause() {
  bool acts = false;
  for (OnBus& each : faults_) {
    Injected& injected = *each.injected;
    const Fault& fault = injected.fault;
    if (!each.is_armed && !injected.is_over && position_.reached(fault.when)) {
      each.is_armed = true;
      injected.outcome.note = no_access;
      if (fault.duration)
        injected.end = sc_core::sc_time_stamp() + sc_core::sc_time::from_value(*fault.duration);
    }
    if (std::exchange(each.has_acted, false))
      injected.outcome.instruction = position_.soc.cpu.core().instructions();
    acts = acts || (each.is_armed && !injected.is_over);
  }
  if (!faults_.empty()) position_.soc.cpu.set_access_gate(acts ? this : nullptr);
}

bool BusFaults::is_acting(OnBus& each, const Access& access) const {
  Injected& injected = *each.injected;
  if (injected.end && sc_core::sc_time_stamp() >= *injected.end) injected.is_over = true;
  if (!each.is_armed || injected.is_over) return false;
  if ((injected.fault.way == Fault::Way::write) != access.is_store) return false;
  uint64_t first = each.address, last = first + 3;
  if (injected.fault.is_of_bit()) first = last = each.address + injected.fault.bit / 8;
  return access.address <= last && first < uint64_t{access.address} + access.size;
}

void BusFaults::apply(OnBus& each, uint32_t before, uint32_t after) const {
  Injected& injected = *each.injected;
  if (!injected.outcome.applied) {
    each.has_acted = true;
    injected.outcome.note.clear();
  }
  position_.note(injected, before, after);
  injected.is_over = !injected.fault.is_stuck() && !injected.fault.duration;
  if (!injected.is_over && !each.has_acted) return;
  // pause() comes after this instruction; a block in which it is does not count it before.
  position_.soc.cpu.pause_soon();
  position_.soc.cpu.core().attention();
}

/// The access may begin in the middle of the register.
void BusFaults::change(OnBus& each, const Access& access, uint32_t& value) const {
  const Fault& fault = each.injected->fault;
  const uint32_t before = value;
  value = static_cast<uint32_t>(
      with_bit(fault, value, fault.bit + 8 * each.address - 8 * access.address));
  apply(each, before, value);
}

armv7m::AccessGate::Fate BusFaults::sent(const Access& access, uint32_t& value) {
  Fate fate = Fate::arrives;
  for (OnBus& each : faults_) {
    if (!is_acting(each, access)) continue;
    const Fault& fault = each.injected->fault;
    if (!fault.is_of_bit()) {
      fate = fault.kind == Fault::Kind::lose_write ? Fate::lost : Fate::fails;
      apply(each, 1, 0);
    } else if (access.is_store) {
      change(each, access, value);
    }
  }
  return fate;
}

void BusFaults::returned(const Access& access, uint32_t& value) {
  for (OnBus& each : faults_)
    if (each.injected->fault.is_of_bit() && is_acting(each, access)) change(each, access, value);
}

}  // namespace capsoc::inject
