// Words of a stimulus that find faults.
#pragma once

#include <cstdint>

#include "base/random.h"

namespace capsoc::regress {

/// A word as faults like it: now and then the ends of the range and their neighbours, a power of
/// two or all ones below one, a random number of any magnitude and sign.
inline uint32_t corner32(Random& random) {
  switch (random.below(8)) {
    case 0:
      return 0u - static_cast<uint32_t>(random.below(3)) + 1u;  // 1, 0, -1
    case 1:
      return 0x7FFFFFFFu +
             static_cast<uint32_t>(random.below(3));  // most positive, most negative, + 1
    case 2:
      return 1u << random.below(32);
    case 3:
      return ~(1u << random.below(32));
    case 4:
      return (1u << random.below(32)) - 1u;
    case 5:
      return static_cast<uint32_t>(static_cast<int32_t>(random.word32()) >> random.below(32));
    default:
      return random.word32();
  }
}

}  // namespace capsoc::regress
