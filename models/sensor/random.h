#pragma once

#include <cstdint>

namespace capsoc::sensor {

/// Random numbers by index: the SplitMix64 sequence (Steele, Lea and Flood 2014), whose n-th output
/// can be computed without the ones before. Our own rather than <random>'s distributions, because
/// the bytes of those depend on the standard library.
class RandomSequence {
 public:
  /// Sequences with the same seed and different streams are independent of each other.
  RandomSequence(uint64_t seed, uint64_t stream);

  uint64_t word(uint64_t index) const;

  /// In [0, 1), a multiple of 2^-53.
  double uniform(uint64_t index) const;

  /// Mean 0, variance 1 (Box-Muller), from words 2 index and 2 index + 1. |value| < 8.6.
  double gaussian(uint64_t index) const;

  /// Largest |gaussian(i)| for i < count, 0 for count 0; takes about 30 ns for each.
  double gaussian_peak(uint64_t count) const;

 private:
  uint64_t start_;
};

}  // namespace capsoc::sensor
