#include "armv7m/executors/translator/block_compiler.h"
#include "armv7m/machine.h"

namespace capsoc::armv7m {

using namespace asmjit;

/// The value that a step writes to its register, if the host can compute it without changing its
/// flags.
std::optional<FlagOperand> BlockCompiler::moved_by(const Step& step) {
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
std::optional<x86::Inst::Id> BlockCompiler::masked_by(const Step& step) {
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

/// How a group can be written without a jump, which avoids mispredicted branches. One way is
/// conditional moves, after which a second group (ITE) finds the host's flags as the first did. The
/// other is a mask made of the condition, for operations that are no moves.
BlockCompiler::GroupForm BlockCompiler::form_of_group(std::size_t end) const {
  constexpr std::size_t most_masked = 4;
  GroupForm form = GroupForm::moves;
  for (std::size_t i = plan_.present(); i < end; ++i) {
    const Step& step = plan_[i];
    const bool plain = is_translated(step) && !step.set_flags && step.cycles == 1;
    if (!plain || !pinned(step.rd) || step.rd == 13) return GroupForm::jump;
    if (moved_by(step)) continue;
    if (!masked_by(step) || end - plan_.present() > most_masked) return GroupForm::jump;
    form = GroupForm::masked;
  }
  return form;
}

/// A step as a conditional move; leaves the host's flags alone.
void BlockCompiler::emit_move(const Step& step, Cond condition) {
  const FlagOperand value = *moved_by(step);
  Operand from = x86::eax;
  if (value.base == FlagOperand::none) {
    a_.mov(x86::eax, value.imm);
  } else if (value.is_register()) {
    from = registers_.at(value.base);
  } else {
    const Gp base = registers_.read(value.base, x86::eax);
    if (value.plus == FlagOperand::none)
      a_.lea(x86::eax, sum_of(base, static_cast<int32_t>(value.imm)));
    else
      a_.lea(x86::eax, sum_of(base, registers_.read(value.plus, x86::ecx)));
  }
  a_.emit(x86::Inst::cmovccFromCond(condition), host_register(step.rd), from);
}

void BlockCompiler::emit_moves(std::size_t end, Cond condition) {
  for (std::size_t i = plan_.present(); i < end; ++i) {
    go_to(i);
    const Step& step = plan_[i];
    code_.list_step(step);
    emit_move(step, condition);
    values_.forget(step.rd);
  }
}

/// The condition as all ones or zeros in edx.
void BlockCompiler::emit_masked(std::size_t end, Cond condition) {
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
  for (std::size_t i = plan_.present(); i < end; ++i) {
    go_to(i);
    const Step& step = plan_[i];
    code_.list_step(step);
    if (const auto operation = masked_by(step)) {
      const Operand second = data_.second_operand(step, x86::ecx, false);
      if (!second.isReg() || second.as<Gp>() != x86::ecx)
        a_.emit(x86::Inst::kIdMov, x86::ecx, second);
      a_.and_(x86::ecx, x86::edx);
      a_.emit(*operation, host_register(step.rd), x86::ecx);
    } else {
      a_.test(x86::edx, x86::edx);
      emit_move(step, x86::CondCode::kNZ);
    }
    values_.forget(step.rd);
  }
  flags_.drop_host_flags();
  flags_.forget_host_carries();
}

/// Steps of an IT block under one jump, or as conditional moves. After it the flags are where they
/// were before it.
void BlockCompiler::emit_conditional_group() {
  const std::size_t begin = plan_.present(), end = plan_.end_of_group(begin);
  uint32_t written = 0;
  bool sets = false;
  for (std::size_t i = begin; i < end; ++i) {
    const Step& step = plan_[i];
    written |= written_by(step);
    sets = sets || step.set_flags || step.operation == Operation::cmp_high;
  }
  const uint8_t visible = plan_.visible_behind_group(begin, end);
  flags_.protect(written, 0, visible);
  if (sets) flags_.settle(visible);
  for (std::size_t i = begin; i < end; ++i) plan_.set_visible(i, visible);
  const unsigned condition = plan_[begin].condition;
  const GroupForm form = form_of_group(end);
  if (condition >= condition_always || machine_.counts != nullptr || form == GroupForm::jump)
    return emit_jump_over(end, written, sets, visible);
  const Cond taken = flags_.condition(condition);
  if (form == GroupForm::moves)
    emit_moves(end, taken);
  else
    emit_masked(end, taken);
}

void BlockCompiler::emit_jump_over(std::size_t end, uint32_t written, bool sets, uint8_t visible) {
  const std::size_t begin = plan_.present();
  const unsigned condition = plan_[begin].condition;
  const bool always = condition >= condition_always, counts = machine_.counts != nullptr;
  uint32_t saved = 0;  // cycles, where the condition fails
  for (std::size_t i = begin; i < end; ++i) saved += plan_[i].cycles - 1u;
  const Label skip = a_.newLabel(), join = a_.newLabel();
  if (!always) a_.j(x86::negateCond(flags_.condition(condition)), skip);
  const FlagSources flags = flags_.sources();
  for (std::size_t i = begin; i < end && edges_.open(); ++i) {
    go_to(i);
    emit_step(plan_[i]);
  }
  go_to(end - 1);
  if (sets && edges_.open()) {
    flags_.settle(visible);
  } else {
    flags_.restore_sources(flags);
  }
  if (sets) flags_.set_sources(static_cast<uint8_t>(~visible & flag::all), {});
  flags_.drop_host_flags();
  flags_.forget_host_carries();
  for (unsigned n = 0; n < 16; ++n)
    if ((written >> n & 1) != 0 && n != 13) values_.forget(n);
  if (always) return;
  if (edges_.open() && (saved != 0 || counts)) a_.jmp(join);
  a_.bind(skip);
  if (counts)
    edges_.count(machine_.counts->skips(plan_[begin].address, next_address(plan_[end - 1])));
  if (saved != 0) a_.add(x86::r15, code_.constant(uint64_t{saved} << 32));
  a_.bind(join);
  edges_.reopen();
}

}  // namespace capsoc::armv7m
