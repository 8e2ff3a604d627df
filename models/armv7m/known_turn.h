// A turn of a waiting loop that is known without being executed again.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "armv7m/state.h"

namespace capsoc::armv7m {

class Machine;

/// What a turn of a loop takes.
struct Turn {
  uint64_t cycles = 0, instructions = 0;
};

/// The last turn that was measured, with all that decided on it: the code and its wait states, the
/// place it began at, the registers that its instructions name, and one load. Where all of this is
/// the same, and the load gives the same in the same time, the turn is the same. Only of short
/// loops while all memory is direct.
class KnownTurn {
 public:
  static constexpr unsigned longest = 8;  // instructions

  void forget() { turn_.reset(); }
  /// Of a turn that led from the present state back to it over `count` instructions.
  void keep(const Machine& machine, const std::array<uint32_t, longest>& addresses, unsigned count,
            const Turn& turn);
  /// The turn that the present state begins; none if that is not known.
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
