#include "armv7m/isa/single_precision.h"

#include <initializer_list>

namespace capsoc::armv7m::single {
namespace {

/// A binary format of IEEE 754.
struct Format {
  unsigned fraction_bits;
  int least_exponent;         ///< of a normal number
  unsigned largest_exponent;  ///< as it is encoded: of infinities and NaNs
};
constexpr Format single_format{23, -126, 0xFF}, half_format{10, -14, 0x1F};
constexpr uint32_t default_nan = 0x7FC00000, infinity = 0x7F800000, quiet_bit = 1u << 22;

enum class Kind : uint8_t { zero, nonzero, infinite, quiet_nan, signaling_nan };

/// A number as FPUnpack has it. Of a nonzero one the value is significand * 2^(exponent - 63), and
/// bit 63 of the significand is set.
struct Unpacked {
  Kind kind = Kind::zero;
  bool negative = false;
  int exponent = 0;
  uint64_t significand = 0;

  bool is_nan() const { return kind == Kind::quiet_nan || kind == Kind::signaling_nan; }
  bool is_zero() const { return kind == Kind::zero; }
  bool is_infinite() const { return kind == Kind::infinite; }
};

/// A finite number with its leading one moved to bit 63; zero if there is none.
Unpacked normalized(bool negative, int exponent, uint64_t significand) {
  if (significand == 0) return {Kind::zero, negative, 0, 0};
  const int leading = __builtin_clzll(significand);
  return {Kind::nonzero, negative, exponent - leading, significand << leading};
}

/// FPUnpack of a single-precision number.
Unpacked unpack(uint32_t bits, Fpscr& fpscr) {
  const bool negative = (bits & sign_bit) != 0;
  const uint32_t exponent = bits >> 23 & 0xFF, fraction = bits & 0x7FFFFF;
  if (exponent == single_format.largest_exponent) {
    if (fraction == 0) return {Kind::infinite, negative, 0, 0};
    return {(fraction & quiet_bit) != 0 ? Kind::quiet_nan : Kind::signaling_nan, negative, 0, 0};
  }
  if (exponent != 0)
    return {Kind::nonzero, negative, static_cast<int>(exponent) - 127,
            uint64_t{fraction | 1u << 23} << 40};
  if (fraction != 0 && fpscr.flushes()) {
    fpscr.raise(Fpscr::input_denormal);
    return {Kind::zero, negative, 0, 0};
  }
  return normalized(negative, single_format.least_exponent, uint64_t{fraction} << 40);
}

/// Half-precision numbers are never flushed; the alternative format has neither infinity nor NaN.
Unpacked unpack_half(uint32_t bits, const Fpscr& fpscr) {
  const bool negative = (bits & 0x8000) != 0;
  const uint32_t exponent = bits >> 10 & 0x1F, fraction = bits & 0x3FF;
  if (exponent == half_format.largest_exponent && !fpscr.alternative_half()) {
    if (fraction == 0) return {Kind::infinite, negative, 0, 0};
    return {(fraction & 0x200) != 0 ? Kind::quiet_nan : Kind::signaling_nan, negative, 0, 0};
  }
  if (exponent != 0)
    return {Kind::nonzero, negative, static_cast<int>(exponent) - 15,
            uint64_t{fraction | 1u << 10} << 53};
  return normalized(negative, half_format.least_exponent, uint64_t{fraction} << 53);
}

uint32_t sign_of(bool negative) {
  return negative ? sign_bit : 0;
}
uint32_t invalid(Fpscr& fpscr) {
  fpscr.raise(Fpscr::invalid);
  return default_nan;
}

/// FPProcessNaN.
uint32_t process_nan(Kind kind, uint32_t bits, Fpscr& fpscr) {
  if (kind == Kind::signaling_nan) fpscr.raise(Fpscr::invalid);
  return fpscr.default_nan() ? default_nan : bits | quiet_bit;
}

struct Operand {
  uint32_t bits;
  Unpacked number;
};
/// FPProcessNaNs, FPProcessNaNs3: the first signaling NaN, else the first quiet one. False: none.
template <unsigned count>
bool process_nans(const Operand* const (&operands)[count], uint32_t& result, Fpscr& fpscr) {
  for (const Kind kind : {Kind::signaling_nan, Kind::quiet_nan}) {
    for (const Operand* operand : operands) {
      if (operand->number.kind != kind) continue;
      result = process_nan(kind, operand->bits, fpscr);
      return true;
    }
  }
  return false;
}

/// The bits of a significand above a place that is not the lowest, and what is left below it.
struct Split {
  uint64_t whole = 0;
  uint64_t rest = 0;  ///< bit 63: a half
};
Split split(uint64_t significand, int below) {
  if (below < 64) return {significand >> below, significand << (64 - below)};
  if (below == 64) return {0, significand};
  return {0, below < 128 ? (significand >> (below - 64)) | 1 : 1};
}

bool rounds_up(const Split& parts, bool negative, Fpscr::Rounding rounding) {
  constexpr uint64_t half = uint64_t{1} << 63;
  switch (rounding) {
    case Fpscr::Rounding::nearest:
      return parts.rest > half || (parts.rest == half && (parts.whole & 1) != 0);
    case Fpscr::Rounding::plus:
      return parts.rest != 0 && !negative;
    case Fpscr::Rounding::minus:
      return parts.rest != 0 && negative;
    default:
      return false;
  }
}
/// Whether a number that is too large becomes an infinity, or the largest that is finite.
bool overflows_to_infinity(bool negative, Fpscr::Rounding rounding) {
  return rounding == Fpscr::Rounding::nearest ||
         rounding == (negative ? Fpscr::Rounding::minus : Fpscr::Rounding::plus);
}

/// FPRound of a nonzero number, without its sign. Bit 0 of the significand stands for all below it.
uint32_t round_magnitude(const Unpacked& number, const Format& format, Fpscr::Rounding rounding,
                         Fpscr& fpscr) {
  const bool is_half = format.fraction_bits == half_format.fraction_bits;
  const int below_normal = format.least_exponent - number.exponent;
  if (below_normal > 0 && fpscr.flushes() && !is_half) {
    fpscr.raise(Fpscr::underflow);
    return 0;
  }
  const bool tiny = below_normal > 0;  // before rounding
  const int below = 63 - static_cast<int>(format.fraction_bits) + (tiny ? below_normal : 0);
  const Split parts = split(number.significand, below);
  bool exact = parts.rest == 0;
  if (tiny && !exact) fpscr.raise(Fpscr::underflow);
  // The leading one of a normal number counts in the exponent: one less there.
  const uint32_t exponent = tiny ? 0 : static_cast<uint32_t>(-below_normal);
  const uint32_t up = rounds_up(parts, number.negative, rounding) ? 1 : 0;
  const uint64_t sum =
      (uint64_t{exponent} << format.fraction_bits) + parts.whole + up;  // carries into it
  const uint64_t infinite = uint64_t{format.largest_exponent} << format.fraction_bits;
  uint32_t result = static_cast<uint32_t>(sum);
  if (is_half && fpscr.alternative_half()) {
    if (sum >= uint64_t{1} << 15) {
      result = 0x7FFF;
      fpscr.raise(Fpscr::invalid);
      exact = true;
    }
  } else if (sum >= infinite) {
    const bool to_infinity = overflows_to_infinity(number.negative, rounding);
    result = static_cast<uint32_t>(to_infinity ? infinite : infinite - 1);
    fpscr.raise(Fpscr::overflow);
    exact = false;
  }
  if (!exact) fpscr.raise(Fpscr::inexact);
  return result;
}
uint32_t round(const Unpacked& number, Fpscr::Rounding rounding, Fpscr& fpscr) {
  return sign_of(number.negative) | round_magnitude(number, single_format, rounding, fpscr);
}
uint32_t round(const Unpacked& number, Fpscr& fpscr) {
  return round(number, fpscr.rounding(), fpscr);
}

/// Shifts right and keeps in bit 0 whether anything was lost.
uint64_t shift_sticky(uint64_t value, int by) {
  if (by == 0) return value;
  if (by > 63) return value != 0 ? 1 : 0;
  return value >> by | ((value << (64 - by)) != 0 ? 1 : 0);
}

/// The sum of two finite numbers that are not both zero.
uint32_t sum(Unpacked x, Unpacked y, Fpscr& fpscr) {
  if (x.is_zero()) return round(y, fpscr);
  if (y.is_zero()) return round(x, fpscr);
  const bool swap =
      x.exponent < y.exponent || (x.exponent == y.exponent && x.significand < y.significand);
  const Unpacked &larger = swap ? y : x, &smaller = swap ? x : y;
  // A place for the carry. Significands of two operands have zeros in their low bits.
  const uint64_t high = larger.significand >> 1;
  const uint64_t low = shift_sticky(smaller.significand >> 1, larger.exponent - smaller.exponent);
  const bool subtracts = x.negative != y.negative;
  const Unpacked result =
      normalized(larger.negative, larger.exponent + 1, subtracts ? high - low : high + low);
  if (result.is_zero()) return sign_of(fpscr.rounding() == Fpscr::Rounding::minus);
  return round(result, fpscr);
}

Unpacked product(const Unpacked& x, const Unpacked& y) {
  const uint64_t bits = (x.significand >> 40) * (y.significand >> 40);  // 48 of them
  return normalized(x.negative != y.negative, x.exponent + y.exponent + 1, bits << 16);
}

/// FPAdd, and FPSub with the sign of the second operand turned.
uint32_t add(const Operand& x, const Operand& y, bool subtracts, Fpscr& fpscr) {
  uint32_t result = 0;
  if (process_nans({&x, &y}, result, fpscr)) return result;
  Unpacked second = y.number;
  second.negative = second.negative != subtracts;
  const Unpacked& first = x.number;
  const bool same_sign = first.negative == second.negative;
  if (first.is_infinite() && second.is_infinite() && !same_sign) return invalid(fpscr);
  if (first.is_infinite()) return sign_of(first.negative) | infinity;
  if (second.is_infinite()) return sign_of(second.negative) | infinity;
  if (first.is_zero() && second.is_zero())
    return sign_of(same_sign ? first.negative : fpscr.rounding() == Fpscr::Rounding::minus);
  return sum(first, second, fpscr);
}

Operand operand(uint32_t bits, Fpscr& fpscr) {
  return {bits, unpack(bits, fpscr)};
}

/// The largest number whose square is no more than `value`.
uint64_t integer_square_root(uint64_t value) {
  uint64_t root = 0;
  for (uint64_t bit = uint64_t{1} << 31; bit != 0; bit >>= 1)
    if ((root | bit) * (root | bit) <= value) root |= bit;
  return root;
}

}  // namespace

uint32_t add(uint32_t x, uint32_t y, Fpscr& fpscr) {
  const Operand first = operand(x, fpscr), second = operand(y, fpscr);
  return add(first, second, false, fpscr);
}

uint32_t subtract(uint32_t x, uint32_t y, Fpscr& fpscr) {
  const Operand first = operand(x, fpscr), second = operand(y, fpscr);
  return add(first, second, true, fpscr);
}

uint32_t multiply(uint32_t x, uint32_t y, Fpscr& fpscr) {
  const Operand first = operand(x, fpscr), second = operand(y, fpscr);
  uint32_t result = 0;
  if (process_nans({&first, &second}, result, fpscr)) return result;
  const Unpacked &a = first.number, &b = second.number;
  const uint32_t sign = sign_of(a.negative != b.negative);
  if ((a.is_infinite() && b.is_zero()) || (a.is_zero() && b.is_infinite())) return invalid(fpscr);
  if (a.is_infinite() || b.is_infinite()) return sign | infinity;
  if (a.is_zero() || b.is_zero()) return sign;
  return round(product(a, b), fpscr);
}

uint32_t divide(uint32_t x, uint32_t y, Fpscr& fpscr) {
  const Operand first = operand(x, fpscr), second = operand(y, fpscr);
  uint32_t result = 0;
  if (process_nans({&first, &second}, result, fpscr)) return result;
  const Unpacked &a = first.number, &b = second.number;
  const bool negative = a.negative != b.negative;
  if ((a.is_infinite() && b.is_infinite()) || (a.is_zero() && b.is_zero())) return invalid(fpscr);
  if (a.is_infinite() || b.is_zero()) {
    if (!a.is_infinite()) fpscr.raise(Fpscr::divide_by_zero);
    return sign_of(negative) | infinity;
  }
  if (a.is_zero() || b.is_infinite()) return sign_of(negative);
  const uint64_t dividend = a.significand >> 1, divisor = b.significand >> 40;
  const uint64_t quotient = dividend / divisor, rest = dividend % divisor;
  // 63 bits by 24: the quotient of two equal significands is 2^39.
  const uint64_t bits = quotient << 24 | (rest != 0 ? 1 : 0);
  return round(normalized(negative, a.exponent - b.exponent, bits), fpscr);
}

uint32_t square_root(uint32_t x, Fpscr& fpscr) {
  const Operand only = operand(x, fpscr);
  const Unpacked& number = only.number;
  if (number.is_nan()) return process_nan(number.kind, x, fpscr);
  if (number.is_zero()) return sign_of(number.negative);
  if (number.negative) return invalid(fpscr);
  if (number.is_infinite()) return infinity;
  // The square root of significand * 2^(exponent - 63), the power of two being even.
  const bool odd = (number.exponent & 1) != 0;
  const uint64_t radicand = odd ? number.significand : number.significand >> 1;
  const uint64_t root = integer_square_root(radicand);
  const int exponent = (number.exponent - (odd ? 1 : 0)) / 2;
  const uint64_t bits = root << 32 | (root * root != radicand ? 1 : 0);
  return round(normalized(false, exponent, bits), fpscr);
}

uint32_t multiply_add(uint32_t addend, uint32_t x, uint32_t y, Fpscr& fpscr) {
  const Operand third = operand(addend, fpscr), first = operand(x, fpscr),
                second = operand(y, fpscr);
  const Unpacked &a = first.number, &b = second.number, &c = third.number;
  const bool zero_by_infinity =
      (a.is_infinite() && b.is_zero()) || (a.is_zero() && b.is_infinite());
  uint32_t result = 0;
  const bool done = process_nans({&third, &first, &second}, result, fpscr);
  if (c.kind == Kind::quiet_nan && zero_by_infinity) return invalid(fpscr);
  if (done) return result;
  const bool negative = a.negative != b.negative;
  const bool infinite = a.is_infinite() || b.is_infinite(), zero = a.is_zero() || b.is_zero();
  if (zero_by_infinity || (c.is_infinite() && infinite && c.negative != negative))
    return invalid(fpscr);
  if (c.is_infinite()) return sign_of(c.negative) | infinity;
  if (infinite) return sign_of(negative) | infinity;
  if (c.is_zero() && zero)
    return sign_of(c.negative == negative ? negative : fpscr.rounding() == Fpscr::Rounding::minus);
  const Unpacked by = zero ? Unpacked{Kind::zero, negative, 0, 0} : product(a, b);
  return sum(c, by, fpscr);
}

uint32_t compare(uint32_t x, uint32_t y, bool signals, Fpscr& fpscr) {
  constexpr uint32_t less = 0x80000000, equal = 0x60000000, greater = 0x20000000,
                     unordered = 0x30000000;
  const Unpacked a = unpack(x, fpscr), b = unpack(y, fpscr);
  if (a.is_nan() || b.is_nan()) {
    const bool is_signaling = a.kind == Kind::signaling_nan || b.kind == Kind::signaling_nan;
    if (is_signaling || signals) fpscr.raise(Fpscr::invalid);
    return unordered;
  }
  // What was flushed counts as zero; the bits of others are in the order of their magnitudes.
  const auto ordered = [](uint32_t bits, const Unpacked& number) {
    const auto magnitude = static_cast<int64_t>(number.is_zero() ? 0 : absolute(bits));
    return number.negative ? -magnitude : magnitude;
  };
  const int64_t first = ordered(x, a), second = ordered(y, b);
  return first < second ? less : first == second ? equal : greater;
}

uint32_t to_fixed(uint32_t x, const Fixed& format, bool towards_zero, Fpscr& fpscr) {
  const Unpacked number = unpack(x, fpscr);
  const Fpscr::Rounding rounding = towards_zero ? Fpscr::Rounding::zero : fpscr.rounding();
  if (number.is_nan()) {
    fpscr.raise(Fpscr::invalid);
    return 0;
  }
  if (number.is_zero()) return 0;
  constexpr int beyond_any = 40;  // an exponent
  const int exponent =
      number.is_infinite() ? beyond_any : number.exponent + static_cast<int>(format.fraction_bits);
  const bool large = exponent >= beyond_any;
  Split parts =
      large ? Split{uint64_t{1} << beyond_any, 0} : split(number.significand, 63 - exponent);
  if (rounds_up(parts, number.negative, rounding)) ++parts.whole;
  const uint64_t limit = uint64_t{1} << (format.width - (format.is_unsigned ? 0 : 1));
  const uint64_t most = number.negative ? (format.is_unsigned ? 0 : limit) : limit - 1;
  uint64_t magnitude = parts.whole;
  if (magnitude > most) {
    magnitude = most;
    fpscr.raise(Fpscr::invalid);
  } else if (parts.rest != 0) {
    fpscr.raise(Fpscr::inexact);
  }
  return static_cast<uint32_t>(number.negative ? 0 - magnitude : magnitude);
}

uint32_t from_fixed(uint32_t bits, const Fixed& format, bool to_nearest, Fpscr& fpscr) {
  const uint32_t unused = 32 - format.width;
  const uint32_t high = bits << unused;
  const bool negative = !format.is_unsigned && (high & sign_bit) != 0;
  const uint64_t magnitude = (negative ? 0u - high : high) >> unused;
  const Unpacked number =
      normalized(negative, 63 - static_cast<int>(format.fraction_bits), magnitude);
  if (number.is_zero()) return 0;
  return round(number, to_nearest ? Fpscr::Rounding::nearest : fpscr.rounding(), fpscr);
}

uint32_t from_half(uint32_t half, Fpscr& fpscr) {
  const Unpacked number = unpack_half(half, fpscr);
  const uint32_t sign = sign_of(number.negative);
  if (number.is_nan())
    return process_nan(number.kind, sign | infinity | (half & 0x3FF) << 13, fpscr);
  if (number.is_infinite()) return sign | infinity;
  return number.is_zero() ? sign : round(number, fpscr);
}

uint32_t to_half(uint32_t x, Fpscr& fpscr) {
  constexpr uint32_t half_infinity = 0x7C00, half_default_nan = 0x7E00;
  const Unpacked number = unpack(x, fpscr);
  const bool alternative = fpscr.alternative_half();
  const uint32_t sign = number.negative ? 0x8000 : 0;
  if (number.is_nan()) {
    if (number.kind == Kind::signaling_nan || alternative) fpscr.raise(Fpscr::invalid);
    if (alternative) return sign;
    return fpscr.default_nan() ? half_default_nan : sign | half_default_nan | (x >> 13 & 0x1FF);
  }
  if (number.is_infinite()) {
    if (!alternative) return sign | half_infinity;
    fpscr.raise(Fpscr::invalid);
    return sign | 0x7FFF;
  }
  if (number.is_zero()) return sign;
  return sign | round_magnitude(number, half_format, fpscr.rounding(), fpscr);
}

}  // namespace capsoc::armv7m::single
