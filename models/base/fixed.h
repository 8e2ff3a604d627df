// Fixed-point helpers of the datapath models: the operations that a hardware designer has, on plain
// integers. A Q-format is a comment at the place of use, never a type: the formats of the
// coprocessor differ at nearly every node, and the product of two formats is a third.
#pragma once

#include <cstdint>
#include <type_traits>

namespace capsoc::fixed {

// The compiler's 128-bit integers: wide enough for every product in the datapath (68 + 32 bits).
__extension__ typedef __int128 int128;
__extension__ typedef unsigned __int128 uint128;

// value / 2^shift, rounded to nearest, ties towards +infinity ("half up"). shift 0 is the identity.
// The sum with the half must fit T; the callers' formats leave that bit.
template <typename T>
constexpr T round_shift(T value, unsigned shift) {
  return (value + ((T{1} << shift) >> 1)) >> shift;
}

// value * 2^shift for signed values (a left shift of a negative value is undefined before C++20).
template <typename T>
constexpr T scale_up(T value, unsigned shift) {
  return value * (T{1} << shift);
}

// Largest and smallest value of a signed word of `bits` bits.
template <unsigned bits>
constexpr int64_t max_signed = static_cast<int64_t>((uint64_t{1} << (bits - 1)) - 1);
template <unsigned bits>
constexpr int64_t min_signed = -max_signed<bits> - 1;

// Clamps to a signed word of `bits` bits; sets `saturated` when it had to, and never clears it.
template <unsigned bits, typename T>
constexpr int64_t saturate(T value, bool& saturated) {
  if (value > static_cast<T>(max_signed<bits>)) {
    saturated = true;
    return max_signed<bits>;
  }
  if (value < static_cast<T>(min_signed<bits>)) {
    saturated = true;
    return min_signed<bits>;
  }
  return static_cast<int64_t>(value);
}

// As saturate<32>, typed.
template <typename T>
constexpr int32_t saturate32(T value, bool& saturated) {
  return static_cast<int32_t>(saturate<32>(value, saturated));
}

// The low `bits` bits, read as two's complement.
template <unsigned bits>
constexpr int64_t sign_extend(uint64_t value) {
  return static_cast<int64_t>(value << (64 - bits)) >> (64 - bits);
}

// Leading zeros of a 64-bit word; 64 for zero.
constexpr unsigned leading_zeros(uint64_t value) {
  return value == 0 ? 64u : static_cast<unsigned>(__builtin_clzll(value));
}

// Bits that the magnitude of a two's complement number needs (without its sign). Negative numbers
// count as their one's complement, which costs hardware no carry chain: -2^n needs n bits.
constexpr unsigned magnitude_bits(int128 value) {
  const uint128 magnitude = static_cast<uint128>(value < 0 ? ~value : value);
  const auto high = static_cast<uint64_t>(magnitude >> 64);
  const auto low = static_cast<uint64_t>(magnitude);
  return high != 0 ? 128 - leading_zeros(high) : 64 - leading_zeros(low);
}

// Product of two signed 64-bit words, exact.
constexpr int128 multiply(int64_t a, int64_t b) {
  return static_cast<int128>(a) * b;
}

// A number in [-1, 1) as a Q1.31 word, rounded half up and saturated, as an ideal converter would.
// The word stands for word / 2^31 (the SoC paper divides by 2^31 - 1: 4.7e-10 relative).
inline int32_t to_q31(double value) {
  const double scaled = value * 2147483648.0;
  if (!(scaled < 2147483647.0)) return scaled >= 2147483647.0 ? INT32_MAX : 0;
  if (scaled <= -2147483648.0) return INT32_MIN;
  const double shifted = scaled + 0.5;
  const auto truncated = static_cast<int64_t>(shifted);
  return static_cast<int32_t>(truncated - (static_cast<double>(truncated) > shifted ? 1 : 0));
}

constexpr double from_q31(int64_t word) {
  return static_cast<double>(word) / 2147483648.0;
}

}  // namespace capsoc::fixed
