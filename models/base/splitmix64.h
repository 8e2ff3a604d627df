// The bit mixer of every seeded sequence of capsoc.
#pragma once

#include <cstdint>

namespace capsoc {

/// What SplitMix64 (Steele, Lea and Flood 2014) adds to its state for each output.
constexpr uint64_t splitmix64_increment = 0x9E3779B97F4A7C15u;

/// The output for a state. Our own rather than <random>'s, whose distributions give other bytes
/// with another standard library.
constexpr uint64_t splitmix64(uint64_t state) {
  state = (state ^ (state >> 30)) * 0xBF58476D1CE4E5B9u;
  state = (state ^ (state >> 27)) * 0x94D049BB133111EBu;
  return state ^ (state >> 31);
}

/// A word as a number in [0, 1), a multiple of 2^-53.
constexpr double unit_interval(uint64_t word) {
  return static_cast<double>(word >> 11) * 0x1p-53;
}

}  // namespace capsoc
