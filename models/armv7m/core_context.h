#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "armv7m/event.h"
#include "armv7m/executors/translator/host_context.h"
#include "armv7m/halting_debug.h"
#include "armv7m/listeners.h"
#include "armv7m/profile.h"
#include "armv7m/state.h"

namespace capsoc::armv7m {

class ExecutionCounts;

/// The context that all parts of the processor share, and their only connection: the state, results
/// of an instruction for the run loop, and the listeners. Base of a Machine.
class CoreContext {
 public:
  /// `core`: passed to observers and listeners. Neither is owned.
  explicit CoreContext(Core& core, const Profile& core_profile = cortex_m3)
      : profile(core_profile), core_(core) {}
  CoreContext(const CoreContext&) = delete;
  CoreContext& operator=(const CoreContext&) = delete;

  State state;
  std::array<std::byte, host_context_gap(sizeof(State))> gap{};
  HostContext host_context;  // translated code addresses it relative to the state
  Requests requests;
  Event event;
  HaltingDebug halting;
  Listeners listeners;
  ExecutionCounts* counts = nullptr;  // null: executions are not counted
  /// During an access: cycles of the present block that precede it and are not yet in state.cycles.
  uint64_t cycle_offset = 0;
  /// Accesses to the private peripherals since construction; not part of the saved state.
  uint64_t private_accesses = 0;
  const Profile& profile;

  Core& core() { return core_; }
  const Core& core() const { return core_; }
  /// Inside an access the cycle at which it happens.
  uint64_t cycles() const { return state.cycles + cycle_offset; }

  // Outcomes of an instruction. All return false: the block is left.
  /// The next instruction is the one after it.
  bool leave(const DecodedOp& op) {
    state.pc = next_address(op);
    return false;
  }
  /// A fault of the instruction at an address; `value` goes to MMFAR or BFAR.
  bool fault(uint32_t instruction, Cause cause, uint32_t value = 0) {
    event = {Event::Kind::fault, cause, value, event.return_address};
    state.pc = instruction;
    return false;
  }
  bool fault(const DecodedOp& op, Cause cause, uint32_t value = 0) {
    return fault(op.address, cause, value);
  }
  /// BranchWritePC (A2.3.1).
  bool branch_to(uint32_t address) {
    state.pc = address & ~1u;
    return false;
  }
  /// BXWritePC (A2.3.1).
  bool interwork_to(uint32_t target);
  /// Adds the pipeline refill of a taken branch.
  void refill(unsigned cycles) {
    state.cycles += cycles;
    state.refilling = cycles < timing::most_refill;
  }
  void sleep(bool for_event);
  /// Notifies the listener of each case once. Inside a block state.pc is past the instruction, so
  /// it is set to the instruction's address during the call.
  void report(Unpredictable which, uint32_t instruction);

 private:
  Core& core_;
};

}  // namespace capsoc::armv7m
