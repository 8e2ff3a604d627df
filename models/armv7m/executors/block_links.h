#pragma once

#include <cstdint>

#include "armv7m/executors/step.h"

namespace capsoc::armv7m {

class Machine;
struct State;

/// How execution gets from one block to the next one. For the chains of steps, which know the
/// machine: looking it up here costs 3 % of the speed.
struct BlockLinks {
  /// After an operation that left its block: the first step of the block to continue with, or
  /// null.
  static const Step* leave(Machine& cpu, const Step& op);
  /// After a branch within its page that has no link yet, or whose target may not fit any more.
  static const Step* resolve_link(Machine& cpu, const Step& branch);
  /// The block at the program counter, built on demand; null where there can be none.
  static const Step* find(Machine& cpu);
  /// Ends the refill of a branch that led to an instruction.
  static void arrive(State& state, const DecodedOp& target);

 private:
  static const Step* next(Machine& cpu);
};

}  // namespace capsoc::armv7m
