#pragma once

#include "armv7m/core_context.h"
#include "armv7m/debugging.h"
#include "armv7m/exceptions.h"
#include "armv7m/execution_counts.h"
#include "armv7m/executors/block_builder.h"
#include "armv7m/floating_point.h"
#include "armv7m/memory/memory_access.h"
#include "armv7m/pending_exceptions.h"
#include "armv7m/system/system_space.h"
#include "armv7m/watchpoints.h"

namespace capsoc::armv7m {

/// The processor as its executors see it: the shared context and the parts around it. Other
/// components use core.h. Apart from the state it has only caches, wires and a debugger's settings.
class Machine : public CoreContext {
 public:
  Machine(Core& core, Bus& bus, const Profile& core_profile);

  PendingExceptions pending;
  Watchpoints watchpoints;
  MemoryAccess memory;
  FloatingPoint floating_point;
  Exceptions exceptions;
  SystemSpace system;
  Debugging debugging;
  /// Blocks that may reach this cycle are not entered by a link.
  uint64_t block_limit = 0;
  BlockBuilder* block_builder = nullptr;  // of blocks that are not there yet; not owned

  /// `b .` in a fault handler: asks the listener whether the program is stuck.
  void spin_in_fault();
  /// After an operation that left its block: account() adds its cycles and state, conclude()
  /// handles its event.
  void account(const Step& op);
  void conclude(const Step& op);
  /// Called between the two, while executions are counted.
  void count(const Step& op) {
    if (event.kind == Event::Kind::none) counts->left(op, state.pc);
  }
  /// Takes the event.
  void handle_event();
};

inline void Machine::account(const Step& op) {
  state.cycles += op.cycles_before + op.cycles;
  state.instructions += op.instructions_to;
  state.it_state = op.it_after;
  state.trail = state.refilling ? timing::trail_refill
                : state.stalled ? timing::no_trail
                                : op.trail;
  state.stalled = state.refilling = false;
}

inline void Machine::conclude(const Step& op) {
  if (__builtin_expect(event.kind == Event::Kind::none, 1)) return;
  if (event.kind == Event::Kind::fault || event.kind == Event::Kind::abandoned)
    state.it_state = op.it_before;
  if (event.kind == Event::Kind::exception_return) event.return_address = op.address;
  state.trail = timing::no_trail;
  handle_event();
  if (counts != nullptr) counts->moved(next_address(op), state.pc);
}

}  // namespace capsoc::armv7m
