#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <unordered_map>
#include <utility>
#include <vector>

#include "armv7m/isa/op.h"

namespace capsoc::armv7m {

/// Counts executions of each instruction, and decisions of conditional branches and IT blocks, with
/// every executor. Only departures from sequential execution are counted: in between, each
/// instruction was executed as often as its predecessor. An instruction that faults counts; one
/// whose fetch fails does not.
class ExecutionCounts {
 public:
  ExecutionCounts();
  ~ExecutionCounts();
  ExecutionCounts(const ExecutionCounts&) = delete;
  ExecutionCounts& operator=(const ExecutionCounts&) = delete;

  static constexpr unsigned page_bits = 12;
  static constexpr unsigned halfwords = 1u << (page_bits - 1);  ///< of a page

  // What happens, for the executors
  /// Each instruction, before it is executed for the first time and whenever memory has changed
  /// since.
  void decoded(const DecodedOp& op);
  /// Execution continues at `to` instead of `from`.
  void moved(uint32_t from, uint32_t to);
  /// An instruction has left its block without an event, towards `pc`.
  void left(const DecodedOp& op, uint32_t pc);
  /// The condition that IT gave to an instruction failed.
  void skipped(const DecodedOp& op);
  /// The PC at the beginning and at the end of a run of the core. A change between two runs comes
  /// from outside (a reset, a debugger).
  void begins(uint32_t pc);
  void ends(uint32_t pc) { standing_ = pc; }
  /// Starts and ends the recording that repeat() counts again.
  void record(bool on);
  void repeat(uint64_t times);

  // Counters at stable addresses, for translated code that counts by itself
  /// To be counted up each time that a branch leads to a known address.
  uint64_t* branch(const DecodedOp& op, uint32_t target);
  /// To be counted down at the address after an instruction that leads elsewhere, and up where it
  /// leads to.
  int64_t* line(uint32_t address);
  /// Such counters by page: a table of 2^20 pointers to a counter for each halfword. Null where no
  /// code was decoded.
  const void* lines() const { return pages_; }
  /// To be counted up each time that the instructions from one address up to another are skipped.
  uint64_t* skips(uint32_t first, uint32_t behind);

  /// Of the halfwords of a page; of an instruction's second one as of its first.
  struct Totals {
    std::array<uint64_t, halfwords> executed{};  ///< skipped ones among them
    std::array<uint64_t, halfwords> skipped{};
    std::array<uint64_t, halfwords> taken{};  ///< at a conditional branch's first one
  };
  /// Totals so far, by page number. Call between two runs of the core.
  std::map<uint32_t, Totals> totals() const;
  /// The registers R0 to R14 that an instruction executed since `before` may have changed, a bit
  /// each; one that was skipped counts.
  uint32_t changed_registers(const std::map<uint32_t, Totals>& before) const;

 private:
  struct Page {
    std::array<int64_t, halfwords> line{};  ///< how much more often than the halfword before it
    std::array<uint64_t, halfwords> skipped{}, taken{};
    std::array<uint16_t, halfwords> changes{};  ///< registers, by all that were decoded here
  };
  struct Branch {
    uint32_t address, from, to;
    bool conditional;
    uint64_t count;
  };
  struct Skip {
    uint32_t first, behind;
    uint64_t count;
  };
  enum class Kind : uint8_t { arrive, depart, skip, take };
  struct Change {
    Kind kind;
    uint32_t address;
  };
  Page& page(uint32_t address);
  static void add(Page& page, Change change, uint64_t times);
  void note(Change change);

  Page** pages_;                        // by number
  std::vector<uint32_t> page_numbers_;  // of those that are there
  std::deque<Branch> branches_;
  std::deque<Skip> skips_;
  std::unordered_map<uint64_t, uint64_t*> branch_counters_, skip_counters_;
  std::vector<Change> recorded_;
  bool recording_ = false, begun_ = false;
  uint32_t standing_ = 0;
};

}  // namespace capsoc::armv7m
