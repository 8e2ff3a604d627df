// Seeded random numbers: our own rather than <random>'s distributions, whose bytes depend on the
// standard library. Both classes give the SplitMix64 sequence (Steele, Lea and Flood 2014).
#pragma once

#include <cstdint>

#include "base/splitmix64.h"

namespace capsoc {

/// Random numbers one after the other.
class Random {
 public:
  explicit Random(uint64_t seed) : state_(seed) {}
  /// Sequences of the same seed and different streams have nothing in common.
  Random(uint64_t seed, uint64_t stream) : state_(splitmix64(seed ^ splitmix64(~stream))) {}

  uint64_t word() { return splitmix64(state_ += splitmix64_increment); }
  uint32_t word32() { return static_cast<uint32_t>(word() >> 32); }
  /// In [0, 1), a multiple of 2^-53.
  double uniform() { return unit_interval(word()); }
  bool chance(double probability) { return uniform() < probability; }
  /// 0 .. count - 1, the remainder of a word; count > 0.
  uint64_t below(uint64_t count) { return word() % count; }
  /// first .. last, both inclusive.
  uint64_t between(uint64_t first, uint64_t last) { return first + below(last - first + 1); }
  /// 0 .. bound - 1, a scaled uniform(); the bias of the multiplication is bound 2^-53.
  int64_t index(int64_t bound) {
    return static_cast<int64_t>(uniform() * static_cast<double>(bound));
  }

 private:
  uint64_t state_;
};

/// Random numbers by index: the n-th can be computed without the ones before.
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

}  // namespace capsoc
