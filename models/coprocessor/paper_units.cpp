#include "coprocessor/paper_units.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "base/constants.h"
#include "base/fixed.h"

namespace capsoc::coprocessor::paper {
namespace {

constexpr int iterations = 30;
constexpr unsigned table_bits = 9;
constexpr unsigned fraction_bits = 32 - table_bits;
constexpr uint32_t quarter_turn = uint32_t{1} << 30;

// Loop gains in 2^-32 turn per Q1.31 unit, Q31: round(gain / 2pi * 2 * 2^31).
constexpr int64_t proportional_gain = 0;
constexpr int64_t integral_gain = 1298774024;  // 1.9 rad

std::array<int32_t, 513> make_table() {
  std::array<int32_t, 513> table{};
  for (int i = 0; i <= 512; ++i)
    table[static_cast<size_t>(i)] =
        static_cast<int32_t>(std::floor(std::sin(two_pi * i / 512) * 2147483647.0 + 0.5));
  return table;
}

int32_t sine(uint32_t angle) {
  static const std::array<int32_t, 513> table = make_table();
  const uint32_t index = angle >> fraction_bits;
  const int64_t fraction = angle & ((uint32_t{1} << fraction_bits) - 1);
  const int64_t low = table[index];
  const int64_t rise = table[index + 1] - low;
  return static_cast<int32_t>(low + ((rise * fraction) >> fraction_bits));
}

}  // namespace

Table look_up(uint32_t angle) {
  return {sine(angle), sine(angle + quarter_turn)};
}

int32_t square_root(int32_t square) {
  int64_t y = 0;
  bool clamped = false;
  for (int i = 0; i < iterations; ++i)
    y = fixed::saturate<32>(((y * y) >> 31) - square + y, clamped);
  return fixed::saturate32(-y, clamped);
}

int32_t amplitude(int32_t a, int32_t b, bool& saturated) {
  // a^2 + b^2 reaches 2^63: one bit more than the signed word has.
  const uint64_t sum =
      static_cast<uint64_t>(int64_t{a} * a) + static_cast<uint64_t>(int64_t{b} * b);
  return square_root(fixed::saturate32(static_cast<int64_t>(sum >> 31), saturated));
}

uint32_t arctangent(int32_t y, int32_t x, int operand_bits) {
  const auto cut = static_cast<unsigned>(32 - operand_bits);
  const int64_t u = y >> cut;
  const int64_t v = x >> cut;
  uint32_t angle = 0;
  int64_t last_error = 0;
  for (int i = 0; i < iterations; ++i) {
    const Table reference = look_up(angle);
    const fixed::int128 difference =
        fixed::multiply(u, reference.cosine >> cut) - fixed::multiply(v, reference.sine >> cut);
    const auto error = static_cast<int64_t>(fixed::scale_up(difference, 2 * cut) >> 31);
    const fixed::int128 step = fixed::multiply(proportional_gain, error - last_error) +
                               fixed::multiply(integral_gain, error);
    angle += static_cast<uint32_t>(static_cast<int64_t>(step >> 31));
    last_error = error;
  }
  return angle;
}

Polar to_polar(int32_t y, int32_t x, int operand_bits, bool plain) {
  // s = 30 - m: the larger word gets 30 bits in addition to the sign, [0.25, 0.5).
  const int shift =
      plain ? 0
            : 30 - static_cast<int>(std::max(fixed::magnitude_bits(y), fixed::magnitude_bits(x)));
  const auto shifted = [&](int32_t word) {
    return static_cast<int32_t>(shift < 0 ? word >> 1 : fixed::scale_up(int64_t{word}, shift));
  };
  const int32_t y_shifted = shifted(y);
  const int32_t x_shifted = shifted(x);
  const bool fold = !plain && x_shifted < 0;
  const int32_t u = fold ? -y_shifted : y_shifted;
  const int32_t v = fold ? -x_shifted : x_shifted;
  const uint32_t angle = arctangent(u, v, operand_bits);

  const auto cut = static_cast<unsigned>(32 - operand_bits);
  const Table reference = look_up(angle);
  const auto sum = [&](int64_t a, int64_t b) {
    return static_cast<int64_t>(fixed::scale_up(fixed::int128{a} + b, 2 * cut) >> 31);
  };
  const int64_t y_cut = u >> cut;
  const int64_t x_cut = v >> cut;
  const int64_t sine = reference.sine >> cut;
  const int64_t cosine = reference.cosine >> cut;
  const int64_t error = sum(y_cut * cosine, -(x_cut * sine));
  const int64_t along = sum(y_cut * sine, x_cut * cosine);
  Polar result;
  result.angle = angle + (fold ? uint32_t{1} << 31 : 0);
  const int64_t magnitude = shift < 0 ? along * 2 : along >> shift;
  result.magnitude = static_cast<int32_t>(std::clamp<int64_t>(magnitude, 0, INT32_MAX));
  const bool zero = y == 0 && x == 0;
  result.settled = zero || std::abs(error) < along >> 10;
  return result;
}

}  // namespace capsoc::coprocessor::paper
