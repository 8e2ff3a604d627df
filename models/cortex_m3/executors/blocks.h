#pragma once

#include <cstdint>
#include <memory>

#include "cortex_m3/executors/executor.h"
#include "cortex_m3/executors/step.h"
#include "cortex_m3/executors/stepping.h"

namespace capsoc::cortex_m3 {

class Machine;
struct State;

/// The fast executor: basic blocks, cached by page and linked within it. What has no block (a page
/// that may not be executed throughout, the middle of an IT block) is stepped.
class Blocks : public InstructionExecutor {
 public:
  explicit Blocks(Machine& machine) : machine_(machine), stepping_(machine) {}
  void run(uint64_t limit) override;
  Stepping& stepping() { return stepping_; }
  /// Instructions that were stepped because there was no block.
  uint64_t stepped() const { return stepped_; }

  /// Completes the time of a decoded step by its predecessor and the wait states of its fetch.
  void add_cycles(Step& step, uint16_t before, uint32_t wait_states) const;
  /// Ends the refill of a branch that led to an instruction.
  static void arrive(State& state, const DecodedOp& target);

  // For the chains of steps, which know the machine: looking it up here costs 3 % of the speed.
  /// Blocks that may reach this cycle are not entered by a link.
  uint64_t limit() const { return limit_; }
  /// Behind an operation that left its block: the first step of the block to go on with, or null.
  static const Step* leave(Machine& cpu, const Step& op);
  /// Behind a branch within its page that has no link yet, or whose target may not fit any more.
  static const Step* resolve_link(Machine& cpu, const Step& branch);

  // For the translator
  /// The beginning of run(): the first step of a block that surely ends before the limit. Null:
  /// there is none, and what could be executed has been.
  const Step* begin(uint64_t limit);
  /// True if a block surely ends before the limit.
  bool fits(const Step& first) const;
  /// The block at the program counter, built on demand; null where there can be none.
  static const Step* find(Machine& cpu);
  /// Executes from a step to the end of its block or to the limit.
  void run_to_limit(const Step* first);

 private:
  static const Step* next(Machine& cpu);
  static bool may_begin(const State& state);
  std::unique_ptr<Step[]> build(uint32_t address, CodePage& page) const;

  uint64_t limit_ = 0;
  uint64_t stepped_ = 0;
  Machine& machine_;
  Stepping stepping_;
};

}  // namespace capsoc::cortex_m3
