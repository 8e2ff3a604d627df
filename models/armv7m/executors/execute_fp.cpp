// The floating-point extension (ARM DDI 0403, A7.7 under each name).
#include <algorithm>
#include <array>

#include "armv7m/executors/execute.h"
#include "armv7m/isa/single_precision.h"

namespace capsoc::armv7m {
namespace {

/// A register that there is not reads as zero and ignores writes.
uint32_t read_single(const Fpu& fpu, unsigned n) {
  return n < Fpu::registers ? fpu.s(n) : 0;
}
void write_single(Fpu& fpu, unsigned n, uint32_t value) {
  if (n < Fpu::registers) fpu.set_s(n, value);
}

constexpr uint32_t bit_7 = 1u << 7;

/// A fixed-point number of VCVT (A7.7.228).
single::Fixed fixed_point(const Step& op) {
  single::Fixed format;
  format.width = (op.encoding & bit_7) != 0 ? 32 : 16;
  format.fraction_bits = op.imm;
  format.is_unsigned = (op.encoding & 1u << 16) != 0;
  return format;
}

/// Address of the first word, and what the base becomes.
struct FpTransfer {
  uint32_t address, written_back;
};
FpTransfer ascending(uint32_t base, const Step& op) {
  return {base, base + op.imm};
}
FpTransfer descending(uint32_t base, const Step& op) {
  return {base - op.imm, base - op.imm};
}

}  // namespace

/// What an instruction does once it may use the extension.
#define FP_INSTRUCTION(name)                                   \
  static void name##_in_context(Machine& cpu, const Step& op); \
  bool Execute::name(Machine& cpu, const Step& op) {           \
    const Access access = cpu.floating_point.begin(op);        \
    if (access == Access::fault) return false;                 \
    name##_in_context(cpu, op);                                \
    return access == Access::ok || cpu.leave(op);              \
  }                                                            \
  static void name##_in_context([[maybe_unused]] Machine& cpu, const Step& op)

// What writes Sd. d, n and m: Sd, Sn and Sm; status: FPSCR.
#define WRITES_SD(name, expression)                                   \
  FP_INSTRUCTION(name) {                                              \
    Fpu& fpu = cpu.state.fpu;                                         \
    [[maybe_unused]] Fpscr& status = fpu.status();                    \
    const uint32_t d = fpu.s(fp_operand::d(op));                      \
    const uint32_t n = fpu.s(fp_operand::n(op));                      \
    const uint32_t m = fpu.s(fp_operand::m(op));                      \
    static_cast<void>(d), static_cast<void>(n), static_cast<void>(m); \
    fpu.set_s(fp_operand::d(op), expression);                         \
  }
WRITES_SD(vadd, single::add(n, m, status))
WRITES_SD(vsub, single::subtract(n, m, status))
WRITES_SD(vmul, single::multiply(n, m, status))
WRITES_SD(vnmul, single::negate(single::multiply(n, m, status)))
WRITES_SD(vmla, single::add(d, single::multiply(n, m, status), status))
WRITES_SD(vmls, single::add(d, single::negate(single::multiply(n, m, status)), status))
WRITES_SD(vnmla,
          single::add(single::negate(d), single::negate(single::multiply(n, m, status)), status))
WRITES_SD(vnmls, single::add(single::negate(d), single::multiply(n, m, status), status))
WRITES_SD(vfma, single::multiply_add(d, n, m, status))
WRITES_SD(vfms, single::multiply_add(d, single::negate(n), m, status))
WRITES_SD(vfnma, single::multiply_add(single::negate(d), single::negate(n), m, status))
WRITES_SD(vfnms, single::multiply_add(single::negate(d), n, m, status))
WRITES_SD(vdiv, single::divide(n, m, status))
WRITES_SD(vsqrt, single::square_root(m, status))
WRITES_SD(vabs, single::absolute(m))
WRITES_SD(vneg, single::negate(m))
WRITES_SD(vmov_reg, m)
WRITES_SD(vmov_imm, op.imm)
WRITES_SD(vcvt_from_integer,
          single::from_fixed(m, {32, 0, (op.encoding & bit_7) == 0}, false, status))
WRITES_SD(vcvt_to_integer, single::to_fixed(m, {32, 0, (op.encoding & 1u << 16) == 0},
                                            (op.encoding & bit_7) != 0, status))
WRITES_SD(vcvt_from_fixed, single::from_fixed(d, fixed_point(op), true, status))
WRITES_SD(vcvt_to_fixed, single::to_fixed(d, fixed_point(op), true, status))
WRITES_SD(vcvt_from_half,
          single::from_half((op.encoding & bit_7) != 0 ? m >> 16 : m & 0xFFFF, status))
WRITES_SD(vcvt_to_half, (op.encoding & bit_7) != 0 ? (d & 0xFFFF) | single::to_half(m, status) << 16
                                                   : (d & 0xFFFF0000) | single::to_half(m, status))
#undef WRITES_SD

FP_INSTRUCTION(vcmp) {
  Fpu& fpu = cpu.state.fpu;
  const uint32_t flags = single::compare(fpu.s(fp_operand::d(op)), fpu.s(fp_operand::m(op)),
                                         (op.encoding & bit_7) != 0, fpu.status());
  fpu.status().set_nzcv(flags);
}
FP_INSTRUCTION(vcmp_zero) {
  Fpu& fpu = cpu.state.fpu;
  const uint32_t flags =
      single::compare(fpu.s(fp_operand::d(op)), 0, (op.encoding & bit_7) != 0, fpu.status());
  fpu.status().set_nzcv(flags);
}

FP_INSTRUCTION(vmov_to_core) {
  cpu.state.r[op.rd] = cpu.state.fpu.s(fp_operand::moved(op));
}
FP_INSTRUCTION(vmov_from_core) {
  cpu.state.fpu.set_s(fp_operand::moved(op), cpu.state.r[op.rd]);
}
FP_INSTRUCTION(vmov_pair_to_core) {
  const unsigned first = fp_operand::pair(op);
  cpu.state.r[op.rd] = read_single(cpu.state.fpu, first);
  cpu.state.r[op.ra] = read_single(cpu.state.fpu, first + 1);
}
FP_INSTRUCTION(vmov_pair_from_core) {
  const unsigned first = fp_operand::pair(op);
  write_single(cpu.state.fpu, first, cpu.state.r[op.rd]);
  write_single(cpu.state.fpu, first + 1, cpu.state.r[op.ra]);
}
FP_INSTRUCTION(vmrs) {
  State& state = cpu.state;
  const uint32_t fpscr = state.fpu.status().bits();
  if (op.rd == 15)
    state.set_apsr((state.xpsr() & ~Fpscr::nzcv) | (fpscr & Fpscr::nzcv));
  else
    state.r[op.rd] = fpscr;
}
FP_INSTRUCTION(vmsr) {
  cpu.state.fpu.status() = Fpscr(cpu.state.r[op.rd]);
}
#undef FP_INSTRUCTION

// Loads and stores fault when unaligned whatever CCR says (A3.2.1). The base is written last, as by
// LDM.
bool Execute::load_singles(Machine& cpu, const Step& op, uint32_t address, unsigned count,
                           uint32_t written_back) {
  Access all = cpu.floating_point.begin(op);
  if (all == Access::fault) return false;
  if ((address & 3) != 0) return cpu.fault(op, Cause::unaligned, address);
  std::array<uint32_t, Fpu::registers> loaded;
  const unsigned first = fp_operand::first(op);
  count = std::min(count, Fpu::registers - first);
  for (unsigned i = 0; i < count; ++i) {
    const Access one = cpu.memory.load<uint32_t>(op, address + 4 * i, loaded[i]);
    if (one == Access::fault) return false;
    all = std::max(all, one);
  }
  for (unsigned i = 0; i < count; ++i) cpu.state.fpu.set_s(first + i, loaded[i]);
  if (op.writeback) cpu.state.r[op.rn] = written_back;
  return all == Access::ok || cpu.leave(op);
}

bool Execute::store_singles(Machine& cpu, const Step& op, uint32_t address, unsigned count,
                            uint32_t written_back) {
  Access all = cpu.floating_point.begin(op);
  if (all == Access::fault) return false;
  if ((address & 3) != 0) return cpu.fault(op, Cause::unaligned, address);
  const unsigned first = fp_operand::first(op);
  for (unsigned i = 0; i < std::min(count, Fpu::registers); ++i) {
    const uint32_t value = read_single(cpu.state.fpu, first + i);
    const Access one = cpu.memory.store<uint32_t>(op, address + 4 * i, value);
    if (one == Access::fault) return false;
    all = std::max(all, one);
  }
  if (op.writeback) cpu.state.r[op.rn] = written_back;
  return all == Access::ok || cpu.leave(op);
}

bool Execute::vldr(Machine& cpu, const Step& op) {
  const bool literal = op.addressing == Addressing::literal;
  const uint32_t base = literal ? pc_of(op) & ~3u : cpu.state.r[op.rn];
  return load_singles(cpu, op, base + op.imm, fp_operand::is_double(op) ? 2 : 1, 0);
}
bool Execute::vstr(Machine& cpu, const Step& op) {
  const uint32_t address = cpu.state.r[op.rn] + op.imm;
  return store_singles(cpu, op, address, fp_operand::is_double(op) ? 2 : 1, 0);
}
bool Execute::vldm(Machine& cpu, const Step& op) {
  const FpTransfer at = ascending(cpu.state.r[op.rn], op);
  return load_singles(cpu, op, at.address, fp_operand::count(op), at.written_back);
}
bool Execute::vldmdb(Machine& cpu, const Step& op) {
  const FpTransfer at = descending(cpu.state.r[op.rn], op);
  return load_singles(cpu, op, at.address, fp_operand::count(op), at.written_back);
}
bool Execute::vstm(Machine& cpu, const Step& op) {
  const FpTransfer at = ascending(cpu.state.r[op.rn], op);
  return store_singles(cpu, op, at.address, fp_operand::count(op), at.written_back);
}
bool Execute::vstmdb(Machine& cpu, const Step& op) {
  const FpTransfer at = descending(cpu.state.r[op.rn], op);
  return store_singles(cpu, op, at.address, fp_operand::count(op), at.written_back);
}

bool Execute::fp_undefined(Machine& cpu, const Step& op) {
  const bool enabled = cpu.state.fpu.enabled(cpu.state.privileged());
  return cpu.fault(op, enabled ? Cause::undefined_instruction : Cause::no_coprocessor);
}

const Executors* Execute::fp_executors(const DecodedOp& op) {
  switch (op.operation) {
#define ONE(name)       \
  case Operation::name: \
    return &both<name>;
    // A table of cases, which the formatter indents again each time.
    // clang-format off
    ONE(vadd)
    ONE(vsub)
    ONE(vmul)
    ONE(vnmul)
    ONE(vmla)
    ONE(vmls)
    ONE(vnmla)
    ONE(vnmls)
    ONE(vfma)
    ONE(vfms)
    ONE(vfnma)
    ONE(vfnms)
    ONE(vdiv)
    ONE(vsqrt)
    ONE(vabs)
    ONE(vneg)
    ONE(vmov_reg)
    ONE(vmov_imm)
    ONE(vcmp)
    ONE(vcmp_zero)
    ONE(vcvt_from_integer)
    ONE(vcvt_to_integer)
    ONE(vcvt_from_fixed)
    ONE(vcvt_to_fixed)
    ONE(vcvt_from_half)
    ONE(vcvt_to_half)
    ONE(vmov_to_core)
    ONE(vmov_from_core)
    ONE(vmov_pair_to_core)
    ONE(vmov_pair_from_core)
    ONE(vmrs)
    ONE(vmsr)
    ONE(vldr)
    ONE(vstr)
    ONE(vldm)
    ONE(vldmdb)
    ONE(vstm)
    ONE(vstmdb)
    ONE(fp_undefined)
    // clang-format on
#undef ONE
    default:
      return nullptr;
  }
}

}  // namespace capsoc::armv7m
