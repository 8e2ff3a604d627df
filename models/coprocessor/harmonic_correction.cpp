#include "coprocessor/harmonic_correction.h"

namespace capsoc::coprocessor {
namespace {

constexpr unsigned position_bits = 23, fraction_bits = 16;
constexpr unsigned angle_shift = 32 - position_bits;  // from 2^-32 turn to a position's unit
constexpr unsigned value_shift = 8;                   // from 2^-24 turn to 2^-32 turn

}  // namespace

int32_t correction_at(const CorrectionTable& table, uint32_t relative, uint32_t phi) {
  const uint32_t position =
      ((relative >> angle_shift) + (phi >> angle_shift)) & ((1u << position_bits) - 1);
  const uint32_t node = position >> fraction_bits;
  const int64_t fraction = position & ((1u << fraction_bits) - 1);
  const int64_t here = table[node], next = table[(node + 1) % correction_nodes];
  return static_cast<int32_t>((here * ((1 << fraction_bits) - fraction) + next * fraction) >>
                              fraction_bits);
}

uint32_t corrected_angle(const CorrectionTable& table, uint32_t relative, uint32_t phi) {
  return relative - (static_cast<uint32_t>(correction_at(table, relative, phi)) << value_shift);
}

}  // namespace capsoc::coprocessor
