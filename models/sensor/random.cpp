#include "sensor/random.h"

#include <algorithm>
#include <cmath>

namespace capsoc::sensor {
namespace {

constexpr uint64_t golden_gamma = 0x9E3779B97F4A7C15ull;
constexpr double two_pi = 6.283185307179586476925;
constexpr double unit_53 = 0x1p-53;

uint64_t mix(uint64_t z) {
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
  return z ^ (z >> 31);
}

}  // namespace

// The stream number passes through the mixer before it meets the seed: neighbouring seeds and
// streams must not land on overlapping stretches of the one SplitMix64 sequence.
RandomSequence::RandomSequence(uint64_t seed, uint64_t stream)
    : start_(mix(seed + golden_gamma) ^ mix((stream + 1) * golden_gamma ^ 0x5851F42D4C957F2Dull)) {}

uint64_t RandomSequence::word(uint64_t index) const {
  return mix(start_ + (index + 1) * golden_gamma);
}

double RandomSequence::uniform(uint64_t index) const {
  return static_cast<double>(word(index) >> 11) * unit_53;
}

double RandomSequence::gaussian(uint64_t index) const {
  // In (0, 1]: the logarithm of 0 never arises.
  const double radius = static_cast<double>((word(2 * index) >> 11) + 1) * unit_53;
  const double turn = uniform(2 * index + 1);
  return std::sqrt(-2.0 * std::log(radius)) * std::cos(two_pi * turn);
}

double RandomSequence::gaussian_peak(uint64_t count) const {
  double peak = 0.0;
  for (uint64_t i = 0; i < count; ++i) peak = std::max(peak, std::abs(gaussian(i)));
  return peak;
}

}  // namespace capsoc::sensor
