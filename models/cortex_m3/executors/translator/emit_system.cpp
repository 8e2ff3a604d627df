#include "cortex_m3/executors/translator/block_emitter.h"

namespace capsoc::cortex_m3 {

using namespace asmjit;

/// In no IT block.
bool BlockEmitter::stands_alone(const Step& step) {
  return step.condition == condition_always && step.it_before == 0 && step.it_after == 0;
}

/// MRS and MSR of PSP, by which handlers switch tasks.
bool BlockEmitter::moves_stack_pointer(const Step& step) {
  constexpr uint32_t psp = 9;
  const unsigned n = step.operation == Operation::mrs ? step.rd : step.rn;
  return (step.encoding & 0xFF) == psp && n < 13 && stands_alone(step);
}

/// In a handler, which is privileged and has MSP in use; elsewhere they are left to C++. Behind MSR
/// the block ends, as it does for every executor, though nothing hangs on a stack pointer.
void BlockEmitter::emit_stack_pointer(const Step& step) {
  const State& state = machine_.state;
  a_.cmp(state_word(&state.ipsr), 0);
  a_.jz(exit_at(step));
  if (step.operation == Operation::mrs) {
    const Gp to = destination(step.rd, x86::eax);
    a_.mov(to, state_word(&state.other_sp));
    return written(step.rd, to);
  }
  read_to(x86::eax, step.rn);
  a_.and_(x86::eax, ~3);
  a_.mov(state_word(&state.other_sp), x86::eax);
  emit_close(step);
}

}  // namespace capsoc::cortex_m3
