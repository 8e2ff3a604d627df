#include "armv7m/executors/stepping.h"

#include "armv7m/executors/execute.h"
#include "armv7m/isa/decoder.h"

namespace capsoc::armv7m {

bool Stepping::fetch(uint32_t address, uint16_t& halfword) {
  const auto cause = machine_.memory.fetch(address, halfword);
  return !cause || machine_.fault(machine_.state.pc, *cause, address);
}

/// The instruction at an address, which was fetched as these halfwords.
const Step& Stepping::decoded(uint32_t address, uint16_t first, uint16_t second) {
  constexpr std::size_t places = 1024;
  if (decoded_.empty()) decoded_.resize(places);
  Step& step = decoded_[(address >> 1) % places];
  const uint32_t encoding = is_wide(first) ? uint32_t{first} << 16 | second : first;
  const uint8_t it_state = machine_.state.it_state;
  const bool same = step.body != nullptr && step.address == address && step.encoding == encoding &&
                    step.it_before == it_state;
  if (same) return step;
  step = {};
  static_cast<DecodedOp&>(step) = decode(address, first, second, it_state, machine_.profile);
  step.instructions_to = 1;
  Execute::bind(step);
  return step;
}

/// The instruction that cannot be executed takes a cycle.
void Stepping::faulted() {
  machine_.state.cycles += 1;
  machine_.handle_event();
}

void Stepping::run(uint64_t) {
  step(nullptr);
}

bool Stepping::step(bool (*permits)(const DecodedOp&)) {
  State& state = machine_.state;
  uint16_t first = 0, second = 0;
  const uint32_t address = state.pc;
  if (!fetch(address, first) || (is_wide(first) && !fetch(address + 2, second))) {
    faulted();
    if (machine_.counts != nullptr) machine_.counts->moved(address, state.pc);
    return true;
  }
  Step step = decoded(address, first, second);
  if (machine_.counts != nullptr) machine_.counts->decoded(step);
  if (Execute::cannot_continue(step)) {
    machine_.fault(step, Cause::invalid_state);
    faulted();
    if (machine_.counts != nullptr) machine_.counts->moved(address, state.pc);
    return true;
  }
  if (permits != nullptr && !permits(step)) return false;
  Execute::add_cycles(machine_, step, state.trail, machine_.memory.map().wait_states(address));
  BlockLinks::arrive(state, step);
  const Listeners& listeners = machine_.listeners;
  if (listeners.sees_instructions) listeners.observer->issued(machine_.core(), step);
  if (Execute::one(machine_, step))
    state.pc = next_address(step);
  else if (machine_.counts != nullptr)
    machine_.count(step);
  machine_.account(step);
  if (listeners.sees_instructions) listeners.observer->retired(machine_.core(), step);
  machine_.conclude(step);
  return true;
}

void Stepping::without_thumb() {
  uint16_t unused = 0;
  if (fetch(machine_.state.pc, unused)) machine_.fault(machine_.state.pc, Cause::invalid_state);
  faulted();
}

}  // namespace capsoc::armv7m
