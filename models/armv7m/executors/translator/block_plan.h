#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "armv7m/executors/step.h"
#include "armv7m/isa/flag_liveness.h"

namespace capsoc::armv7m {

class Machine;

// What the translator does with a step, whatever block it is in.
/// False for what is left to C++: what is rare, faults, changes the mode, or is UNPREDICTABLE.
bool is_translated(const Step& step);
/// True for an operation that computes R13 from others.
bool writes_sp(const Step& step);
/// True for MRS and MSR of PSP, by which handlers switch tasks.
bool moves_stack_pointer(const Step& step);
/// MRS of PRIMASK, BASEPRI, FAULTMASK or CONTROL, in no IT block.
bool reads_masks(const Step& step);
/// MSR to PRIMASK or BASEPRI, or CPS of PRIMASK alone, in no IT block.
bool masks_interrupts(const Step& step);
/// True where translated code may leave the block, so that all flags can be seen.
bool may_be_left_at(const Step& step);

/// What is to be translated: the steps of a block, where it is cut, which flags are live, and the
/// step that is being written. Writes no code. Steps and page belong to the caller and must outlive
/// the translation of the block.
class BlockPlan {
 public:
  /// Bound on the cycles of a block, in cycles; a longer one is cut.
  static constexpr uint32_t most_cycles = 256;

  explicit BlockPlan(const Machine& machine) : machine_(machine) {}

  /// Takes the steps from the head on, up to the first that is left to C++ for good, that one with
  /// them. A block that could take too many cycles runs into another one where it is cut.
  void begin(const Step* head, CodePage& page);

  const Step& head() const { return *head_; }
  CodePage& page() const { return *page_; }
  std::size_t size() const { return steps_.size(); }
  const Step& operator[](std::size_t i) const { return *steps_[i]; }
  /// The step from which on the block would take too many cycles; size() if there is none.
  std::size_t cut() const { return cut_; }
  /// Cycles that the block can take at most.
  uint32_t bound() const { return bound_; }

  /// The number of the step that is being written.
  std::size_t present() const { return present_; }
  void go_to(std::size_t i) { present_ = i; }

  /// The flags that may be seen after a step.
  uint8_t visible(std::size_t i) const { return visible_[i]; }
  void set_visible(std::size_t i, uint8_t flags) { visible_[i] = flags; }
  /// The flags that the present step has to leave.
  uint8_t wanted(const Step& step) const { return step.set_flags ? visible_[present_] : 0; }

  // Groups: neighbours under one condition of an IT block
  /// The end of the group that begins with a step. One that sets flags is the last of its group.
  std::size_t end_of_group(std::size_t begin) const;
  /// The flags that may be seen after a group, where it is left, or inside it.
  uint8_t visible_behind_group(std::size_t begin, std::size_t end) const;

  /// The distance of a member from the record of its page, in bytes: `member` is one of page()'s.
  int32_t in_code_page(const void* member) const;

 private:
  void collect_steps();
  void split();
  uint32_t bound_of(const Step& step) const;

  const Machine& machine_;
  const Step* head_ = nullptr;
  CodePage* page_ = nullptr;
  std::vector<const Step*> steps_;
  std::vector<uint8_t> visible_;
  std::size_t present_ = 0;
  uint32_t bound_ = 0;
  std::size_t cut_ = 0;
  Step close_;  // stands for the step at which the block is cut, if another may begin with it
};

}  // namespace capsoc::armv7m
