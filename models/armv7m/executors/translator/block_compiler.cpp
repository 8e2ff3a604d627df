#include "armv7m/executors/translator/block_compiler.h"

#include <algorithm>
#include <cstddef>
#include <cstring>

#include "armv7m/machine.h"

namespace capsoc::armv7m {

using namespace asmjit;

BlockCompiler::BlockCompiler(Machine& machine, HostContext& context, CodeBuffer& buffer)
    : machine_(machine),
      context_(context),
      buffer_(buffer),
      code_(machine.state),
      plan_(machine),
      values_(machine),
      registers_(code_, context),
      flags_(machine, plan_, code_, registers_),
      edges_(machine, context, plan_, code_, registers_, flags_),
      devices_(machine, context, code_, registers_, flags_, edges_),
      memory_(machine, context, plan_, code_, registers_, values_, edges_, devices_),
      transfers_(machine, context, plan_, code_, registers_, flags_, edges_, memory_),
      data_(machine.state, plan_, code_, registers_, flags_, edges_),
      calls_(machine, context, code_, registers_),
      floating_(machine, context, code_, registers_, flags_, edges_, memory_, calls_) {}

void BlockCompiler::forget() {
  edges_.forget();
  flags_.forget();
  calls_.forget();
  largest_bound_ = 0;
}

void BlockCompiler::begin(const Step* head, CodePage& page) {
  code_.begin();
  plan_.begin(head, page);
  values_.begin();
  flags_.begin_block();
  edges_.begin();
  devices_.begin();
  memory_.begin();
  floating_.begin();
}

/// The step that is written from here on.
void BlockCompiler::go_to(std::size_t i) {
  plan_.go_to(i);
  registers_.set_pc(pc_of(plan_[i]));
}

void BlockCompiler::emit_steps() {
  for (std::size_t i = 0; i < plan_.size() && edges_.open(); i = plan_.present() + 1) {
    go_to(i);
    const Step& step = plan_[i];
    if (i == plan_.cut()) {
      flags_.mark_step();
      return edges_.give_up(step);
    }
    if (step.condition != condition_always)
      emit_conditional_group();
    else
      emit_step(step);
  }
}

void BlockCompiler::emit_step(const Step& step) {
  flags_.mark_step();
  code_.list_step(step);
  if (!is_translated(step)) return edges_.give_up(step);
  const FlagUse effects = flag_use(step);
  flags_.begin_step(written_by(step), effects.kills, plan_.visible(plan_.present()));
  emit_operation(step);
  flags_.end_step();
  values_.note(step);
}

void BlockCompiler::emit_operation(const Step& step) {
  if (writes_sp(step)) return data_.emit_sp(step);
  const bool to_pc = is(step, kind::data) && step.rd == 15;
  if (step.operation == Operation::fall_through) {
    edges_.emit_close(step);
  } else if (to_pc) {
    edges_.emit_indirect(step);
  } else if (is(step, kind::table_branch)) {
    transfers_.emit_table_branch(step);
  } else if (is(step, kind::branch)) {
    edges_.emit_branch(step);
  } else if (is(step, kind::transfer)) {
    transfers_.emit_transfer(step);
  } else if (is(step, kind::dsp_extension)) {
    calls_.emit(step);
  } else if (is(step, kind::fp_extension)) {
    floating_.emit(step);
  } else if (is(step, kind::data_processing)) {
    data_.emit_data(step);
  } else if (step.operation == Operation::isb) {
    edges_.emit_close(step);
  } else if (masks_interrupts(step)) {
    calls_.emit_masks(step);
    flags_.drop_host_flags();
    edges_.emit_close(step);
  } else if (reads_masks(step)) {
    calls_.emit(step);
  } else if (step.operation == Operation::mrs || step.operation == Operation::msr) {
    emit_stack_pointer(step);
  } else {
    flags_.keep_host_flags();  // NOP, IT, barriers
  }
}

/// In a handler, which is privileged and has MSP in use; elsewhere they are left to C++. After MSR
/// the block ends, as it does for every executor, though nothing depends on a stack pointer.
void BlockCompiler::emit_stack_pointer(const Step& step) {
  const State& state = machine_.state;
  a_.cmp(code_.state_word(&state.ipsr), 0);
  a_.jz(edges_.exit_at(step));
  if (step.operation == Operation::mrs) {
    const Gp to = registers_.destination(step.rd, x86::eax);
    a_.mov(to, code_.state_word(&state.other_sp));
    return registers_.written(step.rd, to);
  }
  registers_.read_to(x86::eax, step.rn);
  a_.and_(x86::eax, ~3);
  a_.mov(code_.state_word(&state.other_sp), x86::eax);
  edges_.emit_close(step);
}

const uint8_t* BlockCompiler::finish() {
  const CodeBuffer& buffer = buffer_;
  const std::size_t size = code_.size(), start = buffer.used();
  if (!code_.complete() || size > buffer.room()) return nullptr;
  std::memcpy(buffer.writable(start), code_.bytes(), size);
  edges_.link(buffer, start);
  buffer_.take((size + 15) & ~std::size_t{15});
  largest_bound_ = std::max(largest_bound_, plan_.bound());
  return buffer.executable(start + BlockEdges::minded_bytes);
}

const uint8_t* BlockCompiler::emit(const Step* head, CodePage& page) {
  if (full()) return nullptr;
  begin(head, page);
  if (!is_translated(*head)) return nullptr;
  edges_.emit_entries();
  emit_steps();
  if (edges_.open()) return nullptr;
  edges_.emit_taken();
  memory_.emit_slow_ways();
  devices_.emit();
  floating_.emit_slow_ways();
  edges_.emit_misses();
  edges_.emit_exits();
  code_.embed_constants();
  edges_.embed_slots();
  return finish();
}

std::size_t BlockCompiler::emit_frame() {
  code_.begin();
  const Gp saved[] = {x86::rbx, x86::rbp, x86::r12, x86::r13, x86::r14, x86::r15};
  for (const Gp& r : saved) a_.push(r);
  a_.mov(x86::rbp, x86::rdi);
  a_.mov(x86::rax, x86::rsi);
  a_.mov(x86::r15, code_.context(&context_.budget));
  registers_.load_all();
  a_.jmp(x86::rax);
  const Label leave = a_.newLabel();
  a_.align(AlignMode::kCode, 16);
  a_.bind(leave);
  a_.mov(code_.context(&context_.budget), x86::r15);
  registers_.store_all();
  for (std::size_t i = std::size(saved); i-- > 0;) a_.pop(saved[i]);
  a_.ret();
  const std::size_t start = buffer_.used(), size = code_.size();
  std::memcpy(buffer_.writable(start), code_.bytes(), size);
  context_.leave = buffer_.executable(start + code_.offset_of(leave));
  buffer_.take((size + 63) & ~std::size_t{63});
  return start;
}

}  // namespace capsoc::armv7m
