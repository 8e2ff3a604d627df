#include "cortex_m3/executors/stepping.h"

#include "cortex_m3/executors/execute.h"
#include "cortex_m3/isa/decoder.h"

namespace capsoc::cortex_m3 {

bool Stepping::fetch(uint32_t address, uint16_t& halfword) {
  const auto cause = machine_.memory.fetch(address, halfword);
  return !cause || machine_.fault(machine_.state.pc, *cause, address);
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
  Step step;
  static_cast<DecodedOp&>(step) = decode(address, first, second, state.it_state);
  if (Execute::cannot_continue(step)) {
    machine_.fault(step, Cause::invalid_state);
    faulted();
    if (machine_.counts != nullptr) machine_.counts->moved(address, state.pc);
    return true;
  }
  if (permits != nullptr && !permits(step)) return false;
  const Memory::Region* region = machine_.memory.map().find(address);
  machine_.blocks.add_cycles(step, state.trail, region != nullptr ? region->wait_states : 0);
  Blocks::arrive(state, step);
  step.instructions_to = 1;
  Execute::bind(step);
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

}  // namespace capsoc::cortex_m3
