// How the SoC paper turns machine values into values (below its Table 8).
#pragma once

#include <array>
#include <cstddef>

#include "base/constants.h"

namespace capsoc::reproduce {

inline constexpr std::array<const char*, 6> parameter_names = {"a1", "a2",   "b1",
                                                               "b2", "beta", "phi"};

/// Amplitudes and offsets (the first four) divided by 2^31 - 1, angles in radians.
inline double value_of_word(std::size_t parameter, double word) {
  return parameter < 4 ? word / 2147483647.0 : word * 2 * pi / 4294967295.0;
}

}  // namespace capsoc::reproduce
