#include "armv7m/executors/translator/floating_operations.h"

#include "armv7m/machine.h"
#include "base/host_features.h"

namespace capsoc::armv7m {

using namespace asmjit;

namespace {

constexpr uint32_t bit_7 = 1u << 7, bit_16 = 1u << 16;

bool is_fused(Operation operation) {
  return operation == Operation::vfma || operation == Operation::vfms ||
         operation == Operation::vfnma || operation == Operation::vfnms;
}

/// The result is that of the host's instructions with another sign.
bool is_negated(Operation operation) {
  return operation == Operation::vnmul || operation == Operation::vnmla;
}

bool is_computed_by_host(const Step& step) {
  switch (step.operation) {
    case Operation::vadd:
    case Operation::vsub:
    case Operation::vmul:
    case Operation::vnmul:
    case Operation::vmla:
    case Operation::vmls:
    case Operation::vnmla:
    case Operation::vnmls:
    case Operation::vdiv:
    case Operation::vsqrt:
    case Operation::vcmp:
    case Operation::vcmp_zero:
    case Operation::vcvt_from_integer:
      return true;
    case Operation::vcvt_to_integer:
      return (step.encoding & bit_7) != 0;  // towards zero
    default:
      return is_fused(step.operation) && host_has_fused_multiply_add();
  }
}

}  // namespace

void FloatingOperations::begin() {
  slow_.clear();
  checked_ = false;
}

x86::Mem FloatingOperations::single(unsigned n) const {
  return code_.state_word(machine_.state.fpu.singles() + n);
}

x86::Mem FloatingOperations::status() const {
  return code_.state_word(&machine_.state.fpu.status());
}

/// The first use in a block leaves to C++ where a check, a save or a new context is due
/// (FloatingPoint::begin). Nothing in the block can make one due after that.
void FloatingOperations::check_context(const Step& step) {
  if (checked_) return;
  a_.cmp(code_.context(&context_.fp_open, 4), 0);
  a_.jz(edges_.exit_at(step));
  checked_ = step.condition == condition_always;
}

void FloatingOperations::call(const Step& step) {
  calls_.emit(step);
  a_.mov(x86::eax, status());
  a_.and_(x86::eax, Fpscr::modes | Fpscr::inexact);
  a_.xor_(x86::ecx, x86::ecx);
  a_.cmp(x86::eax, Fpscr::inexact);
  a_.sete(x86::cl);
  a_.and_(x86::ecx, code_.context(&context_.fp_host, 4));
  a_.mov(code_.context(&context_.fp_native, 4), x86::ecx);
}

void FloatingOperations::emit(const Step& step) {
  check_context(step);
  if (is(step, kind::fp_transfer)) return emit_transfer(step);
  if (is_computed_by_host(step)) return emit_native(step);
  switch (step.operation) {
    case Operation::vmrs:
      return emit_status(step);
    case Operation::vmov_reg:
    case Operation::vmov_imm:
    case Operation::vabs:
    case Operation::vneg:
    case Operation::vmov_to_core:
    case Operation::vmov_from_core:
    case Operation::vmov_pair_to_core:
    case Operation::vmov_pair_from_core:
      return emit_move(step);
    default:
      return call(step);
  }
}

/// VLDR, VSTR, VLDM, VSTM, VPUSH, VPOP.
void FloatingOperations::emit_transfer(const Step& step) {
  const bool one = is(step, kind::fp_load | kind::fp_store);
  const bool down = step.operation == Operation::vldmdb || step.operation == Operation::vstmdb;
  MemoryPaths::Access access;
  access.store = is(step, kind::fp_store | kind::fp_store_multiple);
  access.first_single = static_cast<uint8_t>(fp_operand::first(step));
  access.singles = static_cast<uint8_t>(fp_operand::transferred(step));
  MemoryPaths::Address address;
  if (step.addressing == Addressing::literal) {
    address.imm = (pc_of(step) & ~3u) + step.imm;
  } else {
    address.base = step.rn;
    if (one) address.imm = step.imm;
    if (down) address.imm = 0u - step.imm;
  }
  access.aligned = address.base == 13 && (address.imm & 3) == 0;
  memory_.emit_access(step, access, address);
  if (step.writeback)
    a_.emit(x86::Inst::kIdAdd, registers_.at(step.rn),
            Imm(static_cast<int32_t>(down ? 0u - step.imm : step.imm)));
}

/// What only moves bits.
void FloatingOperations::emit_move(const Step& step) {
  const auto to_core = [&](unsigned n, unsigned from) {
    const Gp to = registers_.destination(n, x86::eax);
    a_.mov(to, single(from));
    registers_.written(n, to);
  };
  const auto from_core = [&](unsigned n, unsigned to) {
    a_.mov(single(to), registers_.read(n, x86::eax));
  };
  const unsigned pair = fp_operand::pair(step);
  switch (step.operation) {
    case Operation::vmov_to_core:
      return to_core(step.rd, fp_operand::moved(step));
    case Operation::vmov_from_core:
      return from_core(step.rd, fp_operand::moved(step));
    case Operation::vmov_pair_to_core:
      to_core(step.rd, pair);
      return to_core(step.ra, pair + 1);
    case Operation::vmov_pair_from_core:
      from_core(step.rd, pair);
      return from_core(step.ra, pair + 1);
    case Operation::vmov_imm:
      a_.mov(single(fp_operand::d(step)), step.imm);
      return;
    default:
      break;
  }
  a_.mov(x86::eax, single(fp_operand::m(step)));
  if (step.operation == Operation::vabs) a_.and_(x86::eax, ~single::sign_bit);
  if (step.operation == Operation::vneg) a_.xor_(x86::eax, single::sign_bit);
  a_.mov(single(fp_operand::d(step)), x86::eax);
}

/// VMRS: FPSCR, or its flags as those of APSR.
void FloatingOperations::emit_status(const Step& step) {
  if (step.rd != 15) {
    const Gp to = registers_.destination(step.rd, x86::eax);
    a_.mov(to, status());
    return registers_.written(step.rd, to);
  }
  const State& state = machine_.state;
  a_.mov(x86::eax, status());
  a_.mov(code_.state_word(&state.n), x86::eax);
  a_.bt(x86::eax, 29);
  a_.setc(code_.state_byte(&state.c));
  a_.bt(x86::eax, 28);
  a_.setc(code_.state_byte(&state.v));
  a_.not_(x86::eax);
  a_.and_(x86::eax, 1u << 30);
  a_.mov(code_.state_word(&state.z), x86::eax);
  flags_.set_sources(flag::all, {});
}

void FloatingOperations::emit_native(const Step& step) {
  slow_.push_back({a_.newLabel(), a_.newLabel(), &step});
  const SlowStep slow = slow_.back();
  a_.cmp(code_.context(&context_.fp_native, 4), 0);
  a_.jz(slow.entry);
  switch (step.operation) {
    case Operation::vcmp:
    case Operation::vcmp_zero:
      emit_comparison(step, slow.entry);
      break;
    case Operation::vcvt_to_integer:
      emit_to_integer(step, slow.entry);
      break;
    case Operation::vcvt_from_integer:
      emit_from_integer(step);
      break;
    default:
      emit_arithmetic(step, slow.entry);
      break;
  }
  a_.bind(slow.back);
}

/// The bits of a number that is normal and at least twice the smallest one; else goes to a label.
/// Smaller ones may have been rounded up from below the normal ones, which raises underflow.
void FloatingOperations::normal_to_eax(const Xmm& number, const Label& otherwise) {
  constexpr uint32_t least = 0x01000000, infinity = 0x7F800000;
  a_.movd(x86::eax, number);
  a_.lea(x86::ecx, x86::ptr(x86::rax, x86::rax));  // without the sign
  a_.sub(x86::ecx, 2 * least);
  a_.cmp(x86::ecx, 2 * (infinity - least));
  a_.jae(otherwise);
}

/// Sd from Sn, Sm and, of the chained and fused ones, Sd, whose new value is written in the end:
/// the executor finds the operands as they were.
void FloatingOperations::emit_arithmetic(const Step& step, const Label& otherwise) {
  const Mem d = single(fp_operand::d(step)), n = single(fp_operand::n(step)),
            m = single(fp_operand::m(step));
  Xmm result = x86::xmm0;
  if (step.operation == Operation::vsqrt) {
    a_.sqrtss(result, m);
  } else if (is_fused(step.operation)) {
    result = x86::xmm1;
    emit_fused(step, result);
  } else {
    a_.movss(result, n);
    switch (step.operation) {
      case Operation::vadd:
        a_.addss(result, m);
        break;
      case Operation::vsub:
        a_.subss(result, m);
        break;
      case Operation::vdiv:
        a_.divss(result, m);
        break;
      default:
        a_.mulss(result, m);
        break;
    }
  }
  const bool adds = step.operation == Operation::vmla || step.operation == Operation::vnmla;
  if (adds || step.operation == Operation::vmls || step.operation == Operation::vnmls) {
    normal_to_eax(result, otherwise);  // the product, which is rounded by itself
    if (adds) {
      a_.addss(result, d);
    } else if (step.operation == Operation::vnmls) {
      a_.subss(result, d);
    } else {
      a_.movss(x86::xmm1, d);
      a_.subss(x86::xmm1, result);
      result = x86::xmm1;
    }
  }
  normal_to_eax(result, otherwise);
  if (is_negated(step.operation)) a_.xor_(x86::eax, single::sign_bit);
  a_.mov(d, x86::eax);
}

/// `sum` = the product added to Sd and rounded once, with the signs of the operation.
void FloatingOperations::emit_fused(const Step& step, const Xmm& sum) {
  const Mem m = single(fp_operand::m(step));
  a_.movss(sum, single(fp_operand::d(step)));
  a_.movss(x86::xmm0, single(fp_operand::n(step)));
  switch (step.operation) {
    case Operation::vfma:
      a_.vfmadd231ss(sum, x86::xmm0, m);
      break;
    case Operation::vfms:
      a_.vfnmadd231ss(sum, x86::xmm0, m);
      break;
    case Operation::vfnma:
      a_.vfnmsub231ss(sum, x86::xmm0, m);
      break;
    default:
      a_.vfmsub231ss(sum, x86::xmm0, m);
      break;
  }
}

/// N, Z and C of FPSCR; V is clear of numbers that can be compared.
void FloatingOperations::emit_comparison(const Step& step, const Label& otherwise) {
  constexpr uint32_t less = 1u << 31, equal = 3u << 29, greater = 1u << 29;
  a_.movss(x86::xmm0, single(fp_operand::d(step)));
  if (step.operation == Operation::vcmp) {
    a_.ucomiss(x86::xmm0, single(fp_operand::m(step)));
  } else {
    a_.xorps(x86::xmm1, x86::xmm1);
    a_.ucomiss(x86::xmm0, x86::xmm1);
  }
  a_.jp(otherwise);
  a_.mov(x86::eax, greater);
  a_.mov(x86::ecx, less);
  a_.cmovb(x86::eax, x86::ecx);
  a_.mov(x86::ecx, equal);
  a_.cmove(x86::eax, x86::ecx);
  a_.mov(x86::ecx, status());
  a_.and_(x86::ecx, ~Fpscr::nzcv);
  a_.or_(x86::eax, x86::ecx);
  a_.mov(status(), x86::eax);
}

void FloatingOperations::emit_to_integer(const Step& step, const Label& otherwise) {
  const bool is_signed = (step.encoding & bit_16) != 0;
  a_.cvttss2si(x86::rax, single(fp_operand::m(step)));
  if (is_signed)
    a_.movsxd(x86::rcx, x86::eax);
  else
    a_.mov(x86::ecx, x86::eax);
  a_.cmp(x86::rcx, x86::rax);
  a_.jne(otherwise);
  a_.mov(single(fp_operand::d(step)), x86::eax);
}

void FloatingOperations::emit_from_integer(const Step& step) {
  const bool is_signed = (step.encoding & bit_7) != 0;
  const Mem m = single(fp_operand::m(step));
  if (is_signed)
    a_.movsxd(x86::rax, m);
  else
    a_.mov(x86::eax, m);
  a_.cvtsi2ss(x86::xmm0, x86::rax);
  a_.movss(single(fp_operand::d(step)), x86::xmm0);
}

void FloatingOperations::emit_slow_ways() {
  if (!slow_.empty()) code_.list_line("not computed by the host");
  for (const SlowStep& slow : slow_) {
    a_.bind(slow.entry);
    call(*slow.step);
    a_.jmp(slow.back);
  }
}

}  // namespace capsoc::armv7m
