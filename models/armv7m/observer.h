#pragma once

#include <cstdint>

#include "armv7m/isa/op.h"

namespace capsoc::armv7m {

class Core;

/// How an exception came to be taken (B1.5): on top of what ran, straight after a handler that
/// ended, or in the place of one that had not begun.
enum class Entry : uint8_t { preempts, tail_chains, displaces };

/// A data access of the core that no bus sees: direct memory and the private peripheral bus.
struct DirectAccess {
  uint32_t address = 0, value = 0;
  unsigned size = 0;  ///< 1, 2 or 4 bytes
  bool write = false, ok = true;
};

/// Observes what the processor does, in the order in which it does it. It only looks: no call may
/// change the core. A processor that is looked at executes the same instructions in the same
/// cycles, more slowly.
class Observer {
 public:
  virtual ~Observer() = default;

  /// Before an instruction, at the cycle in which it begins.
  virtual void issued(const Core& core, const DecodedOp& op) = 0;
  /// After it and before the exception that it raises, if it does.
  virtual void retired(const Core& core, const DecodedOp& op) = 0;
  /// In front of a handler's first instruction. The entry began at cycle `since`.
  virtual void entered(const Core& core, unsigned exception, Entry how, uint64_t since) = 0;
  /// In front of the first instruction after a handler, its frame unstacked.
  virtual void returned(const Core& core, unsigned exception) = 0;
  virtual void accessed(const Core& core, const DirectAccess& access) = 0;
  /// Out of reset, in front of the first instruction.
  virtual void started(const Core& core) = 0;
};

}  // namespace capsoc::armv7m
