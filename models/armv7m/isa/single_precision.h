// The arithmetic of the floating-point extension FPv4-SP (ARM DDI 0403, A2.5.4 to A2.5.9), in
// integers: the results and flags are those of the manual on every host, whatever its rounding.
#pragma once

#include <cstdint>

namespace capsoc::armv7m {

/// The floating-point status and control register (ARM DDI 0403, A2.5.3).
class Fpscr {
 public:
  static constexpr uint32_t invalid = 1u << 0, divide_by_zero = 1u << 1, overflow = 1u << 2,
                            underflow = 1u << 3, inexact = 1u << 4, input_denormal = 1u << 7;
  static constexpr uint32_t exceptions =
      invalid | divide_by_zero | overflow | underflow | inexact | input_denormal;
  static constexpr uint32_t nzcv = 0xF0000000;
  /// AHP, DN, FZ and RMode: the part that FPDSCR has, too.
  static constexpr uint32_t control = 0x07C00000;
  /// RMode and FZ: where they are zero, results are rounded to nearest and nothing is flushed.
  static constexpr uint32_t modes = 0x01C00000;
  static constexpr uint32_t implemented = nzcv | control | exceptions;

  enum class Rounding : uint8_t { nearest, plus, minus, zero };

  constexpr Fpscr() = default;
  constexpr explicit Fpscr(uint32_t value) : bits_(value & implemented) {}

  constexpr uint32_t bits() const { return bits_; }
  constexpr Rounding rounding() const { return static_cast<Rounding>(bits_ >> 22 & 3); }
  constexpr bool flushes() const { return (bits_ & 1u << 24) != 0; }
  constexpr bool default_nan() const { return (bits_ & 1u << 25) != 0; }
  constexpr bool alternative_half() const { return (bits_ & 1u << 26) != 0; }
  /// FPProcessException: no exception of the extension traps, each sets its cumulative flag.
  constexpr void raise(uint32_t exception) { bits_ |= exception; }
  /// `flags` are at their places, bits 31 to 28.
  constexpr void set_nzcv(uint32_t flags) { bits_ = (bits_ & ~nzcv) | (flags & nzcv); }
  constexpr void set_control(uint32_t value) { bits_ = (bits_ & ~control) | (value & control); }

 private:
  uint32_t bits_ = 0;
};

/// The manual's functions, with its names. Numbers are the bits of a single-precision number.
namespace single {
constexpr uint32_t sign_bit = 0x80000000;

constexpr uint32_t negate(uint32_t x) {
  return x ^ sign_bit;
}
constexpr uint32_t absolute(uint32_t x) {
  return x & ~sign_bit;
}
uint32_t add(uint32_t x, uint32_t y, Fpscr& fpscr);
uint32_t subtract(uint32_t x, uint32_t y, Fpscr& fpscr);
uint32_t multiply(uint32_t x, uint32_t y, Fpscr& fpscr);
uint32_t divide(uint32_t x, uint32_t y, Fpscr& fpscr);
uint32_t square_root(uint32_t x, Fpscr& fpscr);
/// addend + x * y, rounded once (FPMulAdd).
uint32_t multiply_add(uint32_t addend, uint32_t x, uint32_t y, Fpscr& fpscr);
/// N, Z, C and V at their places in FPSCR. `signals`: a quiet NaN is invalid, too (VCMPE).
uint32_t compare(uint32_t x, uint32_t y, bool signals, Fpscr& fpscr);

/// A fixed-point number in a register.
struct Fixed {
  unsigned width = 32;         ///< 16 or 32 bits
  unsigned fraction_bits = 0;  ///< no more than the width
  bool is_unsigned = false;
};
/// FPToFixed: the number in the low bits, zero- or sign-extended from its width.
uint32_t to_fixed(uint32_t x, const Fixed& format, bool towards_zero, Fpscr& fpscr);
/// FixedToFP of the low bits. `to_nearest`: whatever FPSCR says.
uint32_t from_fixed(uint32_t bits, const Fixed& format, bool to_nearest, Fpscr& fpscr);

/// FPHalfToSingle and FPSingleToHalf; a half-precision number is in the low 16 bits.
uint32_t from_half(uint32_t half, Fpscr& fpscr);
uint32_t to_half(uint32_t x, Fpscr& fpscr);

/// VFPExpandImm (A6.4.1) of eight bits.
constexpr uint32_t expand_immediate(uint32_t bits) {
  const uint32_t exponent = (bits & 0x40) != 0 ? 0x3E000000 : 0x40000000;
  return (bits & 0x80) << 24 | exponent | (bits & 0x3F) << 19;
}
}  // namespace single

}  // namespace capsoc::armv7m
