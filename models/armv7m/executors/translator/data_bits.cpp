#include <algorithm>

#include "armv7m/executors/translator/data_operations.h"

namespace capsoc::armv7m {

using namespace asmjit;
using Of = FlagSource::Of;

/// LSL, LSR, ASR and ROR by the bottom byte of a register.
void DataOperations::emit_shift_by_register(const Step& step) {
  const uint8_t want = plan_.wanted(step);
  if ((want & flag::c) != 0) return emit_shift_with_carry(step);
  registers_.read_to(x86::ecx, step.rm);
  a_.movzx(x86::ecx, x86::cl);
  const Gp n = registers_.read(step.rn, x86::eax);
  const Gp to = registers_.destination(step.rd, x86::eax);
  switch (step.operation) {
    case Operation::lsl_reg:
    case Operation::lsr_reg:
      if (step.operation == Operation::lsl_reg)
        a_.shlx(x86::eax, n, x86::ecx);
      else
        a_.shrx(x86::eax, n, x86::ecx);
      a_.cmp(x86::ecx, 32);
      a_.sbb(x86::ecx, x86::ecx);
      a_.and_(x86::eax, x86::ecx);
      break;
    case Operation::asr_reg:
      a_.mov(x86::edx, 31);
      a_.cmp(x86::ecx, x86::edx);
      a_.cmova(x86::ecx, x86::edx);
      a_.sarx(x86::eax, n, x86::ecx);
      break;
    default:
      if (n != x86::eax) a_.mov(x86::eax, n);
      a_.ror(x86::eax, x86::cl);
      break;
  }
  if (to != x86::eax) a_.mov(to, x86::eax);
  registers_.written(step.rd, to);
  if ((want & flag::nz) != 0)
    flags_.set_sources(flag::nz, {Of::value, FlagOperand::reg(step.rd), {}, 0});
}

/// ... whose carry, kept where nothing is shifted, is stored. In 64 bits the last bit shifted out
/// stays next to the result.
void DataOperations::emit_shift_with_carry(const Step& step) {
  flags_.settle(flag::c);
  const Label unshifted = a_.newLabel();
  registers_.read_to(x86::ecx, step.rm);
  a_.movzx(x86::ecx, x86::cl);
  registers_.read_to(x86::eax, step.rn);
  unsigned carry = 31;
  if (step.operation == Operation::ror_reg) {
    a_.mov(x86::edx, x86::ecx);
    a_.ror(x86::eax, x86::cl);
    a_.test(x86::edx, x86::edx);
  } else {
    a_.mov(x86::edx, 63);
    a_.cmp(x86::ecx, x86::edx);
    a_.cmova(x86::ecx, x86::edx);
    if (step.operation != Operation::lsl_reg) a_.shl(x86::rax, 32);
    if (step.operation == Operation::lsl_reg)
      a_.shlx(x86::rax, x86::rax, x86::rcx);
    else if (step.operation == Operation::lsr_reg)
      a_.shrx(x86::rax, x86::rax, x86::rcx);
    else
      a_.sarx(x86::rax, x86::rax, x86::rcx);
    if (step.operation == Operation::lsl_reg) carry = 32;
    a_.test(x86::ecx, x86::ecx);
  }
  a_.jz(unshifted);
  a_.bt(x86::rax, carry);
  a_.setc(code_.state_byte(&state_.c));
  a_.bind(unshifted);
  const bool upper = step.operation == Operation::lsr_reg || step.operation == Operation::asr_reg;
  if (upper) a_.shr(x86::rax, 32);
  registers_.write(step.rd, x86::eax);
  flags_.set_sources(flag::c, {});
  if ((plan_.wanted(step) & flag::nz) != 0)
    flags_.set_sources(flag::nz, {Of::value, FlagOperand::reg(step.rd), {}, 0});
}

/// SBFX, UBFX.
void DataOperations::emit_extract(const Step& step) {
  const unsigned lsb = step.field.lsb, rest = 32 - lsb;
  const unsigned width = std::min<unsigned>(static_cast<unsigned>(step.field.width), rest);
  const Gp to = registers_.destination(step.rd, x86::eax);
  registers_.read_to(to, step.rn);
  if (step.operation == Operation::ubfx) {
    if (lsb != 0) a_.shr(to, lsb);
    if (width < rest) a_.and_(to, immediate_of((1u << width) - 1));
  } else {
    if (rest != width) a_.shl(to, rest - width);
    if (width != 32) a_.sar(to, 32 - width);
  }
  registers_.written(step.rd, to);
}

void DataOperations::emit_extend(const Step& step) {
  const Gp to = registers_.destination(step.rd, x86::eax);
  flags_.keep_host_flags();
  Gp from = registers_.read(step.rm, x86::eax);
  if ((step.shift.amount & 31) != 0) {
    a_.rorx(x86::eax, from, step.shift.amount & 31);
    from = x86::eax;
  }
  switch (step.operation) {
    case Operation::sxtb:
      a_.movsx(to, from.r8());
      break;
    case Operation::sxth:
      a_.movsx(to, from.r16());
      break;
    case Operation::uxtb:
      a_.movzx(to, from.r8());
      break;
    default:
      a_.movzx(to, from.r16());
      break;
  }
  registers_.written(step.rd, to);
}

/// BFI, BFC, MOVT, ADR.
void DataOperations::emit_insert(const Step& step) {
  const Gp to = registers_.destination(step.rd, x86::eax);
  if (step.operation == Operation::adr) {
    flags_.keep_host_flags();
    a_.mov(to, (pc_of(step) & ~3u) + step.imm);
    return registers_.written(step.rd, to);
  }
  if (step.operation == Operation::movt) {
    registers_.read_to(to, step.rd);
    a_.and_(to, 0xFFFF);
    if (step.imm != 0) a_.or_(to, immediate_of(step.imm << 16));
    return registers_.written(step.rd, to);
  }
  if (step.field.width < 1) return flags_.keep_host_flags();
  const auto width = static_cast<unsigned>(static_cast<uint8_t>(step.field.width));
  const uint32_t low = width >= 32 ? ~0u : (1u << width) - 1;
  const uint32_t mask = low << (static_cast<uint8_t>(step.field.lsb) & 31u);
  if (step.operation == Operation::bfi) {
    registers_.read_to(x86::ecx, step.rn);
    if (step.field.lsb != 0) a_.shl(x86::ecx, step.field.lsb);
    a_.and_(x86::ecx, immediate_of(mask));
  }
  registers_.read_to(to, step.rd);
  a_.and_(to, immediate_of(~mask));
  if (step.operation == Operation::bfi) a_.or_(to, x86::ecx);
  registers_.written(step.rd, to);
}

/// REV, REV16, REVSH, RBIT, CLZ.
void DataOperations::emit_reverse(const Step& step) {
  const Gp to = registers_.destination(step.rd, x86::eax);
  const auto exchange = [&](uint32_t mask, unsigned by) {
    a_.mov(x86::ecx, x86::eax);
    a_.shr(x86::ecx, by);
    a_.and_(x86::ecx, immediate_of(mask));
    a_.and_(x86::eax, immediate_of(mask));
    a_.shl(x86::eax, by);
    a_.or_(x86::eax, x86::ecx);
  };
  registers_.read_to(x86::eax, step.rm);
  switch (step.operation) {
    case Operation::clz:  // without LZCNT: BSR gives the highest bit, nothing for zero
      a_.mov(x86::ecx, 63);
      a_.bsr(x86::eax, x86::eax);
      a_.cmovz(x86::eax, x86::ecx);
      a_.xor_(x86::eax, 31);
      break;
    case Operation::rev:
      a_.bswap(x86::eax);
      break;
    case Operation::rev16:
      a_.bswap(x86::eax);
      a_.rol(x86::eax, 16);
      break;
    case Operation::revsh:
      a_.bswap(x86::eax);
      a_.sar(x86::eax, 16);
      break;
    default:
      a_.bswap(x86::eax);
      exchange(0x0F0F0F0F, 4);
      exchange(0x33333333, 2);
      exchange(0x55555555, 1);
      break;
  }
  if (to != x86::eax) a_.mov(to, x86::eax);
  registers_.written(step.rd, to);
}

}  // namespace capsoc::armv7m
