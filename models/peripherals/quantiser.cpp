#include "peripherals/quantiser.h"

#include <algorithm>
#include <cmath>

namespace capsoc::peripherals {

Quantised quantise(double x, unsigned bits) {
  if (std::isnan(x)) return {0, true};
  const int width = static_cast<int>(std::clamp(bits, minimum_bits, maximum_bits));
  const double scaled = std::ldexp(x, width - 1);
  // floor(scaled + 0.5) would round twice: the sum of a double just below one half and 0.5 is 1.
  const double below = std::floor(scaled);
  const double rounded = scaled - below >= 0.5 ? below + 1.0 : below;
  const double limit = std::ldexp(1.0, width - 1);
  const double kept = std::clamp(rounded, -limit, limit - 1.0);
  const int64_t left_justified = static_cast<int64_t>(kept) * (int64_t{1} << (32 - width));
  return {static_cast<int32_t>(left_justified), kept != rounded};
}

}  // namespace capsoc::peripherals
