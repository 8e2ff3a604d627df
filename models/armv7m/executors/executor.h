#pragma once

#include <cstdint>

namespace capsoc::armv7m {

/// A way to execute instructions. All of them agree bit for bit and cycle for cycle.
class InstructionExecutor {
 public:
  virtual ~InstructionExecutor() = default;

  /// Executes whole instructions, at least one, while the cycle is below `limit` and nothing waits
  /// to be looked at (Requests). It may return earlier.
  virtual void run(uint64_t limit) = 0;

 protected:
  InstructionExecutor() = default;
  InstructionExecutor(const InstructionExecutor&) = default;
  InstructionExecutor& operator=(const InstructionExecutor&) = default;
};

}  // namespace capsoc::armv7m
