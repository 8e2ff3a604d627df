// An iteration of a polling loop whose outcome is known without execution.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "armv7m/state.h"

namespace capsoc::armv7m {

class Machine;

/// Cost of one iteration of a loop.
struct Turn {
  uint64_t cycles = 0, instructions = 0;
};

/// The iteration that was measured last, with everything it depends on: the code and its wait
/// states, the state it began in, the registers that its instructions name, and one load. If all of
/// this is unchanged, and the load gives the same value in the same time, the iteration is the
/// same. Only for short loops while all memory is direct.
class KnownTurn {
 public:
  static constexpr unsigned longest = 8;  // instructions

  void forget() { turn_.reset(); }
  /// Keeps an iteration of `count` instructions that led from the present state back to it.
  void keep(const Machine& machine, const std::array<uint32_t, longest>& addresses, unsigned count,
            const Turn& turn);
  /// The iteration that begins in the present state; empty if it is not known.
  std::optional<Turn> at(const Machine& machine) const;

 private:
  struct Fetched {
    uint32_t address = 0, wait_states = 0;
    uint16_t halfwords[2] = {};
    bool operator==(const Fetched& other) const;
  };
  /// In addition to the registers.
  struct Place {
    uint32_t pc = 0, xpsr = 0, control = 0;
    uint16_t trail = 0;
    bool stalled = false, refilling = false;
    uint64_t private_accesses = 0;
    bool operator==(const Place& other) const;
  };
  static Place place_of(const Machine& machine);
  /// None where the code is not in direct memory.
  static std::optional<Fetched> fetch(const Machine& machine, uint32_t address);

  std::optional<Turn> turn_;
  std::array<Fetched, longest> code_{};
  unsigned count_ = 0;
  Place place_;
  uint32_t named_ = 0;  // registers, a bit each
  decltype(State::r) r_{};
};

}  // namespace capsoc::armv7m
