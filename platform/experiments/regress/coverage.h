// Functional coverage: which situations a regression has put the coprocessor into, counted in named
// bins. Bins that the arithmetic cannot reach do not exist.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "coprocessor/sequencer.h"
#include "coprocessor/types.h"

namespace capsoc::regress {

enum class Group : uint8_t {
  sample_quadrant,    // signs of u and v
  relative_quadrant,  // of the polar unit's result in T1
  angle_quadrant,     // of ANGLE
  phi_quadrant,
  beta_quadrant,
  seam,        // the relative angle next to 0 and half a turn
  saturation,  // a word at the end of its range
  tie,         // a rounded shift of exactly one half
  flag_set,
  flag_cleared,
  interrupt,
  mode,         // of the samples committed
  mode_change,  // by what, and whether the pipeline was busy
  load_moment,
  soft_reset_moment,
  pin_reset_moment,
  collision,  // accesses at the edge at which the pipeline writes
  spacing,    // cycles from sample to sample
  acceptance,
  access,   // kinds of bus accesses
  strobes,  // of a write that lacks some
  read_of,
  write_of,
  pair,  // the halves of 48-bit registers
  loop,
  step,
  event,
  turn,  // windows of the turn judge
  alarm,
  slew,       // errors against their limit
  parity,     // registers whose parity bit was wrong
  safety,     // what the safety mechanisms find, at their limits
  magnitude,  // of a1
  count
};

class Coverage {
 public:
  /// tick: cycles of one, after which the bins of spacing are named.
  explicit Coverage(coprocessor::Arithmetic arithmetic, unsigned tick = coprocessor::tick_cycles);

  void hit(Group group, size_t bin) { ++hits_[static_cast<size_t>(group)][bin]; }
  void hit_if(bool condition, Group group, size_t bin) {
    if (condition) hit(group, bin);
  }
  void add(const Coverage& other);

  struct Bin {
    std::string group, name;
    uint64_t hits = 0;
  };
  /// All counts, and those of another process of this program, of the same arithmetic. false: these
  /// are no counts of such.
  std::vector<uint64_t> counts() const;
  bool add(const std::vector<uint64_t>& counts);
  /// Every reachable bin, group by group.
  std::vector<Bin> bins() const;

 private:
  coprocessor::Arithmetic arithmetic_;
  unsigned tick_;
  std::array<std::vector<uint64_t>, static_cast<size_t>(Group::count)> hits_;
};

/// The position of a register in the description's table; its size if it has none there.
size_t register_index(uint32_t offset);

}  // namespace capsoc::regress
