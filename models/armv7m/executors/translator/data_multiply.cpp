#include "armv7m/executors/translator/data_operations.h"

namespace capsoc::armv7m {

using namespace asmjit;
using Of = FlagSource::Of;

/// MUL, MLA, MLS.
void DataOperations::emit_multiply(const Step& step) {
  const Gp to = registers_.destination(step.rd, x86::eax);
  if (step.operation == Operation::mul && (to == x86::eax || step.rd == step.rn)) {
    registers_.read_to(to, step.rn);
    a_.emit(x86::Inst::kIdImul, to, registers_.at(step.rm));
  } else {
    registers_.read_to(x86::eax, step.rn);
    a_.emit(x86::Inst::kIdImul, x86::eax, registers_.at(step.rm));
    if (step.operation == Operation::mul) {
      a_.mov(to, x86::eax);
    } else if (step.operation == Operation::mla) {
      a_.emit(x86::Inst::kIdAdd, x86::eax, registers_.at(step.ra));
      if (to != x86::eax) a_.mov(to, x86::eax);
    } else {
      registers_.read_to(x86::ecx, step.ra);
      a_.sub(x86::ecx, x86::eax);
      a_.mov(to, x86::ecx);
    }
  }
  registers_.written(step.rd, to);
  if ((plan_.wanted(step) & flag::nz) != 0)
    flags_.set_sources(flag::nz, {Of::value, FlagOperand::reg(step.rd), {}, 0});
}

/// The cycles of a long multiplication that its operands add: one for each of more than 16 bits.
void DataOperations::charge_operands(const Step& step, bool is_signed, bool accumulate) {
  // edx counts.
  a_.xor_(x86::edx, x86::edx);
  for (const unsigned n : {unsigned{step.rn}, unsigned{step.rm}}) {
    registers_.read_to(x86::eax, n);
    if (is_signed) {
      a_.mov(x86::ecx, x86::eax);
      a_.neg(x86::ecx);
      a_.cmovns(x86::eax, x86::ecx);
    }
    a_.cmp(x86::eax, 0x10000);
    a_.sbb(x86::edx, -1);
  }
  if (accumulate) {  // 0, 1 or 3
    a_.mov(x86::eax, x86::edx);
    a_.shr(x86::eax, 1);
    a_.add(x86::edx, x86::eax);
  }
  code_.charge(x86::edx);
}

/// SMULL, UMULL, SMLAL, UMLAL.
void DataOperations::emit_long_multiply(const Step& step) {
  const bool is_signed = step.operation == Operation::smull || step.operation == Operation::smlal;
  const bool accumulate = step.operation == Operation::smlal || step.operation == Operation::umlal;
  if (step.by_operands) charge_operands(step, is_signed, accumulate);
  if (is_signed) {
    a_.emit(x86::Inst::kIdMovsxd, x86::rax, registers_.at(step.rn));
    a_.emit(x86::Inst::kIdMovsxd, x86::rcx, registers_.at(step.rm));
  } else {
    registers_.read_to(x86::eax, step.rn);
    registers_.read_to(x86::ecx, step.rm);
  }
  a_.imul(x86::rax, x86::rcx);
  if (accumulate) {
    registers_.read_to(x86::ecx, step.ra);
    a_.shl(x86::rcx, 32);
    registers_.read_to(x86::edx, step.rd);
    a_.or_(x86::rcx, x86::rdx);
    a_.add(x86::rax, x86::rcx);
  }
  registers_.write(step.rd, x86::eax);
  a_.shr(x86::rax, 32);
  registers_.write(step.ra, x86::eax);
}

/// SDIV, UDIV. A divisor of zero is left to C++.
void DataOperations::emit_divide(const Step& step) {
  const bool is_signed = step.operation == Operation::sdiv;
  const Label short_one = a_.newLabel();
  const auto magnitude_to = [&](const Gp& to, const Gp& scratch, unsigned n) {
    registers_.read_to(to, n);
    if (!is_signed) return;
    a_.mov(scratch, to);
    a_.neg(scratch);
    a_.cmovns(to, scratch);
  };
  magnitude_to(x86::ecx, x86::edx, step.rm);
  a_.test(x86::ecx, x86::ecx);
  a_.jz(edges_.exit_at(step));
  magnitude_to(x86::eax, x86::edx, step.rn);
  a_.cmp(x86::eax, x86::ecx);
  a_.jb(short_one);
  a_.bsr(x86::eax, x86::eax);
  a_.bsr(x86::ecx, x86::ecx);
  a_.sub(x86::eax, x86::ecx);
  a_.shr(x86::eax, 2);
  a_.inc(x86::eax);
  code_.charge(x86::eax);
  a_.bind(short_one);
  if (is_signed) {  // in 64 bits the smallest number by -1 wraps instead of raising an exception
    a_.emit(x86::Inst::kIdMovsxd, x86::rax, registers_.at(step.rn));
    a_.emit(x86::Inst::kIdMovsxd, x86::rcx, registers_.at(step.rm));
    a_.cqo();
    a_.idiv(x86::rcx);
  } else {
    registers_.read_to(x86::eax, step.rn);
    registers_.read_to(x86::ecx, step.rm);
    a_.xor_(x86::edx, x86::edx);
    a_.div(x86::ecx);
  }
  registers_.write(step.rd, x86::eax);
}

}  // namespace capsoc::armv7m
