#include <cstddef>

#include "cortex_m3/executors/translator/block_emitter.h"

namespace capsoc::cortex_m3 {

using namespace asmjit;

namespace {

/// The bits of an address that choose its place in the jump cache, four times as far apart there.
constexpr uint32_t jump_index = 2 * (JumpCache::size - 1);

bool same_page(uint32_t a, uint32_t b) {
  return a >> Memory::page_bits == b >> Memory::page_bits;
}

uint32_t target_of(const DecodedOp& op) {
  return pc_of(op) + op.imm;
}

}  // namespace

/// What a block comes to when it is left behind a step: to be subtracted from the budget.
uint64_t BlockEmitter::cost(const Step& step, unsigned refill) {
  const uint64_t cycles = uint64_t{step.cycles_before} + step.cycles + refill;
  return (cycles << 32) - step.instructions_to;
}

void BlockEmitter::emit_branch(const Step& step) {
  switch (step.operation) {
    case Operation::bcond:
      if (const unsigned condition = branch_condition(step); condition < condition_always)
        return emit_conditional_branch(step, this->condition(condition));
      emit_edge(step, target_of(step), timing::refill_immediate);
      open_ = false;
      return;
    case Operation::cbz:
    case Operation::cbnz:
      if (pinned(step.rn))
        a_.test(host(step.rn), host(step.rn));
      else
        a_.cmp(in_state(step.rn), 0);
      host_serial_ = 0;
      return emit_conditional_branch(
          step, step.operation == Operation::cbz ? x86::CondCode::kZ : x86::CondCode::kNZ);
    case Operation::bl:
      if (pinned(14)) a_.mov(host(14), next_address(step) | 1);
      [[fallthrough]];
    case Operation::b:
      emit_edge(step, target_of(step), timing::refill_immediate);
      open_ = false;
      return;
    case Operation::tbb:
    case Operation::tbh:
      return emit_table_branch(step);
    default:
      return emit_indirect(step);
  }
}

/// A branch back is written where it stands, since it is taken mostly; one ahead behind the block.
void BlockEmitter::emit_conditional_branch(const Step& step, Cond taken) {
  keep_host_flags();
  if (target_of(step) > step.address) {
    const Label label = a_.newLabel();
    a_.j(taken, label);
    taken_.push_back({label, &step, flags_, host_serial_, host_flags_});
    return;
  }
  const Label over = a_.newLabel();
  a_.j(x86::negateCond(taken), over);
  const FlagSources flags = flags_;
  const uint32_t serial = host_serial_;
  const HostFlags host_flags = host_flags_;
  emit_edge(step, target_of(step), timing::refill_immediate);
  flags_ = flags;
  host_serial_ = serial;
  host_flags_ = host_flags;
  a_.bind(over);
}

/// The way to a known address behind a step, by a branch or, without a refill, without one.
void BlockEmitter::emit_edge(const Step& step, uint32_t target, unsigned refill) {
  const bool here = same_page(target, head_->address);  // where a block is closed is elsewhere
  if (!here || !flags_.any_pending() || !leave_recoverable(target)) settle_all();
  const FlagSources left = outgoing();
  const uint32_t recipe = recipe_of(left);
  if (!left.all_inherited()) a_.mov(context(&context_.recipe, 4), recipe);
  BlockExit exit;
  exit.kind = BlockExit::Kind::edge;
  exit.pc = target;
  exit.recipe = recipe;
  exit.trail = refill != 0 ? timing::trail_refill : static_cast<timing::Trail>(step.trail);
  if (machine_.counts != nullptr && refill != 0) count(machine_.counts->branch(step, target));
  a_.sub(x86::r15, constant(cost(step, refill)));
  const Label out = stub(exit);
  const auto number = static_cast<uint32_t>(exits_.size() - 1);
  a_.js(out);
  if (target == head_->address) {
    a_.jmp(timing::refill_beyond(*head_) != 0 ? refilled_entry_ : entry_);
  } else if (here) {
    slots_.push_back({a_.newLabel(), out, number});
    a_.jmp(x86::qword_ptr(slots_.back().label));
  } else {
    // Another page: whether it may be executed hangs on the view.
    const uint64_t record = uint64_t{target >> Memory::page_bits} * sizeof(Memory::Page);
    a_.mov(x86::rcx, context(&context_.pages));
    a_.mov(x86::rcx,
           x86::ptr(x86::rcx, static_cast<int32_t>(record + offsetof(Memory::Page, code))));
    a_.test(x86::rcx, x86::rcx);
    a_.jz(out);
    const uint32_t index = (target & (Memory::page_size - 1)) >> 1;
    a_.mov(x86::rcx, x86::ptr(x86::rcx, in_code_page(&page_->entries[index])));
    a_.test(x86::rcx, x86::rcx);
    a_.jz(out);
    if (const auto left_behind = static_cast<uint16_t>(exit.trail & timing::trail_for_neighbours)) {
      a_.test(x86::word_ptr(x86::rcx, -minded_bytes), left_behind);
      a_.jnz(out);
    }
    if (refill != 0) a_.sub(x86::rcx, refill_bytes);
    a_.jmp(x86::rcx);
  }
}

int32_t BlockEmitter::in_code_page(const void* member) const {
  return static_cast<int32_t>(static_cast<const uint8_t*>(member) -
                              reinterpret_cast<const uint8_t*>(page_));
}

/// BX, BLX, MOV and ADD to the PC.
void BlockEmitter::emit_indirect(const Step& step) {
  settle_all();
  if (step.operation == Operation::add_high) {
    read_to(x86::eax, step.rn);
    a_.emit(x86::Inst::kIdAdd, x86::eax, at(step.rm));
  } else {
    read_to(x86::eax, step.rm);
  }
  const bool interworks = step.operation == Operation::bx || step.operation == Operation::blx;
  if (!interworks) a_.or_(x86::eax, 1);
  find_entry(step);
  if (step.operation == Operation::blx) a_.mov(host(14), next_address(step) | 1);
  go_to_entry(step, timing::refill_register);
}

/// rcx = the translated code at eax, whose bit 0 has to be set; leaves before the step if there is
/// none. Addresses that return from exceptions never have some. Changes rdx, too; State::pc has the
/// address then.
void BlockEmitter::find_entry(const Step& step) {
  misses_.push_back({a_.newLabel(), a_.newLabel(), exit_at(step)});
  static_assert(sizeof(JumpCache::target[0]) == 8 && sizeof(JumpCache::code[0]) == 8);
  a_.mov(x86::ecx, x86::eax);
  a_.and_(x86::ecx, jump_index);
  a_.cmp(x86::rax, jump(context_.jumps.target.data(), x86::rcx));
  a_.jne(misses_.back().entry);
  a_.mov(x86::rcx, jump(context_.jumps.code.data(), x86::rcx));
  a_.bind(misses_.back().back);
  a_.and_(x86::eax, ~1);
  a_.mov(state_word(&machine_.state.pc), x86::eax);
}

/// A place in the jump cache, by an address and jump_index.
x86::Mem BlockEmitter::jump(const void* of, const Gp& index) const {
  return x86::ptr(x86::rbp, index, 2, context(of).offsetLo32(), 8);
}

/// A target that the jump cache does not have: through the record of its page.
void BlockEmitter::emit_miss(const JumpMiss& miss) {
  a_.bind(miss.entry);
  a_.test(x86::al, 1);
  a_.jz(miss.exit);
  a_.mov(x86::ecx, x86::eax);
  a_.shr(x86::ecx, Memory::page_bits);
  a_.shl(x86::ecx, 5);
  a_.add(x86::rcx, context(&context_.pages));
  a_.mov(x86::rcx, x86::ptr(x86::rcx, offsetof(Memory::Page, code)));
  a_.test(x86::rcx, x86::rcx);
  a_.jz(miss.exit);
  a_.mov(x86::edx, x86::eax);
  a_.and_(x86::edx, Memory::page_size - 2);
  a_.mov(x86::rcx, x86::ptr(x86::rcx, x86::rdx, 2, in_code_page(page_->entries.data())));
  a_.test(x86::rcx, x86::rcx);
  a_.jz(miss.exit);
  a_.mov(x86::edx, x86::eax);
  a_.and_(x86::edx, jump_index);
  a_.mov(jump(context_.jumps.target.data(), x86::rdx), x86::rax);
  a_.mov(jump(context_.jumps.code.data(), x86::rdx), x86::rcx);
  a_.mov(context(&context_.jumps.used, 4), 1);
  a_.jmp(miss.back);
}

/// Accounts for the block and goes to the code at rcx; State::pc has its address.
void BlockEmitter::go_to_entry(const Step& step, unsigned refill) {
  a_.mov(context(&context_.recipe, 4), 0);
  if (machine_.counts != nullptr) count_departure(step);
  a_.sub(x86::r15, constant(cost(step, refill)));
  const bool to_be_completed = refill < timing::most_refill;
  BlockExit exit;
  exit.kind = BlockExit::Kind::indirect;
  exit.trail = to_be_completed ? timing::trail_refill : timing::no_trail;
  a_.js(stub(exit));
  if (to_be_completed) a_.sub(x86::rcx, refill_bytes);
  a_.jmp(x86::rcx);
  open_ = false;
}

/// TBB, TBH.
void BlockEmitter::emit_table_branch(const Step& step) {
  Access access;
  access.size = step.operation == Operation::tbb ? 1 : 2;
  Address address;
  address.index = step.rm;
  address.shift = step.operation == Operation::tbb ? 0 : 1;
  if (step.rn == 15) {  // a base of zero and the table's address
    address.imm = pc_of(step);
  } else {
    address.base = step.rn;
  }
  const int window = window_of(address, false);
  if (window < 0) return give_up(step);
  settle_all();
  const unsigned shift = through_window(address, access, window, exit_at(step));
  a_.movzx(x86::eax, x86::ptr(x86::rcx, x86::rax, shift, 0, access.size));
  a_.lea(x86::eax, x86::ptr(x86::rax, x86::rax, 0, static_cast<int32_t>(pc_of(step) | 1)));
  find_entry(step);
  charge_waits(access, window);
  go_to_entry(step, timing::refill_loaded);
}

/// The end of a block that runs into the next address.
void BlockEmitter::emit_close(const Step& step) {
  if (step.it_before != 0) return give_up(step);
  emit_edge(step, next_address(step), 0);
  open_ = false;
}

}  // namespace capsoc::cortex_m3
