// The rotation CORDIC of the precise arithmetic never overshoots full scale, so the clamps of sine
// and cosine never act: a mutant that lacks them is no fault. By exhaustion.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "coprocessor/cordic_rom.h"

namespace capsoc::regress {
namespace {

constexpr int64_t full_scale = (int64_t{1} << 31) - 1;

int64_t rounded(int64_t value, int shift) {
  return shift == 0 ? value : (value + (int64_t{1} << (shift - 1))) >> shift;
}

// docs/reference/coprocessor.md, "Rotation CORDIC", of z folded to a quarter turn on each side,
// without the clamp: the larger of |sine| and |cosine|.
int64_t larger_component(int64_t z, bool folded) {
  namespace rom = coprocessor::cordic_rom;
  int64_t x = folded ? -rom::rotation_start : rom::rotation_start, y = 0;
  for (int i = 0; i < 30; ++i) {
    const int64_t d = z >= 0 ? 1 : -1;
    const int64_t next_x = x - d * rounded(y, i);
    y += d * rounded(x, i);
    x = next_x;
    z -= d * rom::angle_37[static_cast<size_t>(i)];
  }
  return std::max(std::llabs(rounded(x, 5)), std::llabs(rounded(y, 5)));
}

// 2^-16 turn away from an axis the larger component is 9.8 units below full scale, which is more
// than the CORDIC's largest error (4.95 units): only the neighbourhood of the axes is to be tried.
TEST(RotationCordic, NeverOvershootsFullScale) {
  constexpr int64_t quarter = int64_t{1} << 35, around = int64_t{1} << 21;
  for (bool folded : {false, true})
    for (int64_t axis : {-quarter, int64_t{0}, quarter})
      for (int64_t z = axis - around; z <= axis + around; ++z)
        if (larger_component(z, folded) > full_scale) FAIL() << "z = " << z;
}

}  // namespace
}  // namespace capsoc::regress
