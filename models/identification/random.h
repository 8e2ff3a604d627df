// The generator that orders the training samples.
#pragma once

#include <cstdint>

#include "support/splitmix64.h"

namespace capsoc::identification {

/// The SplitMix64 sequence from a seed.
class Random {
 public:
  explicit Random(uint64_t seed) : state_(seed) {}

  uint64_t word() {
    state_ += splitmix64_increment;
    return splitmix64(state_);
  }

  /// In [0, 1), a multiple of 2^-53.
  double uniform() { return unit_interval(word()); }

  /// In 0 .. bound - 1; the bias of the multiplication is bound 2^-53, far below what training
  /// sees.
  int64_t below(int64_t bound) {
    return static_cast<int64_t>(uniform() * static_cast<double>(bound));
  }

 private:
  uint64_t state_;
};

}  // namespace capsoc::identification
