// Words that are likely to matter: small numbers, corners, single bits, anything.
#pragma once

#include <cstdint>
#include <random>

namespace capsoc::coprocessor {

inline uint32_t likely_word(std::mt19937_64& random) {
  switch (random() % 6) {
    case 0:
      return 0;
    case 1:
      return 0xFFFFFFFF >> random() % 32;
    case 2:
      return 0x80000000u + static_cast<uint32_t>(random() % 3) - 1;
    case 3:
      return uint32_t{1} << random() % 32;
    default:
      return static_cast<uint32_t>(random());
  }
}

}  // namespace capsoc::coprocessor
