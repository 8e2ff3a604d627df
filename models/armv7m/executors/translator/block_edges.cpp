#include "armv7m/executors/translator/block_edges.h"

#include <cstddef>
#include <cstring>

#include "armv7m/machine.h"

namespace capsoc::armv7m {

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

void BlockEdges::begin() {
  open_ = true;
  stubs_.clear();
  slots_.clear();
  misses_.clear();
  taken_.clear();
  step_exits_.clear();
}

void BlockEdges::emit_entries() {
  static constexpr uint8_t nothing[refill_bytes] = {0x0F, 0x1F, 0x84};  // NOP of eight bytes
  a_.embedUInt64(timing::minded_by(plan_.head()));
  refilled_entry_ = a_.newLabel();
  a_.bind(refilled_entry_);
  if (const uint64_t beyond = timing::refill_beyond(plan_.head())) {
    a_.sub(x86::r15, code_.constant(beyond << 32));
    a_.nop();
  } else {
    a_.embed(nothing, sizeof nothing);
  }
  if (a_.offset() != minded_bytes) code_.fail();
  entry_ = a_.newLabel();
  a_.bind(entry_);
}

Label BlockEdges::stub(const BlockExit& exit) {
  stubs_.push_back({a_.newLabel(), static_cast<uint32_t>(exits_.size())});
  exits_.push_back(exit);
  return stubs_.back().label;
}

Label BlockEdges::exit_at(const Step& step) {
  if (!step_exits_.empty() && step_exits_.back().first == &step) return step_exits_.back().second;
  BlockExit exit;
  exit.step = &step;
  exit.bound = plan_.head().block_cycles;
  exit.recipe = flags_.recipe_before_step();
  step_exits_.emplace_back(&step, stub(exit));
  return step_exits_.back().second;
}

void BlockEdges::give_up(const Step& step) {
  a_.jmp(exit_at(step));
  open_ = false;
}

/// What a block comes to when it is left after a step: to be subtracted from the budget.
uint64_t BlockEdges::cost(const Step& step, unsigned refill) {
  const uint64_t cycles = uint64_t{step.cycles_before} + step.cycles + refill;
  return (cycles << 32) - step.instructions_to;
}

void BlockEdges::emit_branch(const Step& step) {
  switch (step.operation) {
    case Operation::bcond:
      if (const unsigned condition = branch_condition(step); condition < condition_always)
        return emit_conditional_branch(step, flags_.condition(condition));
      emit_edge(step, target_of(step), timing::refill_immediate);
      open_ = false;
      return;
    case Operation::cbz:
    case Operation::cbnz:
      if (pinned(step.rn))
        a_.test(host_register(step.rn), host_register(step.rn));
      else
        a_.cmp(registers_.in_state(step.rn), 0);
      flags_.drop_host_flags();
      return emit_conditional_branch(
          step, step.operation == Operation::cbz ? x86::CondCode::kZ : x86::CondCode::kNZ);
    case Operation::bl:
      if (pinned(14)) a_.mov(host_register(14), next_address(step) | 1);
      [[fallthrough]];
    case Operation::b:
      emit_edge(step, target_of(step), timing::refill_immediate);
      open_ = false;
      return;
    default:
      return emit_indirect(step);
  }
}

/// A branch back is written where it stands, since it is taken mostly; one ahead after the block.
void BlockEdges::emit_conditional_branch(const Step& step, Cond taken) {
  flags_.keep_host_flags();
  if (target_of(step) > step.address) {
    const Label label = a_.newLabel();
    a_.j(taken, label);
    taken_.push_back({label, &step, flags_.snapshot()});
    return;
  }
  const Label over = a_.newLabel();
  a_.j(x86::negateCond(taken), over);
  const FlagTracker::Snapshot flags = flags_.snapshot();
  emit_edge(step, target_of(step), timing::refill_immediate);
  flags_.restore(flags);
  a_.bind(over);
}

/// The way to a known address after a step, by a branch or, without a refill, without one.
void BlockEdges::emit_edge(const Step& step, uint32_t target, unsigned refill,
                           timing::Trail trail) {
  // Where a block is closed may be in another page than the step.
  const bool here = same_page(target, plan_.head().address);
  if (!here || !flags_.sources().any_pending() || !flags_.leave_recoverable(target))
    flags_.settle_all();
  const FlagSources left = flags_.outgoing();
  const uint32_t recipe = flags_.recipe_of(left);
  if (!left.all_inherited()) a_.mov(code_.context(&context_.recipe, 4), recipe);
  BlockExit exit;
  exit.kind = BlockExit::Kind::edge;
  exit.pc = target;
  exit.recipe = recipe;
  exit.trail = trail;
  if (machine_.counts != nullptr && refill != 0) count(machine_.counts->branch(step, target));
  a_.sub(x86::r15, code_.constant(cost(step, refill)));
  const Label out = stub(exit);
  const auto number = static_cast<uint32_t>(exits_.size() - 1);
  a_.js(out);
  if (target == plan_.head().address) {
    a_.jmp(timing::refill_beyond(plan_.head()) != 0 ? refilled_entry_ : entry_);
  } else if (here) {
    slots_.push_back({a_.newLabel(), out, number});
    a_.jmp(x86::qword_ptr(slots_.back().label));
  } else {
    jump_to_page(target, refill, exit.trail, out);
  }
}

/// An edge to another page: the view in use decides whether that may be executed.
void BlockEdges::jump_to_page(uint32_t target, unsigned refill, uint16_t trail, const Label& out) {
  const uint64_t record = uint64_t{target >> Memory::page_bits} * sizeof(Memory::Page);
  a_.mov(x86::rcx, code_.context(&context_.pages));
  a_.mov(x86::rcx, x86::ptr(x86::rcx, static_cast<int32_t>(record + offsetof(Memory::Page, code))));
  a_.test(x86::rcx, x86::rcx);
  a_.jz(out);
  const uint32_t index = (target & (Memory::page_size - 1)) >> 1;
  a_.mov(x86::rcx, x86::ptr(x86::rcx, plan_.in_code_page(&plan_.page().entries[index])));
  a_.test(x86::rcx, x86::rcx);
  a_.jz(out);
  if (const auto left_behind = static_cast<uint16_t>(trail & timing::trail_for_neighbours)) {
    a_.test(x86::word_ptr(x86::rcx, -minded_bytes), left_behind);
    a_.jnz(out);
  }
  if (refill != 0) a_.sub(x86::rcx, refill_bytes);
  a_.jmp(x86::rcx);
}

void BlockEdges::emit_indirect(const Step& step) {
  flags_.settle_all();
  if (step.operation == Operation::add_high) {
    registers_.read_to(x86::eax, step.rn);
    a_.emit(x86::Inst::kIdAdd, x86::eax, registers_.at(step.rm));
  } else {
    registers_.read_to(x86::eax, step.rm);
  }
  const bool interworks = step.operation == Operation::bx || step.operation == Operation::blx;
  if (!interworks) a_.or_(x86::eax, 1);
  find_entry(step);
  if (step.operation == Operation::blx) a_.mov(host_register(14), next_address(step) | 1);
  go_to_entry(step, machine_.profile.timing.refill_register);
}

void BlockEdges::find_entry(const Step& step) {
  misses_.push_back({a_.newLabel(), a_.newLabel(), exit_at(step)});
  static_assert(sizeof(JumpCache::target[0]) == 8 && sizeof(JumpCache::code[0]) == 8);
  a_.mov(x86::ecx, x86::eax);
  a_.and_(x86::ecx, jump_index);
  a_.cmp(x86::rax, jump(context_.jumps.target.data(), x86::rcx));
  a_.jne(misses_.back().entry);
  a_.mov(x86::rcx, jump(context_.jumps.code.data(), x86::rcx));
  a_.bind(misses_.back().back);
  a_.and_(x86::eax, ~1);
  a_.mov(code_.state_word(&machine_.state.pc), x86::eax);
}

/// A place in the jump cache, by an address and jump_index.
x86::Mem BlockEdges::jump(const void* of, const Gp& index) const {
  return x86::ptr(x86::rbp, index, 2, code_.context(of).offsetLo32(), 8);
}

/// A target that the jump cache does not have: through the record of its page.
void BlockEdges::emit_miss(const JumpMiss& miss) {
  a_.bind(miss.entry);
  a_.test(x86::al, 1);
  a_.jz(miss.exit);
  a_.mov(x86::ecx, x86::eax);
  a_.shr(x86::ecx, Memory::page_bits);
  a_.shl(x86::ecx, 5);
  a_.add(x86::rcx, code_.context(&context_.pages));
  a_.mov(x86::rcx, x86::ptr(x86::rcx, offsetof(Memory::Page, code)));
  a_.test(x86::rcx, x86::rcx);
  a_.jz(miss.exit);
  a_.mov(x86::edx, x86::eax);
  a_.and_(x86::edx, Memory::page_size - 2);
  a_.mov(x86::rcx,
         x86::ptr(x86::rcx, x86::rdx, 2, plan_.in_code_page(plan_.page().entries.data())));
  a_.test(x86::rcx, x86::rcx);
  a_.jz(miss.exit);
  a_.mov(x86::edx, x86::eax);
  a_.and_(x86::edx, jump_index);
  a_.mov(jump(context_.jumps.target.data(), x86::rdx), x86::rax);
  a_.mov(jump(context_.jumps.code.data(), x86::rdx), x86::rcx);
  a_.mov(code_.context(&context_.jumps.used, 4), 1);
  a_.jmp(miss.back);
}

void BlockEdges::go_to_entry(const Step& step, unsigned refill) {
  a_.mov(code_.context(&context_.recipe, 4), 0);
  if (machine_.counts != nullptr) count_departure(step);
  a_.sub(x86::r15, code_.constant(cost(step, refill)));
  const bool to_be_completed = refill < timing::most_refill;
  BlockExit exit;
  exit.kind = BlockExit::Kind::indirect;
  exit.trail = to_be_completed ? timing::trail_refill : timing::no_trail;
  a_.js(stub(exit));
  if (to_be_completed) a_.sub(x86::rcx, refill_bytes);
  a_.jmp(x86::rcx);
  open_ = false;
}

void BlockEdges::emit_close(const Step& step) {
  if (step.it_before != 0) return give_up(step);
  emit_edge(step, next_address(step), 0);
  open_ = false;
}

void BlockEdges::count(uint64_t* counter) {
  a_.mov(x86::rax, reinterpret_cast<uintptr_t>(counter));
  a_.inc(x86::qword_ptr(x86::rax));
}

/// Execution continues at State::pc instead of after a step. That address has translated code, so
/// the page that counts its line is there.
void BlockEdges::count_departure(const Step& step) {
  ExecutionCounts& counts = *machine_.counts;
  a_.mov(x86::rax, reinterpret_cast<uintptr_t>(counts.line(next_address(step))));
  a_.dec(x86::qword_ptr(x86::rax));
  a_.mov(x86::edx, code_.state_word(&machine_.state.pc));
  a_.mov(x86::rax, reinterpret_cast<uintptr_t>(counts.lines()));
  a_.shr(x86::edx, ExecutionCounts::page_bits);
  a_.mov(x86::rax, x86::ptr(x86::rax, x86::rdx, 3));
  a_.movzx(x86::edx, code_.context(&machine_.state.pc, 2));
  a_.and_(x86::edx, (1 << ExecutionCounts::page_bits) - 2);
  a_.inc(x86::qword_ptr(x86::rax, x86::rdx, 2));
}

void BlockEdges::emit_taken() {
  for (std::size_t i = 0; i < taken_.size(); ++i) {
    const TakenBranch branch = taken_[i];
    code_.list_line("taken");
    a_.bind(branch.label);
    flags_.restore(branch.flags);
    emit_edge(*branch.step, target_of(*branch.step), timing::refill_immediate);
  }
}

void BlockEdges::emit_misses() {
  if (!misses_.empty()) code_.list_line("jumps to elsewhere");
  for (const JumpMiss& miss : misses_) emit_miss(miss);
}

void BlockEdges::emit_exits() {
  code_.list_line("ways out");
  for (const Stub& stub : stubs_) {
    a_.bind(stub.label);
    a_.mov(x86::eax, stub.exit);
    a_.jmp(code_.context(&context_.leave));
  }
}

void BlockEdges::embed_slots() {
  for (const Slot& slot : slots_) {
    a_.bind(slot.label);
    a_.embedUInt64(0);
  }
}

void BlockEdges::link(const CodeBuffer& buffer, std::size_t start) {
  const auto place = [&](const Label& label) { return start + code_.offset_of(label); };
  for (const Slot& slot : slots_) {
    const uint8_t* target = buffer.executable(place(slot.unlinked));
    std::memcpy(buffer.writable(place(slot.label)), &target, sizeof target);
    exits_[slot.exit].slot = static_cast<uint32_t>(place(slot.label));
  }
}

}  // namespace capsoc::armv7m
