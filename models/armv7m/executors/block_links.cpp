#include "armv7m/executors/block_links.h"

#include "armv7m/machine.h"

namespace capsoc::armv7m {

const Step* BlockLinks::find(Machine& cpu) {
  const uint32_t pc = cpu.state.pc;
  CodePage* code = cpu.memory.direct(pc).code;
  if (__builtin_expect(code == nullptr, 0)) code = cpu.memory.executable_page(pc);
  if (code == nullptr) return nullptr;
  std::unique_ptr<Step[]>& slot = code->blocks[(pc & (Memory::page_size - 1)) >> 1];
  // There is none at a breakpoint, so that every way to it leads past the run loop.
  if (__builtin_expect(slot == nullptr, 0)) slot = cpu.block_builder->build(pc, *code);
  return slot.get();
}

void BlockLinks::arrive(State& state, const DecodedOp& target) {
  if ((state.trail & timing::trail_refill) != 0) state.cycles += timing::refill_beyond(target);
  state.trail = timing::no_trail;
}

/// Where execution continues at pc, if a block is there already and surely ends before the limit.
inline const Step* BlockLinks::next(Machine& cpu) {
  State& state = cpu.state;
  const CodePage* code = cpu.memory.direct(state.pc).code;
  if (state.it_state != 0 || code == nullptr) return nullptr;
  const Step* first = code->blocks[(state.pc & (Memory::page_size - 1)) >> 1].get();
  if (first == nullptr || timing::hangs_on(state.trail, *first)) return nullptr;
  if (state.cycles + first->block_cycles >= cpu.block_limit) return nullptr;
  arrive(state, *first);
  return first;
}

const Step* BlockLinks::leave(Machine& cpu, const Step& op) {
  cpu.account(op);
  cpu.conclude(op);
  return cpu.requests.any() ? nullptr : next(cpu);
}

const Step* BlockLinks::resolve_link(Machine& cpu, const Step& branch) {
  if (branch.link == nullptr) branch.link = find(cpu);
  return next(cpu);
}

}  // namespace capsoc::armv7m
