#include "cortex_m3/executors/translator/block_emitter.h"

namespace capsoc::cortex_m3 {

using namespace asmjit;

void BlockEmitter::count(uint64_t* counter) {
  a_.mov(x86::rax, reinterpret_cast<uintptr_t>(counter));
  a_.inc(x86::qword_ptr(x86::rax));
}

/// Execution goes on at State::pc instead of behind a step. That address has translated code, so
/// the page that counts its line is there.
void BlockEmitter::count_departure(const Step& step) {
  ExecutionCounts& counts = *machine_.counts;
  a_.mov(x86::rax, reinterpret_cast<uintptr_t>(counts.line(next_address(step))));
  a_.dec(x86::qword_ptr(x86::rax));
  a_.mov(x86::edx, state_word(&machine_.state.pc));
  a_.mov(x86::rax, reinterpret_cast<uintptr_t>(counts.lines()));
  a_.shr(x86::edx, ExecutionCounts::page_bits);
  a_.mov(x86::rax, x86::ptr(x86::rax, x86::rdx, 3));
  a_.movzx(x86::edx, context(&machine_.state.pc, 2));
  a_.and_(x86::edx, (1 << ExecutionCounts::page_bits) - 2);
  a_.inc(x86::qword_ptr(x86::rax, x86::rdx, 2));
}

}  // namespace capsoc::cortex_m3
