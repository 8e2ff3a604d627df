#include "armv7m/floating_point.h"

#include <algorithm>
#include <array>

namespace capsoc::armv7m {
namespace {

constexpr unsigned saved_words = Fpu::stacked + 1;  // and FPSCR

uint32_t saved_word(const Fpu& fpu, unsigned n) {
  return n < Fpu::stacked ? fpu.s(n) : fpu.status().bits();
}

}  // namespace

Access FloatingPoint::begin_slowly(const Step& op) {
  State& state = context_.state;
  if (!state.fpu.enabled(state.privileged())) {
    context_.fault(op, Cause::no_coprocessor);
    return Access::fault;
  }
  Access access = Access::ok;
  if (state.fpu.save_is_due()) access = preserve(op);
  if (access == Access::fault) return access;
  if (state.fpu.counts_contexts() && !state.has_fp_context()) {
    state.fpu.begin_context();
    state.control |= State::control_fpca;
  }
  return access;
}

/// PreserveFPState. The accesses have the privilege and the priority of the context that the
/// registers belong to.
Access FloatingPoint::preserve(const Step& op) {
  State& state = context_.state;
  Fpu& fpu = state.fpu;
  const bool privileged = fpu.context_is_privileged();
  const bool at_negative_priority = !fpu.ready(Fpu::Ready::hard_fault);
  state.pc = op.address;
  state.cycles += context_.profile.timing.fp_state;
  context_.cycle_offset = op.cycles_before;
  BusResult worst = BusResult::ok;
  for (unsigned n = 0; n < saved_words && worst <= BusResult::device; ++n)
    worst = std::max(worst, memory_.write(fpu.save_address() + 4 * n, 4, saved_word(fpu, n),
                                          privileged, at_negative_priority));
  context_.cycle_offset = 0;
  const bool failed = worst > BusResult::device;
  if (failed) {
    if (!pend(worst == BusResult::bus_error ? Cause::lazy_bus : Cause::lazy_access)) {
      context_.event.kind = Event::Kind::lockup;
      return Access::fault;
    }
    // Taken now, it leaves the save due; taken later, what could not be saved is lost.
    if (pending_.highest_pending(pending_.execution_priority()) != 0) {
      context_.event.kind = Event::Kind::abandoned;
      return Access::fault;
    }
  }
  fpu.save_is_done();
  return worst == BusResult::ok ? Access::ok : Access::leave;
}

/// The fault is that of the context: it escalates if it could not have preempted that. False: not
/// even HardFault could.
bool FloatingPoint::pend(Cause cause) {
  State& state = context_.state;
  unsigned number = state.scb.record(cause, 0);
  const uint32_t able =
      number == exception::mem_manage ? Fpu::Ready::mem_manage : Fpu::Ready::bus_fault;
  if (!state.fpu.ready(able)) {
    state.scb.record_forced();
    if (!state.fpu.ready(Fpu::Ready::hard_fault)) return false;
    number = exception::hard_fault;
  }
  pending_.pend(number);
  return true;
}

/// The exceptions that could preempt the present code.
uint32_t FloatingPoint::ready() const {
  const int priority = pending_.execution_priority();
  const auto able = [&](unsigned number, uint32_t bit) {
    return pending_.enabled(number) && pending_.group_priority(number) < priority ? bit : 0;
  };
  return able(exception::hard_fault, Fpu::Ready::hard_fault) |
         able(exception::mem_manage, Fpu::Ready::mem_manage) |
         able(exception::bus_fault, Fpu::Ready::bus_fault) |
         (pending_.monitor_can_preempt() ? Fpu::Ready::monitor : 0);
}

std::optional<Cause> FloatingPoint::push(uint32_t address, bool stacked) {
  State& state = context_.state;
  const bool privileged = state.privileged();
  if (state.fpu.saves_lazily()) {
    state.fpu.allocate(address, ready(), state.ipsr == 0, privileged);
    return std::nullopt;
  }
  if (!stacked) return std::nullopt;
  if (!state.fpu.enabled(privileged)) return Cause::no_coprocessor;
  state.cycles += context_.profile.timing.fp_state;
  for (unsigned n = 0; n < saved_words; ++n) {
    const BusResult result =
        memory_.write(address + 4 * n, 4, saved_word(state.fpu, n), privileged);
    if (result <= BusResult::device) continue;
    return result == BusResult::bus_error ? Cause::stacking_bus : Cause::stacking_access;
  }
  return std::nullopt;
}

std::optional<Cause> FloatingPoint::pop(uint32_t address, bool privileged) {
  State& state = context_.state;
  Fpu& fpu = state.fpu;
  if (fpu.save_is_due()) {
    fpu.save_is_done();  // they are as they were
    return std::nullopt;
  }
  if (!fpu.enabled(state.privileged())) return Cause::no_coprocessor;
  state.cycles += context_.profile.timing.fp_state;
  std::array<uint32_t, saved_words> words{};
  for (unsigned n = 0; n < saved_words; ++n) {
    const BusResult result = memory_.read(address + 4 * n, 4, words[n], privileged);
    if (result <= BusResult::device) continue;
    return result == BusResult::bus_error ? Cause::unstacking_bus : Cause::unstacking_access;
  }
  for (unsigned n = 0; n < Fpu::stacked; ++n) fpu.set_s(n, words[n]);
  fpu.status() = Fpscr(words[Fpu::stacked]);
  return std::nullopt;
}

}  // namespace capsoc::armv7m
