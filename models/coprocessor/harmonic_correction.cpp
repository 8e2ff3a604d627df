#include "coprocessor/harmonic_correction.h"

namespace capsoc::coprocessor {
namespace {

constexpr unsigned position_bits = 23, fraction_bits = 16;
constexpr unsigned angle_shift = 32 - position_bits;  // from 2^-32 turn to a position's unit
constexpr unsigned value_shift = 8;                   // from 2^-24 turn to 2^-32 turn

struct Place {
  uint32_t node, next;
  uint32_t fraction;  // of the way from one to the other, 2^-16
};

Place place_of(uint32_t relative, uint32_t phi) {
  const uint32_t position =
      ((relative >> angle_shift) + (phi >> angle_shift)) & ((1u << position_bits) - 1);
  const uint32_t node = position >> fraction_bits;
  return {node, (node + 1) % correction_nodes, position & ((1u << fraction_bits) - 1)};
}

bool has(const NodeBits& bits, uint32_t node) {
  return (bits[node / 64] >> node % 64 & 1) != 0;
}

}  // namespace

bool reads_one(const NodeBits& of, uint32_t relative, uint32_t phi) {
  const Place place = place_of(relative, phi);
  return has(of, place.node) || (place.fraction != 0 && has(of, place.next));
}

int32_t correction_at(const CorrectionTable& table, uint32_t relative, uint32_t phi) {
  const Place place = place_of(relative, phi);
  const int64_t fraction = place.fraction, here = table[place.node], next = table[place.next];
  return static_cast<int32_t>((here * ((1 << fraction_bits) - fraction) + next * fraction) >>
                              fraction_bits);
}

uint32_t corrected_angle(const CorrectionTable& table, uint32_t relative, uint32_t phi) {
  return relative - (static_cast<uint32_t>(correction_at(table, relative, phi)) << value_shift);
}

}  // namespace capsoc::coprocessor
