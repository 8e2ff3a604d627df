#pragma once

#include <array>
#include <cstdint>

#include "armv7m/system/registers.h"

namespace capsoc {
class Archive;
}

namespace capsoc::armv7m {

/// The data watchpoint and trace unit (C1.8): the cycle counter and four comparators whose matches
/// set MATCHED and go to the DebugMonitor exception. Packets, the profiling counters and data value
/// comparison are absent and read as zero; so is the whole FPB, which says that it has no
/// comparators. `tracing` is DEMCR.TRCENA, `now` the processor's cycle.
class Dwt {
 public:
  void reset();
  void visit(Archive& archive);

  uint32_t cycle_count(uint64_t now, bool tracing) const;
  /// CYCCNT is `count` now.
  void set_cycle_count(uint64_t now, uint32_t count);
  /// Derives from the registers what has to be checked. `steps`: DEMCR requests every step.
  void select(uint64_t now, bool tracing, bool steps);
  /// The same for loaded registers: earlier cycles were already checked for matches.
  void restored(bool tracing, bool steps);
  /// Data accesses; their pages leave the direct tables.
  bool watches_data() const { return watches_data_; }
  /// Instructions or cycles; they are executed one by one.
  bool observes_steps() const { return observes_steps_; }

  /// Matches set MATCHED; true if there was one.
  bool match_data(uint32_t address, unsigned size, bool write);
  /// After an instruction at `executed`.
  bool match_step(uint32_t executed, uint64_t now, bool tracing);
  /// `page`: its first address. A mask reaches beyond one page at most by whole pages.
  bool watches_page(uint32_t page, uint32_t page_size) const;

  uint32_t read(uint32_t address, uint64_t now, bool tracing) const;
  /// A read of MATCHED clears it.
  void matched_read(uint32_t address);
  /// select() has to follow.
  void write(uint32_t address, const LaneWrite& write, uint64_t now, bool tracing);

  static constexpr unsigned comparators = 4;
  /// Where an address is in the comparators' words: a multiple of 4 below 16; 8 is FUNCTION.
  static bool is_function(uint32_t address);

 private:
  uint32_t ctrl_ = 0;
  uint64_t cyccnt_base_ = 0;
  uint32_t cyccnt_stopped_ = 0;
  std::array<uint32_t, comparators> comparator_{}, mask_{}, function_{};
  bool watches_data_ = false, observes_steps_ = false;  // made from the registers
  uint32_t count_seen_ = 0;  // CYCCNT up to which cycle matches were looked for
};

}  // namespace capsoc::armv7m
