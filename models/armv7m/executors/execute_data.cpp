#include <algorithm>

#include "armv7m/executors/execute.h"

namespace capsoc::armv7m {
namespace {

enum class Flags { logical, arithmetic };

// The data-processing operations (A7.7): what they compute, whether it is written, and from where
// the carry and the overflow come.
#define LOGICAL(name, writes_rd, expression)                                                \
  struct name {                                                                             \
    static constexpr Flags kind = Flags::logical;                                           \
    static constexpr bool writes = writes_rd;                                               \
    static uint32_t compute([[maybe_unused]] uint32_t n, uint32_t m) { return expression; } \
  };
#define ARITHMETIC(name, writes_rd, x, y, carry)                                \
  struct name {                                                                 \
    static constexpr Flags kind = Flags::arithmetic;                            \
    static constexpr bool writes = writes_rd;                                   \
    static AddResult compute(uint32_t n, uint32_t m, [[maybe_unused]] bool c) { \
      return add_with_carry(x, y, carry);                                       \
    }                                                                           \
  };
LOGICAL(And, true, n& m)
LOGICAL(Bic, true, n & ~m)
LOGICAL(Orr, true, n | m)
LOGICAL(Orn, true, n | ~m)
LOGICAL(Eor, true, n ^ m)
LOGICAL(Mov, true, m)
LOGICAL(Mvn, true, ~m)
LOGICAL(Tst, false, n& m)
LOGICAL(Teq, false, n ^ m)
ARITHMETIC(Add, true, n, m, false)
ARITHMETIC(Adc, true, n, m, c)
ARITHMETIC(Sbc, true, n, ~m, c)
ARITHMETIC(Sub, true, n, ~m, true)
ARITHMETIC(Rsb, true, ~n, m, true)
ARITHMETIC(Cmp, false, n, ~m, true)
ARITHMETIC(Cmn, false, n, m, false)
#undef LOGICAL
#undef ARITHMETIC

unsigned width_of(const DecodedOp& op) {
  return static_cast<unsigned>(op.field.width);
}

uint32_t bit_mask(unsigned width) {
  return width >= 32 ? ~0u : (1u << width) - 1;
}

}  // namespace

template <typename F, bool immediate, bool shifted, bool flags>
bool Execute::data(Machine& cpu, const Step& op) {
  uint32_t m = immediate ? op.imm : cpu.state.r[op.rm];
  [[maybe_unused]] bool carry = cpu.state.c;
  if constexpr (shifted && immediate) {
    carry = (op.imm >> 31) != 0;
  } else if constexpr (shifted) {
    ShiftResult r = shift_c(m, op.shift.type, op.shift.amount, cpu.state.c);
    m = r.value;
    carry = r.carry;
  }
  if constexpr (F::kind == Flags::logical) {
    uint32_t value = F::compute(cpu.state.r[op.rn], m);
    if constexpr (F::writes) cpu.state.r[op.rd] = value;
    if constexpr (flags) {
      set_nz(cpu, value);
      if constexpr (shifted) cpu.state.c = carry;
    }
  } else {
    AddResult r = F::compute(cpu.state.r[op.rn], m, cpu.state.c);
    if constexpr (F::writes) cpu.state.r[op.rd] = r.value;
    if constexpr (flags) {
      set_nz(cpu, r.value);
      cpu.state.c = r.carry;
      cpu.state.v = r.overflow;
    }
  }
  return true;
}

template <ShiftType type, bool flags>
bool Execute::shift_register(Machine& cpu, const Step& op) {
  ShiftResult r = shift_c(cpu.state.r[op.rn], type, cpu.state.r[op.rm] & 0xFF, cpu.state.c);
  cpu.state.r[op.rd] = r.value;
  if constexpr (flags) {
    set_nz(cpu, r.value);
    cpu.state.c = r.carry;
  }
  return true;
}

const Executors* Execute::data_executors(const DecodedOp& op) {
  const bool shifted = shifter_sets_carry(op), flags = op.set_flags;
  switch (op.operation) {
#define FAMILY(name, F)                                                                      \
  case Operation::name##_imm:                                                                \
    if (!flags) return &both<data<F, true, false, false>>;                                   \
    return shifted ? &both<data<F, true, true, true>> : &both<data<F, true, false, true>>;   \
  case Operation::name##_reg:                                                                \
    if (shifted)                                                                             \
      return flags ? &both<data<F, false, true, true>> : &both<data<F, false, true, false>>; \
    return flags ? &both<data<F, false, false, true>> : &both<data<F, false, false, false>>;
    FAMILY(and, And)
    FAMILY(bic, Bic)
    FAMILY(orr, Orr)
    FAMILY(orn, Orn)
    FAMILY(eor, Eor)
    FAMILY(add, Add)
    FAMILY(adc, Adc)
    FAMILY(sbc, Sbc)
    FAMILY(sub, Sub)
    FAMILY(rsb, Rsb)
    FAMILY(mov, Mov)
    FAMILY(mvn, Mvn)
    FAMILY(tst, Tst)
    FAMILY(teq, Teq)
    FAMILY(cmp, Cmp)
    FAMILY(cmn, Cmn)
#undef FAMILY
#define SHIFT(type)                                             \
  case Operation::type##_reg:                                   \
    return flags ? &both<shift_register<ShiftType::type, true>> \
                 : &both<shift_register<ShiftType::type, false>>;
    SHIFT(lsl)
    SHIFT(lsr)
    SHIFT(asr)
    SHIFT(ror)
#undef SHIFT
#define ONE(name)       \
  case Operation::name: \
    return &both<name>;
    // A table of cases, which the formatter indents again each time.
    // clang-format off
    ONE(add_high)
    ONE(cmp_high)
    ONE(mov_high)
    ONE(adr)
    ONE(movt)
    ONE(sbfx)
    ONE(ubfx)
    ONE(bfi)
    ONE(bfc)
    ONE(ssat)
    ONE(usat)
    ONE(sxtb)
    ONE(sxth)
    ONE(uxtb)
    ONE(uxth)
    ONE(rev)
    ONE(rev16)
    ONE(revsh)
    ONE(rbit)
    ONE(clz)
    ONE(mul)
    ONE(mla)
    ONE(mls)
    ONE(sdiv)
    ONE(udiv)
    // clang-format on
#undef ONE
#define LONG_MULTIPLY(name) \
  case Operation::name:     \
    return op.by_operands ? &both<name> : dsp_executors(op);
    LONG_MULTIPLY(smull)
    LONG_MULTIPLY(umull)
    LONG_MULTIPLY(smlal)
    LONG_MULTIPLY(umlal)
#undef LONG_MULTIPLY
    default:
      return nullptr;
  }
}

template <Handler compare, unsigned condition>
const Step* Execute::compare_and_branch(Machine& cpu, const Step* op) {
  compare(cpu, *op);
  return cpu.state.condition_passed(condition) ? follow(cpu, op + 1) : go_on(cpu, op + 2);
}

template <Handler compare>
Chain Execute::compare_and(unsigned condition) {
  static constexpr Chain chains[16] = {
      compare_and_branch<compare, 0>,  compare_and_branch<compare, 1>,
      compare_and_branch<compare, 2>,  compare_and_branch<compare, 3>,
      compare_and_branch<compare, 4>,  compare_and_branch<compare, 5>,
      compare_and_branch<compare, 6>,  compare_and_branch<compare, 7>,
      compare_and_branch<compare, 8>,  compare_and_branch<compare, 9>,
      compare_and_branch<compare, 10>, compare_and_branch<compare, 11>,
      compare_and_branch<compare, 12>, compare_and_branch<compare, 13>,
      compare_and_branch<compare, 14>, compare_and_branch<compare, 14>};
  return chains[condition & 15];
}

Chain Execute::compare_and_branch_chain(const DecodedOp& op, const DecodedOp& branch) {
  const bool linked = branch.operation == Operation::bcond && branch.it_before == 0 &&
                      linked_branch_chain(branch) != nullptr;
  if (!linked || !op.set_flags) return nullptr;
  const unsigned condition = branch_condition(branch);
  const bool shifted = shifter_sets_carry(op);
  switch (op.operation) {
    case Operation::cmp_imm:
      return compare_and<data<Cmp, true, false, true>>(condition);
    case Operation::cmp_reg:
      return shifted ? nullptr : compare_and<data<Cmp, false, false, true>>(condition);
    case Operation::sub_imm:
      return compare_and<data<Sub, true, false, true>>(condition);
    case Operation::add_imm:
      return compare_and<data<Add, true, false, true>>(condition);
    case Operation::sub_reg:
      return shifted ? nullptr : compare_and<data<Sub, false, false, true>>(condition);
    case Operation::tst_imm:
      return shifted ? nullptr : compare_and<data<Tst, true, false, true>>(condition);
    case Operation::tst_reg:
      return shifted ? nullptr : compare_and<data<Tst, false, false, true>>(condition);
    case Operation::mov_reg:
      return shifted ? compare_and<data<Mov, false, true, true>>(condition) : nullptr;
    default:
      return nullptr;
  }
}

// MOV and ADD to the PC branch without interworking (BranchWritePC, A2.3.1).
static bool write_high(Machine& cpu, const Step& op, uint32_t value) {
  if (op.rd != 15) {
    cpu.state.r[op.rd] = value;
    return true;
  }
  cpu.refill(cpu.profile.timing.refill_register);
  return cpu.branch_to(value);
}

bool Execute::add_high(Machine& cpu, const Step& op) {
  return write_high(cpu, op, read(cpu, op, op.rn) + read(cpu, op, op.rm));
}

bool Execute::mov_high(Machine& cpu, const Step& op) {
  return write_high(cpu, op, read(cpu, op, op.rm));
}

bool Execute::cmp_high(Machine& cpu, const Step& op) {
  AddResult r = add_with_carry(read(cpu, op, op.rn), ~read(cpu, op, op.rm), true);
  set_nz(cpu, r.value);
  cpu.state.c = r.carry;
  cpu.state.v = r.overflow;
  return true;
}

bool Execute::adr(Machine& cpu, const Step& op) {
  cpu.state.r[op.rd] = (pc_of(op) & ~3u) + op.imm;
  return true;
}

bool Execute::movt(Machine& cpu, const Step& op) {
  cpu.state.r[op.rd] = (cpu.state.r[op.rd] & 0xFFFF) | op.imm << 16;
  return true;
}

bool Execute::sbfx(Machine& cpu, const Step& op) {
  // UNPREDICTABLE beyond bit 31: the field ends there
  const unsigned width = std::min<unsigned>(width_of(op), 32u - op.field.lsb);
  cpu.state.r[op.rd] = sign_extend(cpu.state.r[op.rn] >> op.field.lsb, width);
  return true;
}

bool Execute::ubfx(Machine& cpu, const Step& op) {
  cpu.state.r[op.rd] = (cpu.state.r[op.rn] >> op.field.lsb) & bit_mask(width_of(op));
  return true;
}

bool Execute::bfi(Machine& cpu, const Step& op) {
  if (op.field.width < 1) return true;  // UNPREDICTABLE: nothing
  const uint32_t mask = bit_mask(width_of(op)) << op.field.lsb;
  const uint32_t inserted = cpu.state.r[op.rn] << op.field.lsb;
  cpu.state.r[op.rd] = (cpu.state.r[op.rd] & ~mask) | (inserted & mask);
  return true;
}

bool Execute::bfc(Machine& cpu, const Step& op) {
  if (op.field.width < 1) return true;
  cpu.state.r[op.rd] &= ~(bit_mask(width_of(op)) << op.field.lsb);
  return true;
}

bool Execute::ssat(Machine& cpu, const Step& op) {
  uint32_t operand = shift_c(cpu.state.r[op.rn], op.shift.type, op.shift.amount, false).value;
  SaturationResult r = signed_sat_q(static_cast<int32_t>(operand), width_of(op));
  cpu.state.r[op.rd] = r.value;
  cpu.state.q = cpu.state.q || r.saturated;
  return true;
}

bool Execute::usat(Machine& cpu, const Step& op) {
  uint32_t operand = shift_c(cpu.state.r[op.rn], op.shift.type, op.shift.amount, false).value;
  SaturationResult r = unsigned_sat_q(static_cast<int32_t>(operand), width_of(op));
  cpu.state.r[op.rd] = r.value;
  cpu.state.q = cpu.state.q || r.saturated;
  return true;
}

#define UNARY(name, expression)                      \
  bool Execute::name(Machine& cpu, const Step& op) { \
    uint32_t m = cpu.state.r[op.rm];                 \
    cpu.state.r[op.rd] = expression;                 \
    return true;                                     \
  }
UNARY(sxtb, sign_extend(rotate_right(m, op.shift.amount), 8))
UNARY(sxth, sign_extend(rotate_right(m, op.shift.amount), 16))
UNARY(uxtb, rotate_right(m, op.shift.amount) & 0xFF)
UNARY(uxth, rotate_right(m, op.shift.amount) & 0xFFFF)
UNARY(rev, __builtin_bswap32(m))
UNARY(rev16, rotate_right(__builtin_bswap32(m), 16))
UNARY(revsh, sign_extend(__builtin_bswap32(m) >> 16, 16))
UNARY(clz, m == 0 ? 32 : static_cast<uint32_t>(__builtin_clz(m)))
#undef UNARY

bool Execute::rbit(Machine& cpu, const Step& op) {
  uint32_t x = __builtin_bswap32(cpu.state.r[op.rm]);
  x = (x & 0x0F0F0F0F) << 4 | (x >> 4 & 0x0F0F0F0F);
  x = (x & 0x33333333) << 2 | (x >> 2 & 0x33333333);
  cpu.state.r[op.rd] = (x & 0x55555555) << 1 | (x >> 1 & 0x55555555);
  return true;
}

bool Execute::mul(Machine& cpu, const Step& op) {
  uint32_t value = cpu.state.r[op.rn] * cpu.state.r[op.rm];
  cpu.state.r[op.rd] = value;
  if (op.set_flags) set_nz(cpu, value);
  return true;
}

bool Execute::mla(Machine& cpu, const Step& op) {
  cpu.state.r[op.rd] = cpu.state.r[op.ra] + cpu.state.r[op.rn] * cpu.state.r[op.rm];
  return true;
}

bool Execute::mls(Machine& cpu, const Step& op) {
  cpu.state.r[op.rd] = cpu.state.r[op.ra] - cpu.state.r[op.rn] * cpu.state.r[op.rm];
  return true;
}

// Where the time depends on the operands; else execute_dsp.cpp has them.
#define LONG_MULTIPLY(name, product, accumulate, size)                                          \
  bool Execute::name(Machine& cpu, const Step& op) {                                            \
    uint32_t n = cpu.state.r[op.rn], m = cpu.state.r[op.rm];                                    \
    uint64_t sum = static_cast<uint64_t>(cpu.state.r[op.ra]) << 32 | cpu.state.r[op.rd];        \
    uint64_t value = (product) + ((accumulate) ? sum : 0);                                      \
    cpu.state.cycles += (accumulate) ? timing::multiply_accumulate_long_extra(size(n), size(m)) \
                                     : timing::multiply_long_extra(size(n), size(m));           \
    cpu.state.r[op.rd] = static_cast<uint32_t>(value);                                          \
    cpu.state.r[op.ra] = static_cast<uint32_t>(value >> 32);                                    \
    return true;                                                                                \
  }
#define SIGNED(x) static_cast<int64_t>(static_cast<int32_t>(x))
LONG_MULTIPLY(smull, static_cast<uint64_t>(SIGNED(n) * SIGNED(m)), false, timing::magnitude)
LONG_MULTIPLY(umull, static_cast<uint64_t>(n) * m, false, uint32_t)
LONG_MULTIPLY(smlal, static_cast<uint64_t>(SIGNED(n) * SIGNED(m)), true, timing::magnitude)
LONG_MULTIPLY(umlal, static_cast<uint64_t>(n) * m, true, uint32_t)
#undef SIGNED
#undef LONG_MULTIPLY

bool Execute::udiv(Machine& cpu, const Step& op) {
  uint32_t n = cpu.state.r[op.rn], m = cpu.state.r[op.rm];
  if (m == 0 && cpu.state.scb.traps_division_by_zero()) return cpu.fault(op, Cause::divide_by_zero);
  cpu.state.r[op.rd] = m == 0 ? 0 : n / m;
  cpu.state.cycles += timing::divide_extra(n, m);
  return true;
}

bool Execute::sdiv(Machine& cpu, const Step& op) {
  uint32_t n = cpu.state.r[op.rn], m = cpu.state.r[op.rm];
  if (m == 0 && cpu.state.scb.traps_division_by_zero()) return cpu.fault(op, Cause::divide_by_zero);
  // In 64 bits the smallest number divided by -1 wraps to itself, as the architecture has it.
  int64_t quotient = m == 0 ? 0 : int64_t{static_cast<int32_t>(n)} / static_cast<int32_t>(m);
  cpu.state.r[op.rd] = static_cast<uint32_t>(quotient);
  cpu.state.cycles += timing::divide_extra(timing::magnitude(n), timing::magnitude(m));
  return true;
}

}  // namespace capsoc::armv7m
