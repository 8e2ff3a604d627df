#pragma once

#include <cstdint>

#include "armv7m/isa/op.h"

namespace capsoc::armv7m {

class Core;

/// How an exception was entered (B1.5): by preemption, by tail-chaining after a handler, or by late
/// arrival in place of an exception whose handler had not begun.
enum class Entry : uint8_t { preempts, tail_chains, displaces };

/// A data access of the core without a bus transaction: to direct memory or the private peripheral
/// bus.
struct DirectAccess {
  uint32_t address = 0, value = 0;
  unsigned size = 0;  ///< 1, 2 or 4 bytes
  bool write = false, ok = true;
};

/// Observes the processor in execution order. No call may change the core. An observed processor
/// executes the same instructions in the same cycles, but takes more host time.
class Observer {
 public:
  virtual ~Observer() = default;

  /// Before an instruction, at the cycle in which it begins.
  virtual void issued(const Core& core, const DecodedOp& op) = 0;
  /// After it and before the exception that it raises, if it does.
  virtual void retired(const Core& core, const DecodedOp& op) = 0;
  /// Before a handler's first instruction. The entry began at cycle `since`.
  virtual void entered(const Core& core, unsigned exception, Entry how, uint64_t since) = 0;
  /// Before the first instruction after a handler; its frame is unstacked.
  virtual void returned(const Core& core, unsigned exception) = 0;
  virtual void accessed(const Core& core, const DirectAccess& access) = 0;
  /// After a reset, before the first instruction.
  virtual void started(const Core& core) = 0;
};

}  // namespace capsoc::armv7m
