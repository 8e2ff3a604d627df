#pragma once

#include <cstdint>
#include <memory>

#include "armv7m/executors/block_builder.h"
#include "armv7m/executors/executor.h"
#include "armv7m/executors/step.h"
#include "armv7m/executors/stepping.h"

namespace capsoc::armv7m {

class Machine;
struct State;

/// The fast executor: basic blocks, cached by page and linked within it. What has no block (a page
/// that may not be executed throughout, the middle of an IT block) is stepped.
class Blocks : public InstructionExecutor, public BlockBuilder {
 public:
  /// Becomes the machine's builder of blocks. Nothing is owned.
  Blocks(Machine& machine, Stepping& stepping);
  Blocks(const Blocks&) = delete;
  Blocks& operator=(const Blocks&) = delete;
  void run(uint64_t limit) override;
  /// Instructions that were stepped because there was no block.
  uint64_t stepped() const { return stepped_; }
  std::unique_ptr<Step[]> build(uint32_t address, CodePage& page) const override;

  // For the translator
  /// The beginning of run(): the first step of a block that surely ends before the limit. Null:
  /// there is none, and what could be executed has been.
  const Step* begin(uint64_t limit);
  /// True if a block surely ends before the limit.
  bool fits(const Step& first) const;
  /// Executes from a step to the end of its block or to the limit.
  void run_to_limit(const Step* first);

 private:
  static bool may_begin(const State& state);

  uint64_t stepped_ = 0;
  Machine& machine_;
  Stepping& stepping_;
};

}  // namespace capsoc::armv7m
