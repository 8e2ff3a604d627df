#include "cortex_m3/executors/translator/block_emitter.h"

namespace capsoc::cortex_m3 {

using namespace asmjit;

/// Neighbours that obey one condition; one that sets flags is the last.
std::size_t BlockEmitter::end_of_group(std::size_t begin) const {
  std::size_t end = begin;
  const uint8_t condition = steps_[begin]->condition;
  while (end < cut_ && steps_[end]->condition == condition) {
    const Step& step = *steps_[end++];
    if (step.set_flags || step.operation == Operation::cmp_high || ends_block(step)) break;
    if (!is_translated(step)) break;
  }
  return end;
}

/// The flags that somebody may see behind a group, where it is left, or inside it.
uint8_t BlockEmitter::visible_behind_group(std::size_t begin, std::size_t end) const {
  uint8_t visible = visible_[end - 1];
  for (std::size_t i = begin; i < end; ++i) {
    if (may_be_left_at(*steps_[i])) return flag::all;
    visible |= flag_use_if_executed(*steps_[i]).reads;
  }
  return visible;
}

/// What a step writes to its register, if that can be told by the host without touching its flags.
std::optional<FlagOperand> BlockEmitter::moved_by(const Step& step) {
  const FlagOperand n = FlagOperand::reg(step.rn), m = FlagOperand::reg(step.rm);
  const bool whole = step.shift.amount == 0 && step.rm != literal_pc;
  switch (step.operation) {
    case Operation::mov_imm:
      return FlagOperand::number(step.imm);
    case Operation::mvn_imm:
      return FlagOperand::number(~step.imm);
    case Operation::mov_reg:
    case Operation::mov_high:
      if (!whole) break;
      return m;
    case Operation::add_imm:
    case Operation::sub_imm: {
      if (step.rn == literal_pc) break;
      FlagOperand sum = n;
      sum.imm = step.operation == Operation::add_imm ? step.imm : 0u - step.imm;
      return sum;
    }
    case Operation::add_reg: {
      if (!whole || step.rn == literal_pc) break;
      FlagOperand sum = n;
      sum.plus = m.base;
      return sum;
    }
    default:
      break;
  }
  return std::nullopt;
}

/// An operation that does nothing where its second operand is zero.
std::optional<x86::Inst::Id> BlockEmitter::masked_by(const Step& step) {
  const bool simple = step.shift.type != ShiftType::rrx && step.rm != literal_pc;
  if (step.rd != step.rn || !simple) return std::nullopt;
  switch (step.operation) {
    case Operation::add_imm:
    case Operation::add_reg:
      return x86::Inst::kIdAdd;
    case Operation::sub_imm:
    case Operation::sub_reg:
      return x86::Inst::kIdSub;
    case Operation::orr_imm:
    case Operation::orr_reg:
      return x86::Inst::kIdOr;
    case Operation::eor_imm:
    case Operation::eor_reg:
      return x86::Inst::kIdXor;
    default:
      return std::nullopt;
  }
}

/// How a group can be written without a jump, which costs no wrong guess where nothing predicts it:
/// as conditional moves, behind which a second group (ITE) finds the host's flags as the first did;
/// or with a mask made of the condition, for which it has to do something else than move.
BlockEmitter::GroupForm BlockEmitter::form_of_group(std::size_t end) const {
  constexpr std::size_t most_masked = 4;
  GroupForm form = GroupForm::moves;
  for (std::size_t i = index_; i < end; ++i) {
    const Step& step = *steps_[i];
    const bool plain = is_translated(step) && !step.set_flags && step.cycles == 1;
    if (!plain || !pinned(step.rd) || step.rd == 13) return GroupForm::jump;
    if (moved_by(step)) continue;
    if (!masked_by(step) || end - index_ > most_masked) return GroupForm::jump;
    form = GroupForm::masked;
  }
  return form;
}

/// A step as a conditional move; leaves the host's flags alone.
void BlockEmitter::emit_move(const Step& step, Cond condition) {
  const FlagOperand value = *moved_by(step);
  Operand from = x86::eax;
  if (value.base == FlagOperand::none) {
    a_.mov(x86::eax, value.imm);
  } else if (value.is_register()) {
    from = at(value.base);
  } else {
    const Gp base = read(value.base, x86::eax);
    if (value.plus == FlagOperand::none)
      a_.lea(x86::eax, sum_of(base, static_cast<int32_t>(value.imm)));
    else
      a_.lea(x86::eax, sum_of(base, read(value.plus, x86::ecx)));
  }
  a_.emit(x86::Inst::cmovccFromCond(condition), host(step.rd), from);
}

void BlockEmitter::emit_moves(std::size_t end, Cond condition) {
  for (; index_ < end; ++index_) {
    const Step& step = *steps_[index_];
    list_step(step);
    emit_move(step, condition);
    values_[step.rd].reset();
  }
}

/// The condition as all ones or zeros in edx.
void BlockEmitter::emit_masked(std::size_t end, Cond condition) {
  if (condition == x86::CondCode::kB) {
    a_.sbb(x86::edx, x86::edx);
  } else if (condition == x86::CondCode::kAE) {
    a_.sbb(x86::edx, x86::edx);
    a_.not_(x86::edx);
  } else {
    a_.set(condition, x86::dl);
    a_.movzx(x86::edx, x86::dl);
    a_.neg(x86::edx);
  }
  for (; index_ < end; ++index_) {
    const Step& step = *steps_[index_];
    list_step(step);
    if (const auto operation = masked_by(step)) {
      const Operand second = second_operand(step, x86::ecx, false);
      if (!second.isReg() || second.as<Gp>() != x86::ecx)
        a_.emit(x86::Inst::kIdMov, x86::ecx, second);
      a_.and_(x86::ecx, x86::edx);
      a_.emit(*operation, host(step.rd), x86::ecx);
    } else {
      a_.test(x86::edx, x86::edx);
      emit_move(step, x86::CondCode::kNZ);
    }
    values_[step.rd].reset();
  }
  host_serial_ = 0;
  forget_host_carries();
}

/// Steps of an IT block under one jump, or as conditional moves. Behind it the flags are where they
/// were before it.
void BlockEmitter::emit_conditional_group() {
  const std::size_t end = end_of_group(index_);
  const unsigned condition_code = steps_[index_]->condition;
  uint32_t written = 0, saved = 0;
  bool sets = false;
  for (std::size_t i = index_; i < end; ++i) {
    const Step& step = *steps_[i];
    written |= written_by(step);
    saved += step.cycles - 1u;
    sets = sets || step.set_flags || step.operation == Operation::cmp_high;
  }
  const uint32_t first = steps_[index_]->address;
  const uint8_t visible = visible_behind_group(index_, end);
  protect(written, 0, visible);
  if (sets) settle(visible);
  for (std::size_t i = index_; i < end; ++i) visible_[i] = visible;
  const bool always = condition_code >= condition_always;
  const GroupForm form = form_of_group(end);
  if (!always && machine_.counts == nullptr && form != GroupForm::jump) {
    const Cond taken = condition(condition_code);
    if (form == GroupForm::moves)
      emit_moves(end, taken);
    else
      emit_masked(end, taken);
    index_ = end - 1;
    return;
  }
  const Label skip = a_.newLabel(), join = a_.newLabel();
  if (!always) a_.j(x86::negateCond(condition(condition_code)), skip);
  const FlagSources flags = flags_;
  for (; index_ < end && open_; ++index_) emit_step(*steps_[index_]);
  index_ = end - 1;
  if (sets && open_) {
    settle(visible);
  } else {
    flags_ = flags;
  }
  if (sets) set_sources(static_cast<uint8_t>(~visible & flag::all), {});
  host_serial_ = 0;
  forget_host_carries();
  for (unsigned n = 0; n < 16; ++n)
    if ((written >> n & 1) != 0 && n != 13) values_[n].reset();
  if (always) return;
  const bool counts = machine_.counts != nullptr;
  if (open_ && (saved != 0 || counts)) a_.jmp(join);
  a_.bind(skip);
  if (counts) count(machine_.counts->skips(first, next_address(*steps_[index_])));
  if (saved != 0) a_.add(x86::r15, constant(uint64_t{saved} << 32));
  a_.bind(join);
  open_ = true;
}

}  // namespace capsoc::cortex_m3
