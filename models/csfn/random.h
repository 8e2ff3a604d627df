// The generator that orders the training samples.
#pragma once

#include <cstdint>

namespace capsoc::csfn {

/// SplitMix64 (Steele, Lea and Flood 2014): our own, so that a seed means the same run with every
/// standard library.
class Random {
 public:
  explicit Random(uint64_t seed) : state_(seed) {}

  uint64_t word() {
    state_ += 0x9E3779B97F4A7C15u;
    uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
  }

  /// In [0, 1), a multiple of 2^-53.
  double uniform() { return static_cast<double>(word() >> 11) * 0x1p-53; }

  /// In 0 .. bound - 1; the bias of the multiplication is bound 2^-53, far below what training
  /// sees.
  int64_t below(int64_t bound) {
    return static_cast<int64_t>(uniform() * static_cast<double>(bound));
  }

 private:
  uint64_t state_;
};

}  // namespace capsoc::csfn
