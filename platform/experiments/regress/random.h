// Random words for a stimulus, one after the other from a seed.
#pragma once

#include <cstdint>

#include "support/splitmix64.h"

namespace capsoc::regress {

class Random {
 public:
  /// Sequences of the same seed and different streams have nothing in common.
  Random(uint64_t seed, uint64_t stream) : state_(splitmix64(seed ^ splitmix64(~stream))) {}

  uint64_t word() { return splitmix64(state_ += splitmix64_increment); }
  uint32_t word32() { return static_cast<uint32_t>(word() >> 32); }
  /// 0 .. count - 1; count > 0.
  uint64_t below(uint64_t count) { return word() % count; }
  /// first .. last, both inclusive.
  uint64_t between(uint64_t first, uint64_t last) { return first + below(last - first + 1); }
  /// In [0, 1).
  double uniform() { return unit_interval(word()); }
  bool chance(double probability) { return uniform() < probability; }

  /// A word as faults like it: now and then the ends of the range and their neighbours, a power of
  /// two or all ones below one, a random number of any magnitude and sign.
  uint32_t corner32() {
    switch (below(8)) {
      case 0:
        return 0u - static_cast<uint32_t>(below(3)) + 1u;  // 1, 0, -1
      case 1:
        return 0x7FFFFFFFu + static_cast<uint32_t>(below(3));  // most positive, most negative, + 1
      case 2:
        return 1u << below(32);
      case 3:
        return ~(1u << below(32));
      case 4:
        return (1u << below(32)) - 1u;
      case 5:
        return static_cast<uint32_t>(static_cast<int32_t>(word32()) >> below(32));
      default:
        return word32();
    }
  }

 private:
  uint64_t state_;
};

}  // namespace capsoc::regress
