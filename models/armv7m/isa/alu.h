#pragma once

#include <cstdint>

#include "armv7m/isa/op.h"

/// The manual's pseudocode functions (ARM DDI 0403, A2.2 and A5.3), under its names.
namespace capsoc::armv7m {

struct AddResult {
  uint32_t value;
  bool carry, overflow;
};

constexpr AddResult add_with_carry(uint32_t x, uint32_t y, bool carry_in) {
  uint64_t sum = static_cast<uint64_t>(x) + y + (carry_in ? 1 : 0);
  uint32_t value = static_cast<uint32_t>(sum);
  return {value, (sum >> 32) != 0, (((x ^ value) & (y ^ value)) >> 31) != 0};
}

struct ShiftResult {
  uint32_t value;
  bool carry;
};

/// Shift_C for every amount 0..255; an amount of zero keeps the carry.
constexpr ShiftResult shift_c(uint32_t x, ShiftType type, unsigned amount, bool carry_in) {
  if (type == ShiftType::rrx) return {(x >> 1) | (carry_in ? 0x80000000u : 0u), (x & 1) != 0};
  if (amount == 0) return {x, carry_in};
  switch (type) {
    case ShiftType::lsl:
      if (amount > 32) return {0, false};
      return {amount == 32 ? 0 : x << amount, ((x >> (32 - amount)) & 1) != 0};
    case ShiftType::lsr:
      if (amount > 32) return {0, false};
      return {amount == 32 ? 0 : x >> amount, ((x >> (amount - 1)) & 1) != 0};
    case ShiftType::asr: {
      if (amount >= 32) return {(x >> 31) ? 0xFFFFFFFFu : 0u, (x >> 31) != 0};
      uint32_t sign = (x >> 31) ? ~(0xFFFFFFFFu >> amount) : 0;
      return {(x >> amount) | sign, ((x >> (amount - 1)) & 1) != 0};
    }
    default: {
      unsigned n = amount & 31;
      uint32_t value = n == 0 ? x : (x >> n) | (x << (32 - n));
      return {value, (value >> 31) != 0};
    }
  }
}

constexpr uint32_t rotate_right(uint32_t x, unsigned n) {
  return (n & 31) == 0 ? x : (x >> (n & 31)) | (x << (32 - (n & 31)));
}

struct ImmediateResult {
  uint32_t value;
  bool rotated;  // then the carry becomes bit 31 of the value
};

/// ThumbExpandImm_C. The UNPREDICTABLE zero byte of the replicating forms expands to zero.
constexpr ImmediateResult thumb_expand_imm_c(uint32_t imm12) {
  uint32_t byte = imm12 & 0xFF;
  switch (imm12 >> 8) {
    case 0:
      return {byte, false};
    case 1:
      return {byte << 16 | byte, false};
    case 2:
      return {byte << 24 | byte << 8, false};
    case 3:
      return {byte << 24 | byte << 16 | byte << 8 | byte, false};
    default:
      return {rotate_right(0x80 | (imm12 & 0x7F), imm12 >> 7), true};
  }
}

/// DecodeImmShift.
constexpr Shift decode_imm_shift(unsigned type, unsigned imm5) {
  if (type == 0) return {ShiftType::lsl, static_cast<uint8_t>(imm5)};
  if (type == 3) {
    return imm5 == 0 ? Shift{ShiftType::rrx, 1} : Shift{ShiftType::ror, static_cast<uint8_t>(imm5)};
  }
  return {type == 1 ? ShiftType::lsr : ShiftType::asr, static_cast<uint8_t>(imm5 == 0 ? 32 : imm5)};
}

constexpr uint32_t sign_extend(uint32_t x, unsigned bits) {
  uint32_t sign = 1u << (bits - 1);
  x &= sign | (sign - 1);
  return (x ^ sign) - sign;
}

struct SaturationResult {
  uint32_t value;
  bool saturated;
};

/// SignedSatQ to `bits` 1..32, UnsignedSatQ to `bits` 0..31, of a signed word.
constexpr SaturationResult signed_sat_q(int32_t x, unsigned bits) {
  int64_t high = (int64_t{1} << (bits - 1)) - 1, low = -(int64_t{1} << (bits - 1));
  int64_t value = x > high ? high : x < low ? low : x;
  return {static_cast<uint32_t>(value), value != x};
}
constexpr SaturationResult unsigned_sat_q(int32_t x, unsigned bits) {
  int64_t high = (int64_t{1} << bits) - 1;
  int64_t value = x > high ? high : x < 0 ? 0 : x;
  return {static_cast<uint32_t>(value), value != x};
}

}  // namespace capsoc::armv7m
