#include "coprocessor/reference_generator.h"

#include <cstddef>
#include <utility>

#include "base/fixed.h"
#include "coprocessor/cordic_rom.h"

namespace capsoc::coprocessor {
namespace {

using fixed::round_shift;
using fixed::saturate32;
using fixed::sign_extend;

struct Vector {
  int64_t x, y, z;
};

// One micro-rotation. The sign mask (0 or -1) replaces a branch that would be taken at random.
template <unsigned stage>
inline void micro_rotate(Vector& v) {
  const int64_t m = v.z >> 63;
  const int64_t dx = round_shift(v.y, stage);
  const int64_t dy = round_shift(v.x, stage);
  v.x -= (dx ^ m) - m;
  v.y += (dy ^ m) - m;
  v.z -= (cordic_rom::angle_37[stage] ^ m) - m;
}

template <unsigned stage>
inline void micro_rotate_paper(Vector& v) {
  const int64_t m = v.z >> 63;
  const int64_t dx = v.y >> stage;
  const int64_t dy = v.x >> stage;
  v.x -= (dx ^ m) - m;
  v.y += (dy ^ m) - m;
  v.z -= (cordic_rom::angle_32[stage] ^ m) - m;
}

template <std::size_t... stages>
inline void run(Vector& v, std::index_sequence<stages...>) {
  (micro_rotate<stages>(v), ...);
}

template <std::size_t... stages>
inline void run_paper(Vector& v, std::index_sequence<stages...>) {
  (micro_rotate_paper<stages>(v), ...);
}

// A CORDIC reaches +-99 degrees: the left half plane is entered by half a turn and a negated start
// vector. Outside [-quarter, quarter) the two upper bits of the angle differ.
template <unsigned bits>
inline Vector fold(uint64_t angle, int64_t gain) {
  const uint64_t outside = ((angle >> (bits - 1)) ^ (angle >> (bits - 2))) & 1;
  const int64_t z = sign_extend<bits>(angle ^ (outside << (bits - 1)));
  return {outside ? -gain : gain, 0, z};
}

}  // namespace

Rotation rotate(uint64_t phase) {
  const uint64_t angle = round_shift(phase & phase_mask, 11) & ((uint64_t{1} << 37) - 1);
  Vector v = fold<37>(angle, cordic_rom::rotation_start);
  run(v, std::make_index_sequence<30>{});
  // The largest result is 2^31 - 1 plus a few units of the CORDIC's own error: the clamp is part of
  // the format, not an event worth a flag.
  bool at_full_scale = false;
  return {saturate32(round_shift(v.y, 5), at_full_scale),
          saturate32(round_shift(v.x, 5), at_full_scale)};
}

Rotation rotate_paper(uint64_t phase) {
  Vector v = fold<32>((phase & phase_mask) >> 16, cordic_rom::rotation_start_paper);
  run_paper(v, std::make_index_sequence<28>{});
  bool at_full_scale = false;
  return {saturate32(v.y, at_full_scale), saturate32(v.x, at_full_scale)};
}

uint32_t upper_phase(uint64_t phase) {
  return static_cast<uint32_t>(round_shift(phase & phase_mask, 16));
}

bool completes_turn(const ReferenceState& state) {
  const int64_t next = static_cast<int64_t>(state.phase) + state.frequency;
  return next < 0 || next > static_cast<int64_t>(phase_mask);
}

ReferenceState next_reference(const ReferenceState& state, ReferenceSource source, int32_t residue,
                              unsigned kp, unsigned ki, bool& saturated) {
  int64_t steer_phase = 0;
  int64_t steer_frequency = 0;
  if (source == ReferenceSource::tracking) {
    const int64_t wide = fixed::scale_up(int64_t{residue}, 16);
    steer_phase = round_shift(wide, kp);
    steer_frequency = round_shift(wide, ki);
  }
  ReferenceState next;
  // The step of this sample uses the old frequency: both adders work side by side.
  next.phase = (state.phase + static_cast<uint64_t>(state.frequency + steer_phase)) & phase_mask;
  next.frequency = fixed::saturate<48>(state.frequency + steer_frequency, saturated);
  return next;
}

}  // namespace capsoc::coprocessor
