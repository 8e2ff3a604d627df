#include "armv7m/executors/translator/data_operations.h"

namespace capsoc::armv7m {

using namespace asmjit;
using Of = FlagSource::Of;

namespace {

bool is_immediate(Operation operation) {
  switch (operation) {
    case Operation::and_imm:
    case Operation::bic_imm:
    case Operation::orr_imm:
    case Operation::orn_imm:
    case Operation::eor_imm:
    case Operation::add_imm:
    case Operation::adc_imm:
    case Operation::sbc_imm:
    case Operation::sub_imm:
    case Operation::rsb_imm:
    case Operation::mov_imm:
    case Operation::mvn_imm:
    case Operation::tst_imm:
    case Operation::teq_imm:
    case Operation::cmp_imm:
    case Operation::cmn_imm:
      return true;
    default:
      return false;
  }
}

bool is_shifted(const DecodedOp& op) {
  return !is_immediate(op.operation) && op.shift.amount != 0;
}

}  // namespace

/// True if C is the carry of the shifter and is live.
bool DataOperations::store_shifter_carry(const Step& step) const {
  return shifter_sets_carry(step) && (plan_.wanted(step) & flag::c) != 0;
}

/// `to` = the shifted register; its carry goes to the state if asked for.
void DataOperations::shift_constant(const Gp& to, unsigned rm, Shift shift, bool carry) {
  const uint32_t n = shift.amount;
  if (shift.type == ShiftType::rrx) {
    flags_.carry_to_host(false);
    registers_.read_to(to, rm);
    a_.rcr(to, 1);
  } else if (shift.type == ShiftType::ror) {
    a_.rorx(to, registers_.read(rm, to), n & 31);
    if (carry) a_.bt(to, 31);
  } else if (shift.type == ShiftType::asr) {
    registers_.read_to(to, rm);
    a_.sar(to, n < 32 ? n : 31);
    if (carry && n == 32) a_.bt(to, 31);
  } else if (shift.type == ShiftType::lsr && n == 32) {
    registers_.read_to(to, rm);
    if (carry) a_.shl(to, 1);
  } else if (shift.type == ShiftType::lsr) {
    registers_.read_to(to, rm);
    a_.shr(to, n);
  } else {
    registers_.read_to(to, rm);
    a_.shl(to, n);
  }
  if (carry) a_.setc(code_.state_byte(&state_.c));
  if (shift.type == ShiftType::lsr && n == 32) a_.mov(to, 0);
}

Operand DataOperations::second_operand(const Step& step, const Gp& scratch, bool carry) {
  if (is_immediate(step.operation)) {
    if (carry) a_.mov(code_.state_byte(&state_.c), static_cast<int>(step.imm >> 31));
    return immediate_of(step.imm);
  }
  if (step.shift.amount == 0) return registers_.at(step.rm);
  shift_constant(scratch, step.rm, step.shift, carry);
  return scratch;
}

/// True for an operation on a register that is in no host register and that keeps the result: the
/// host does it in one instruction.
bool DataOperations::works_in_state(const Step& step, const Operand& second) {
  return !pinned(step.rd) && step.rd == step.rn && !second.isMem();
}

/// True if the host's shift leaves N, Z and C of the result as the host's.
bool DataOperations::leaves_host_flags(const Shift& shift) {
  return shift.type <= ShiftType::asr && shift.amount >= 1 && shift.amount <= 31;
}

/// Where the second operand of an operation that may take its two either way round is shifted: in
/// the result's place, unless the first operand is there.
x86::Gp DataOperations::shift_place(const Step& step) {
  return pinned(step.rd) && step.rd != step.rn ? host_register(step.rd) : Gp(x86::ecx);
}

void DataOperations::emit_data(const Step& step) {
  switch (step.operation) {
    case Operation::tst_imm:
    case Operation::tst_reg:
    case Operation::teq_imm:
    case Operation::teq_reg:
      return emit_test(step);
    case Operation::cmp_imm:
    case Operation::cmp_reg:
    case Operation::cmp_high:
      return emit_difference(step, false);
    case Operation::sub_imm:
    case Operation::sub_reg:
      return emit_difference(step, false);
    case Operation::rsb_imm:
    case Operation::rsb_reg:
      return emit_difference(step, true);
    case Operation::add_imm:
    case Operation::add_reg:
    case Operation::cmn_imm:
    case Operation::cmn_reg:
      return emit_sum(step);
    case Operation::adc_imm:
    case Operation::adc_reg:
    case Operation::sbc_imm:
    case Operation::sbc_reg:
      return emit_with_carry(step);
    case Operation::add_high:
    case Operation::mov_high:
      return emit_high(step);
    case Operation::lsl_reg:
    case Operation::lsr_reg:
    case Operation::asr_reg:
    case Operation::ror_reg:
      return emit_shift_by_register(step);
    case Operation::sbfx:
    case Operation::ubfx:
      return emit_extract(step);
    case Operation::bfi:
    case Operation::bfc:
    case Operation::movt:
    case Operation::adr:
      return emit_insert(step);
    case Operation::sxtb:
    case Operation::sxth:
    case Operation::uxtb:
    case Operation::uxth:
      return emit_extend(step);
    case Operation::rev:
    case Operation::rev16:
    case Operation::revsh:
    case Operation::rbit:
    case Operation::clz:
      return emit_reverse(step);
    case Operation::mul:
    case Operation::mla:
    case Operation::mls:
      return emit_multiply(step);
    case Operation::smull:
    case Operation::umull:
    case Operation::smlal:
    case Operation::umlal:
      return emit_long_multiply(step);
    case Operation::sdiv:
    case Operation::udiv:
      return emit_divide(step);
    default:
      return emit_logical(step);
  }
}

namespace {

x86::Inst::Id logical_instruction(Operation operation) {
  switch (operation) {
    case Operation::and_imm:
    case Operation::and_reg:
    case Operation::bic_imm:
      return x86::Inst::kIdAnd;
    case Operation::eor_imm:
    case Operation::eor_reg:
      return x86::Inst::kIdXor;
    default:
      return x86::Inst::kIdOr;
  }
}

}  // namespace

/// AND, BIC, ORR, ORN, EOR, MOV, MVN.
void DataOperations::emit_logical(const Step& step) {
  const Operation operation = step.operation;
  const uint8_t want = plan_.wanted(step);
  const bool carry = store_shifter_carry(step);
  const Gp to = registers_.destination(step.rd, x86::eax);
  bool host = false;  // the host's N and Z are the result's
  bool kept = false;  // ... and its carry stays there
  bool in_place = false;
  switch (operation) {
    case Operation::mov_imm:
    case Operation::mvn_imm: {
      const uint32_t value = operation == Operation::mov_imm ? step.imm : ~step.imm;
      if (carry) second_operand(step, x86::ecx, true);
      flags_.keep_host_flags();
      a_.mov(to, value);
      break;
    }
    case Operation::mov_reg:
    case Operation::mvn_reg:
      if (is_shifted(step)) {
        const bool plain = operation == Operation::mov_reg && leaves_host_flags(step.shift);
        host = plain;
        kept = plain && carry && flags_.only_next_reads(flag::c);
        shift_constant(to, step.rm, step.shift, carry && !kept);
      } else {
        flags_.keep_host_flags();
        registers_.read_to(to, step.rm);
      }
      if (operation == Operation::mvn_reg) a_.not_(to);
      break;
    case Operation::bic_reg: {
      const Operand m = second_operand(step, x86::ecx, carry);
      if (m.isMem()) a_.emit(x86::Inst::kIdMov, x86::ecx, m);
      a_.emit(x86::Inst::kIdAndn, to, m.isMem() ? Operand(x86::ecx) : m, registers_.at(step.rn));
      host = true;
      break;
    }
    case Operation::bic_imm:
    case Operation::orn_imm: {
      if (carry) second_operand(step, x86::ecx, true);
      registers_.read_to(to, step.rn);
      a_.emit(logical_instruction(operation), to, immediate_of(~step.imm));
      host = true;
      break;
    }
    case Operation::orn_reg: {
      const Operand m = second_operand(step, x86::ecx, carry);
      if (!m.isReg() || m.as<Gp>() != x86::ecx) a_.emit(x86::Inst::kIdMov, x86::ecx, m);
      a_.not_(x86::ecx);
      a_.emit(x86::Inst::kIdOr, x86::ecx, registers_.at(step.rn));
      a_.mov(to, x86::ecx);
      host = true;
      break;
    }
    default: {
      const Operand m = second_operand(step, shift_place(step), carry);
      const x86::Inst::Id id = logical_instruction(operation);
      in_place = works_in_state(step, m);
      if (in_place) {
        a_.emit(id, registers_.in_state(step.rd), m);
      } else if (m.isReg() && m.as<Gp>() == to) {
        a_.emit(id, to, registers_.at(step.rn));
      } else {
        registers_.read_to(to, step.rn);
        a_.emit(id, to, m);
      }
      host = true;
    }
  }
  if (!in_place) registers_.written(step.rd, to);
  if (carry) flags_.set_sources(flag::c, {kept ? Of::host : Of::memory, {}, {}, 0});
  if ((want & flag::nz) != 0)
    flags_.set_sources(flag::nz, {Of::value, FlagOperand::reg(step.rd), {}, 0});
  if (host && want != 0) flags_.in_host(kept ? HostFlags::shift : HostFlags::nz);
}

/// TST, TEQ.
void DataOperations::emit_test(const Step& step) {
  const uint8_t want = plan_.wanted(step);
  if (want == 0) return flags_.keep_host_flags();
  const bool both = step.operation == Operation::tst_imm || step.operation == Operation::tst_reg;
  const bool carry = store_shifter_carry(step);
  const FlagOperand n = FlagOperand::reg(step.rn);
  if (is_shifted(step)) {
    shift_constant(x86::ecx, step.rm, step.shift, carry);
    a_.emit(both ? x86::Inst::kIdAnd : x86::Inst::kIdXor, x86::ecx, registers_.at(step.rn));
    flags_.set_sources(flag::nz, {Of::value, flags_.aside(x86::ecx), {}, 0});
    flags_.in_host(HostFlags::nz);
  } else {
    flags_.keep_host_flags();
    const bool immediate = is_immediate(step.operation);
    if (carry) second_operand(step, x86::ecx, true);
    const FlagOperand m = immediate ? FlagOperand::number(step.imm) : FlagOperand::reg(step.rm);
    flags_.set_sources(flag::nz, {both ? Of::both : Of::either, n, m, 0});
  }
  if (carry) flags_.set_sources(flag::c, {});
}

namespace {

/// What x and y were before rd became x - y or x + y.
struct Sources {
  FlagOperand x, y;
};

Sources behind_difference(FlagOperand x, FlagOperand y, unsigned rd) {
  const uint8_t d = static_cast<uint8_t>(rd);
  if (x.base == d && y.base == d) return {FlagOperand::number(0), FlagOperand::number(0)};
  if (x.base == d) return {{d, y.base, FlagOperand::none, y.imm}, y};
  if (y.base == d) return {x, {x.base, FlagOperand::none, d, x.imm}};
  return {x, y};
}

/// Not both are rd.
Sources behind_sum(FlagOperand x, FlagOperand y, unsigned rd) {
  const uint8_t d = static_cast<uint8_t>(rd);
  if (x.base == d) return {{d, FlagOperand::none, y.base, 0u - y.imm}, y};
  if (y.base == d) return {x, {d, FlagOperand::none, x.base, 0u - x.imm}};
  return {x, y};
}

}  // namespace

/// SUB, CMP; reversed: RSB.
void DataOperations::emit_difference(const Step& step, bool reversed) {
  const uint8_t want = plan_.wanted(step);
  const bool writes = !is(step, kind::compare);
  const bool immediate = is_immediate(step.operation);
  const FlagOperand n =
      step.rn == 15 ? FlagOperand::number(pc_of(step)) : FlagOperand::reg(step.rn);
  const FlagOperand m = immediate       ? FlagOperand::number(step.imm)
                        : step.rm == 15 ? FlagOperand::number(pc_of(step))
                                        : FlagOperand::reg(step.rm);
  if (!writes && want == 0) return flags_.keep_host_flags();
  if (!writes && !is_shifted(step)) {
    flags_.keep_host_flags();
    return flags_.set_sources(flag::all, {Of::difference, n, m, 0});
  }
  const Operand second = second_operand(step, x86::ecx, false);
  if (!writes && n.is_register()) {
    a_.emit(x86::Inst::kIdCmp, registers_.at(step.rn), second);
    flags_.in_host(HostFlags::difference);
    return flags_.set_sources(flag::all, {Of::difference, n, flags_.aside(x86::ecx), 0});
  }
  const Gp to = writes ? registers_.destination(step.rd, x86::eax) : Gp(x86::eax);
  if (want == 0 && !reversed && immediate && pinned(step.rn) && pinned(step.rd)) {
    flags_.keep_host_flags();
    a_.lea(to, sum_of(host_register(step.rn), static_cast<int32_t>(0u - step.imm)));
    return;
  }
  const bool in_place = writes && !reversed && works_in_state(step, second);
  if (in_place) {
    a_.emit(x86::Inst::kIdSub, registers_.in_state(step.rd), second);
  } else if (reversed) {
    const bool negate = immediate && step.imm == 0;
    if (negate) {
      registers_.read_to(to, step.rn);
      a_.neg(to);
    } else {
      a_.emit(x86::Inst::kIdMov, x86::eax, second);
      a_.emit(x86::Inst::kIdSub, x86::eax, registers_.at(step.rn));
      if (to != x86::eax) a_.mov(to, x86::eax);
    }
  } else if (second.isReg() && second.as<Gp>() == to && step.rm != step.rn) {
    registers_.read_to(x86::eax, step.rn);
    a_.emit(x86::Inst::kIdSub, x86::eax, second);
    a_.mov(to, x86::eax);
  } else {
    registers_.read_to(to, step.rn);
    a_.emit(x86::Inst::kIdSub, to, second);
  }
  if (writes && !in_place) registers_.written(step.rd, to);
  if (want == 0) return;
  if (!writes) return flags_.settle_from_host(want, to, true);
  flags_.in_host(HostFlags::difference);
  const bool carries = (want & (flag::c | flag::v)) != 0;
  const FlagOperand other = is_shifted(step) && carries ? flags_.aside(x86::ecx) : m;
  const Sources sources =
      reversed ? behind_difference(other, n, step.rd) : behind_difference(n, other, step.rd);
  flags_.set_sources(flag::c | flag::v, {Of::difference, sources.x, sources.y, 0});
  flags_.set_sources(flag::nz, {Of::value, FlagOperand::reg(step.rd), {}, 0});
}

/// ADD, CMN.
void DataOperations::emit_sum(const Step& step) {
  const uint8_t want = plan_.wanted(step);
  const bool writes = !is(step, kind::compare);
  const bool immediate = is_immediate(step.operation);
  const FlagOperand n = FlagOperand::reg(step.rn);
  const FlagOperand m = immediate ? FlagOperand::number(step.imm) : FlagOperand::reg(step.rm);
  if (!writes && want == 0) return flags_.keep_host_flags();
  if (!writes && !is_shifted(step)) {
    flags_.keep_host_flags();
    return flags_.set_sources(flag::all, {Of::sum, n, m, 0});
  }
  const Gp to = writes ? registers_.destination(step.rd, x86::eax) : Gp(x86::eax);
  if (want == 0 && pinned(step.rn) && pinned(step.rd) && !is_shifted(step) &&
      (immediate || pinned(step.rm))) {
    flags_.keep_host_flags();
    const Gp base = host_register(step.rn);
    a_.lea(to, immediate ? sum_of(base, static_cast<int32_t>(step.imm))
                         : sum_of(base, host_register(step.rm)));
    return;
  }
  const bool scaled = !immediate && step.shift.type == ShiftType::lsl && step.shift.amount <= 3;
  if (want == 0 && pinned(step.rn) && pinned(step.rd) && scaled && pinned(step.rm)) {
    flags_.keep_host_flags();
    a_.lea(to, sum_of(host_register(step.rn), host_register(step.rm), step.shift.amount));
    return;
  }
  // The second operand, if the addition overwrites it and a live flag depends on it.
  FlagOperand other = m;
  const bool doubles = !immediate && writes && step.rn == step.rd && step.rm == step.rd;
  const bool asked = writes ? (want & (flag::c | flag::v)) != 0 : want != 0;
  const Operand second = second_operand(step, writes ? shift_place(step) : Gp(x86::ecx), false);
  if (asked && is_shifted(step))
    other = flags_.aside(second.as<Gp>());
  else if (asked && doubles)
    other = flags_.aside(registers_.read(step.rm, x86::ecx));
  const bool in_place = writes && works_in_state(step, second);
  if (in_place) {
    a_.emit(x86::Inst::kIdAdd, registers_.in_state(step.rd), second);
  } else if (second.isReg() && second.as<Gp>() == to) {
    a_.emit(x86::Inst::kIdAdd, to, registers_.at(step.rn));
  } else {
    registers_.read_to(to, step.rn);
    a_.emit(x86::Inst::kIdAdd, to, second);
  }
  if (writes && !in_place) registers_.written(step.rd, to);
  if (want == 0) return;
  flags_.in_host(HostFlags::sum);
  if (!writes) return flags_.set_sources(flag::all, {Of::sum, n, other, 0});
  const Sources sources = behind_sum(n, other, step.rd);
  flags_.set_sources(flag::c | flag::v, {Of::sum, sources.x, sources.y, 0});
  flags_.set_sources(flag::nz, {Of::value, FlagOperand::reg(step.rd), {}, 0});
}

/// ADC, SBC.
void DataOperations::emit_with_carry(const Step& step) {
  const uint8_t want = plan_.wanted(step);
  const bool subtract =
      step.operation == Operation::sbc_imm || step.operation == Operation::sbc_reg;
  Operand second;
  if (is_shifted(step)) {
    flags_.settle(flag::c);
    second = second_operand(step, x86::edx, false);
    flags_.drop_host_flags();
    flags_.carry_to_host(subtract);
  } else {
    flags_.carry_to_host(subtract);
    second = second_operand(step, x86::edx, false);
  }
  registers_.read_to(x86::eax, step.rn);
  a_.emit(subtract ? x86::Inst::kIdSbb : x86::Inst::kIdAdc, x86::eax, second);
  registers_.write(step.rd, x86::eax);
  if (want == 0) return;
  flags_.in_host(subtract ? HostFlags::difference : HostFlags::sum);
  flags_.set_sources(flag::nz, {Of::value, FlagOperand::reg(step.rd), {}, 0});
  flags_.set_sources(flag::c | flag::v, {Of::host, {}, {}, 0});
  if (flags_.only_next_reads(flag::c | flag::v)) return;
  flags_.settle_carries(want & (flag::c | flag::v));
  if ((want & (flag::c | flag::v)) != (flag::c | flag::v))
    flags_.set_sources(static_cast<uint8_t>((flag::c | flag::v) & ~want), {});
}

/// ADD and MOV of all registers, not to the PC.
void DataOperations::emit_high(const Step& step) {
  flags_.keep_host_flags();
  const bool add = step.operation == Operation::add_high;
  const Gp to = registers_.destination(step.rd, x86::eax);
  if (!add) {
    registers_.read_to(to, step.rm);
    return registers_.written(step.rd, to);
  }
  const Gp n = registers_.read(step.rn, x86::eax), m = registers_.read(step.rm, x86::ecx);
  a_.lea(to, sum_of(n, m));
  registers_.written(step.rd, to);
}

void DataOperations::emit_sp(const Step& step) {
  const bool add = step.operation == Operation::add_reg || step.operation == Operation::add_high ||
                   step.operation == Operation::add_imm;
  const bool move = step.operation == Operation::mov_high || step.operation == Operation::mov_reg;
  const Operand second =
      is_immediate(step.operation) ? Operand(immediate_of(step.imm)) : Operand(Gp(x86::ecx));
  if (!is_immediate(step.operation)) {
    if (step.shift.amount != 0)
      shift_constant(x86::ecx, step.rm, step.shift, false);
    else
      registers_.read_to(x86::ecx, step.rm);
  }
  if (move) {
    a_.mov(x86::eax, x86::ecx);
  } else {
    registers_.read_to(x86::eax, step.rn);
    a_.emit(add ? x86::Inst::kIdAdd : x86::Inst::kIdSub, x86::eax, second);
  }
  a_.test(x86::al, 3);
  a_.jnz(edges_.exit_at(step));
  registers_.write(13, x86::eax);
}

}  // namespace capsoc::armv7m
