#include "coprocessor/polar_unit.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "coprocessor/cordic_rom.h"

namespace capsoc::coprocessor {
namespace {

using fixed::int128;
using fixed::round_shift;

// The larger component is brought to 35 bits in addition to the sign: the CORDIC's gain of 1.65
// times sqrt(2) then stays below 2^37.
constexpr int normal_bits = 35;

struct Vector {
  int64_t x, y, z;
};

// Turns the vector towards the positive x axis and collects the angle it took.
template <unsigned stage>
inline void micro_rotate(Vector& v) {
  const int64_t m = v.y >> 63;
  const int64_t dx = round_shift(v.y, stage);
  const int64_t dy = round_shift(v.x, stage);
  v.x += (dx ^ m) - m;
  v.y -= (dy ^ m) - m;
  v.z += (cordic_rom::angle_37[stage] ^ m) - m;
}

template <std::size_t... stages>
inline void run(Vector& v, std::index_sequence<stages...>) {
  (micro_rotate<stages>(v), ...);
}

inline int64_t normalise(int128 value, int shift) {
  return static_cast<int64_t>(shift >= 0 ? fixed::scale_up(value, static_cast<unsigned>(shift))
                                         : round_shift(value, static_cast<unsigned>(-shift)));
}

}  // namespace

Polar to_polar(int128 y, int128 x, unsigned fraction_bits) {
  Polar result;
  result.zero = x == 0 && y == 0;
  if (result.zero) return result;
  const auto bits = std::max(fixed::magnitude_bits(y), fixed::magnitude_bits(x));
  const int shift = normal_bits - static_cast<int>(bits);
  Vector v{normalise(x, shift), normalise(y, shift), 0};
  if (v.x < 0) v = {-v.x, -v.y, int64_t{1} << 36};
  run(v, std::make_index_sequence<30>{});

  result.angle = static_cast<uint32_t>(round_shift(v.z, 5));
  const auto scale = static_cast<unsigned>(32 + shift + static_cast<int>(fraction_bits) - 31);
  const int128 magnitude =
      round_shift(fixed::multiply(v.x, cordic_rom::vectoring_gain), std::min(scale, 100u));
  result.magnitude = fixed::saturate32(magnitude, result.saturated);
  return result;
}

}  // namespace capsoc::coprocessor
