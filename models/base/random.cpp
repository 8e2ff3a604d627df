#include "base/random.h"

#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "base/splitmix64.h"

namespace capsoc {

// The stream number passes through the mixer before it meets the seed: neighbouring seeds and
// streams must not land on overlapping stretches of the one SplitMix64 sequence.
RandomSequence::RandomSequence(uint64_t seed, uint64_t stream)
    : start_(splitmix64(seed + splitmix64_increment) ^
             splitmix64((stream + 1) * splitmix64_increment ^ 0x5851F42D4C957F2Dull)) {}

uint64_t RandomSequence::word(uint64_t index) const {
  return splitmix64(start_ + (index + 1) * splitmix64_increment);
}

double RandomSequence::uniform(uint64_t index) const {
  return unit_interval(word(index));
}

double RandomSequence::gaussian(uint64_t index) const {
  // In (0, 1]: the logarithm of 0 never arises.
  const double radius = static_cast<double>((word(2 * index) >> 11) + 1) * 0x1p-53;
  const double turn = uniform(2 * index + 1);
  return std::sqrt(-2.0 * std::log(radius)) * std::cos(two_pi * turn);
}

double RandomSequence::gaussian_peak(uint64_t count) const {
  double peak = 0.0;
  for (uint64_t i = 0; i < count; ++i) peak = std::max(peak, std::abs(gaussian(i)));
  return peak;
}

}  // namespace capsoc
