// The DSP extension of Armv7-M (ARM DDI 0403, A7.7 under each name), and the long multiplications
// of a multiplier that takes one cycle.
#include "armv7m/executors/execute.h"

namespace capsoc::armv7m {
namespace {

int32_t bottom(uint32_t x) {
  return static_cast<int16_t>(x);
}
int32_t top(uint32_t x) {
  return static_cast<int16_t>(x >> 16);
}
int64_t signed_of(uint32_t x) {
  return static_cast<int32_t>(x);
}
uint32_t halves(uint32_t high, uint32_t low) {
  return high << 16 | (low & 0xFFFF);
}

/// Q is set by what does not fit, and never cleared.
uint32_t wrap_q(Machine& cpu, int64_t value) {
  const auto word = static_cast<int32_t>(value);
  cpu.state.q = cpu.state.q || word != value;
  return static_cast<uint32_t>(word);
}
uint32_t saturate_q(Machine& cpu, int64_t value) {
  const int64_t fits = value > INT32_MAX ? INT32_MAX : value < INT32_MIN ? INT32_MIN : value;
  cpu.state.q = cpu.state.q || fits != value;
  return static_cast<uint32_t>(fits);
}
uint32_t saturate_q(Machine& cpu, SaturationResult r) {
  cpu.state.q = cpu.state.q || r.saturated;
  return r.value;
}

unsigned width_of(const DecodedOp& op) {
  return static_cast<unsigned>(op.field.width);
}

enum class Lanes { add16, asx, sax, sub16, add8, sub8 };
enum class Keeps { low_bits, saturated, half };

/// The 36 parallel sums and differences. Only those that keep the low bits set GE: a sum or
/// difference is not negative, an unsigned sum carries.
template <bool is_signed, Keeps keeps, Lanes lanes>
bool parallel(Machine& cpu, const Step& op) {
  constexpr bool bytes = lanes == Lanes::add8 || lanes == Lanes::sub8;
  constexpr bool exchanges = lanes == Lanes::asx || lanes == Lanes::sax;
  constexpr unsigned width = bytes ? 8 : 16, count = 32 / width;
  constexpr uint32_t mask = (1u << width) - 1, flags = bytes ? 1 : 3;
  const uint32_t n = cpu.state.r[op.rn], m = rotate_right(cpu.state.r[op.rm], exchanges ? 16 : 0);
  uint32_t result = 0, ge = 0;
  for (unsigned lane = 0; lane < count; ++lane) {
    const unsigned at = lane * width;
    const auto part = [&](uint32_t x) {
      const uint32_t bits = x >> at & mask;
      return static_cast<int32_t>(is_signed ? sign_extend(bits, width) : bits);
    };
    const bool adds = exchanges ? (lane == 1) == (lanes == Lanes::asx)
                                : lanes == Lanes::add16 || lanes == Lanes::add8;
    const int32_t value = adds ? part(n) + part(m) : part(n) - part(m);
    const bool carries = !is_signed && adds;
    if (carries ? value >> width != 0 : value >= 0) ge |= flags << at / 8;
    uint32_t kept = static_cast<uint32_t>(value);
    if constexpr (keeps == Keeps::saturated)
      kept = (is_signed ? signed_sat_q(value, width) : unsigned_sat_q(value, width)).value;
    if constexpr (keeps == Keeps::half) kept = static_cast<uint32_t>(value >> 1);
    result |= (kept & mask) << at;
  }
  cpu.state.r[op.rd] = result;
  if constexpr (keeps == Keeps::low_bits) cpu.state.ge = static_cast<uint8_t>(ge);
  return true;
}

/// Operands of a multiplication of halfwords: imm has the bits of the encoding.
struct Products {
  int64_t low, high;  ///< of the bottom halves, and of the top ones
};
Products products(const Machine& cpu, const Step& op) {
  const uint32_t n = cpu.state.r[op.rn], m = cpu.state.r[op.rm];
  const bool exchange = (op.imm & 1) != 0;
  return {int64_t{bottom(n)} * (exchange ? top(m) : bottom(m)),
          int64_t{top(n)} * (exchange ? bottom(m) : top(m))};
}
int64_t product_of_halves(const Machine& cpu, const Step& op) {
  const uint32_t n = cpu.state.r[op.rn], m = cpu.state.r[op.rm];
  return int64_t{(op.imm & 2) != 0 ? top(n) : bottom(n)} * ((op.imm & 1) != 0 ? top(m) : bottom(m));
}
int64_t product_with_half(const Machine& cpu, const Step& op) {
  const uint32_t m = cpu.state.r[op.rm];
  return signed_of(cpu.state.r[op.rn]) * ((op.imm & 1) != 0 ? top(m) : bottom(m));
}
int64_t signed_product(const Machine& cpu, const Step& op) {
  return signed_of(cpu.state.r[op.rn]) * signed_of(cpu.state.r[op.rm]);
}
/// The most significant word of the sum of a word there and a product.
uint32_t most_significant(const Machine& cpu, const Step& op, uint32_t word, bool subtract) {
  const auto product = static_cast<uint64_t>(signed_product(cpu, op));
  const uint64_t rounding = (op.imm & 1) != 0 ? 0x80000000u : 0;
  const uint64_t sum = uint64_t{word} << 32;
  const uint64_t result = (subtract ? sum - product : sum + product) + rounding;
  return static_cast<uint32_t>(result >> 32);
}

bool set_long(Machine& cpu, const Step& op, uint64_t value) {
  cpu.state.r[op.rd] = static_cast<uint32_t>(value);
  cpu.state.r[op.ra] = static_cast<uint32_t>(value >> 32);
  return true;
}

bool accumulate_long(Machine& cpu, const Step& op, int64_t addend) {
  const uint64_t sum =
      (uint64_t{cpu.state.r[op.ra]} << 32 | cpu.state.r[op.rd]) + static_cast<uint64_t>(addend);
  return set_long(cpu, op, sum);
}

uint64_t unsigned_product(const Machine& cpu, const Step& op) {
  return uint64_t{cpu.state.r[op.rn]} * cpu.state.r[op.rm];
}
bool smull_at_once(Machine& cpu, const Step& op) {
  return set_long(cpu, op, static_cast<uint64_t>(signed_product(cpu, op)));
}
bool umull_at_once(Machine& cpu, const Step& op) {
  return set_long(cpu, op, unsigned_product(cpu, op));
}
bool smlal_at_once(Machine& cpu, const Step& op) {
  return accumulate_long(cpu, op, signed_product(cpu, op));
}
bool umlal_at_once(Machine& cpu, const Step& op) {
  return accumulate_long(cpu, op, static_cast<int64_t>(unsigned_product(cpu, op)));
}

uint32_t saturated_halves(Machine& cpu, const Step& op,
                          SaturationResult (*saturated)(int32_t x, unsigned bits)) {
  const uint32_t n = cpu.state.r[op.rn];
  const unsigned width = width_of(op);
  const uint32_t low = saturate_q(cpu, saturated(bottom(n), width));
  return halves(saturate_q(cpu, saturated(top(n), width)), low);
}

uint32_t sum_of_differences(uint32_t n, uint32_t m) {
  uint32_t sum = 0;
  for (unsigned at = 0; at < 32; at += 8) {
    const uint32_t x = n >> at & 0xFF, y = m >> at & 0xFF;
    sum += x > y ? x - y : y - x;
  }
  return sum;
}

}  // namespace

// What writes Rd. n, m and a: Rn, Rm and Ra; rotated: Rm for the extensions.
#define WRITES_RD(name, expression)                                                 \
  bool Execute::name(Machine& cpu, const Step& op) {                                \
    [[maybe_unused]] const uint32_t n = cpu.state.r[op.rn], m = cpu.state.r[op.rm]; \
    [[maybe_unused]] const uint32_t a = cpu.state.r[op.ra];                         \
    [[maybe_unused]] const uint32_t rotated = rotate_right(m, op.shift.amount);     \
    cpu.state.r[op.rd] = expression;                                                \
    return true;                                                                    \
  }
WRITES_RD(sxtah, n + sign_extend(rotated, 16))
WRITES_RD(sxtab, n + sign_extend(rotated, 8))
WRITES_RD(sxtab16, halves((n >> 16) + sign_extend(rotated >> 16, 8), n + sign_extend(rotated, 8)))
WRITES_RD(sxtb16, halves(sign_extend(rotated >> 16, 8), sign_extend(rotated, 8)))
WRITES_RD(uxtah, n + (rotated & 0xFFFF))
WRITES_RD(uxtab, n + (rotated & 0xFF))
WRITES_RD(uxtab16, halves((n >> 16) + (rotated >> 16 & 0xFF), n + (rotated & 0xFF)))
WRITES_RD(uxtb16, rotated & 0x00FF00FF)
WRITES_RD(pkhbt, halves(shift_c(m, op.shift.type, op.shift.amount, false).value >> 16, n))
WRITES_RD(pkhtb, halves(n >> 16, shift_c(m, op.shift.type, op.shift.amount, false).value))
WRITES_RD(qadd, saturate_q(cpu, signed_of(m) + signed_of(n)))
WRITES_RD(qsub, saturate_q(cpu, signed_of(m) - signed_of(n)))
WRITES_RD(qdadd, saturate_q(cpu, signed_of(m) + signed_of(saturate_q(cpu, 2 * signed_of(n)))))
WRITES_RD(qdsub, saturate_q(cpu, signed_of(m) - signed_of(saturate_q(cpu, 2 * signed_of(n)))))
WRITES_RD(smulxy, wrap_q(cpu, product_of_halves(cpu, op)))
WRITES_RD(smlaxy, wrap_q(cpu, product_of_halves(cpu, op) + signed_of(a)))
WRITES_RD(smulw, wrap_q(cpu, product_with_half(cpu, op) >> 16))
WRITES_RD(smlaw, wrap_q(cpu, (product_with_half(cpu, op) >> 16) + signed_of(a)))
WRITES_RD(smuad, wrap_q(cpu, products(cpu, op).low + products(cpu, op).high))
WRITES_RD(smlad, wrap_q(cpu, products(cpu, op).low + products(cpu, op).high + signed_of(a)))
WRITES_RD(smusd, wrap_q(cpu, products(cpu, op).low - products(cpu, op).high))
WRITES_RD(smlsd, wrap_q(cpu, products(cpu, op).low - products(cpu, op).high + signed_of(a)))
WRITES_RD(smmul, most_significant(cpu, op, 0, false))
WRITES_RD(smmla, most_significant(cpu, op, a, false))
WRITES_RD(smmls, most_significant(cpu, op, a, true))
WRITES_RD(ssat16, saturated_halves(cpu, op, signed_sat_q))
WRITES_RD(usat16, saturated_halves(cpu, op, unsigned_sat_q))
WRITES_RD(usad8, sum_of_differences(n, m))
WRITES_RD(usada8, a + sum_of_differences(n, m))
#undef WRITES_RD

bool Execute::sel(Machine& cpu, const Step& op) {
  uint32_t from_n = 0;
  for (unsigned lane = 0; lane < 4; ++lane)
    if ((cpu.state.ge >> lane & 1) != 0) from_n |= 0xFFu << 8 * lane;
  cpu.state.r[op.rd] = (cpu.state.r[op.rn] & from_n) | (cpu.state.r[op.rm] & ~from_n);
  return true;
}

bool Execute::smlalxy(Machine& cpu, const Step& op) {
  return accumulate_long(cpu, op, product_of_halves(cpu, op));
}
bool Execute::smlald(Machine& cpu, const Step& op) {
  return accumulate_long(cpu, op, products(cpu, op).low + products(cpu, op).high);
}
bool Execute::smlsld(Machine& cpu, const Step& op) {
  return accumulate_long(cpu, op, products(cpu, op).low - products(cpu, op).high);
}

bool Execute::umaal(Machine& cpu, const Step& op) {
  const uint64_t sum =
      uint64_t{cpu.state.r[op.rn]} * cpu.state.r[op.rm] + cpu.state.r[op.rd] + cpu.state.r[op.ra];
  return set_long(cpu, op, sum);
}

const Executors* Execute::dsp_executors(const DecodedOp& op) {
  switch (op.operation) {
#define LANES(prefix, is_signed, keeps, name) \
  case Operation::prefix##name:               \
    return &both<parallel<is_signed, Keeps::keeps, Lanes::name>>;
#define PARALLEL(prefix, is_signed, keeps) \
  LANES(prefix, is_signed, keeps, add16)   \
  LANES(prefix, is_signed, keeps, asx)     \
  LANES(prefix, is_signed, keeps, sax)     \
  LANES(prefix, is_signed, keeps, sub16)   \
  LANES(prefix, is_signed, keeps, add8)    \
  LANES(prefix, is_signed, keeps, sub8)
    PARALLEL(s, true, low_bits)
    PARALLEL(q, true, saturated)
    PARALLEL(sh, true, half)
    PARALLEL(u, false, low_bits)
    PARALLEL(uq, false, saturated)
    PARALLEL(uh, false, half)
#undef PARALLEL
#undef LANES
    case Operation::smull:
      return &both<smull_at_once>;
    case Operation::umull:
      return &both<umull_at_once>;
    case Operation::smlal:
      return &both<smlal_at_once>;
    case Operation::umlal:
      return &both<umlal_at_once>;
#define ONE(name)       \
  case Operation::name: \
    return &both<name>;
      // A table of cases, which the formatter indents again each time.
      // clang-format off
    ONE(sxtab)
    ONE(sxtab16)
    ONE(sxtah)
    ONE(sxtb16)
    ONE(uxtab)
    ONE(uxtab16)
    ONE(uxtah)
    ONE(uxtb16)
    ONE(pkhbt)
    ONE(pkhtb)
    ONE(sel)
    ONE(qadd)
    ONE(qdadd)
    ONE(qsub)
    ONE(qdsub)
    ONE(ssat16)
    ONE(usat16)
    ONE(smulxy)
    ONE(smlaxy)
    ONE(smulw)
    ONE(smlaw)
    ONE(smuad)
    ONE(smlad)
    ONE(smusd)
    ONE(smlsd)
    ONE(smmul)
    ONE(smmla)
    ONE(smmls)
    ONE(usad8)
    ONE(usada8)
    ONE(smlalxy)
    ONE(smlald)
    ONE(smlsld)
    ONE(umaal)
      // clang-format on
#undef ONE
    default:
      return nullptr;
  }
}

}  // namespace capsoc::armv7m
