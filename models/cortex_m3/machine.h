#pragma once

#include "cortex_m3/debugging.h"
#include "cortex_m3/event.h"
#include "cortex_m3/exceptions.h"
#include "cortex_m3/execution_counts.h"
#include "cortex_m3/executors/blocks.h"
#include "cortex_m3/executors/translator/host_context.h"
#include "cortex_m3/listeners.h"
#include "cortex_m3/memory/memory_access.h"
#include "cortex_m3/state.h"
#include "cortex_m3/system/system_space.h"

namespace capsoc::cortex_m3 {

/// The processor as its own parts see it, and as nobody else does (core.h): the state, and beside
/// it what is between two instructions no more than a cache, a wire or a debugger's.
class Machine {
 public:
  Machine(Core& core, Bus& bus);
  Machine(const Machine&) = delete;
  Machine& operator=(const Machine&) = delete;

  State state;
  HostContext host_context;
  Requests requests;
  Event event;
  MemoryAccess memory;
  Blocks blocks;
  Exceptions exceptions;
  SystemSpace system;
  Debugging debugging;
  Listeners listeners;
  ExecutionCounts* counts = nullptr;  // null: nobody counts

  Core& core() { return core_; }
  const Core& core() const { return core_; }
  /// Inside an access the cycle at which it happens.
  /// Accesses to the private peripherals so far; of this program's run, no state.
  uint64_t private_accesses = 0;
  uint64_t cycles() const { return state.cycles + memory.cycle_offset(); }

  // What an instruction comes to. False: the block is left.
  /// The next instruction is the one behind it.
  bool leave(const Step& op) {
    state.pc = next_address(op);
    return false;
  }
  /// A fault of the instruction at an address; `value` goes to MMFAR or BFAR.
  bool fault(uint32_t instruction, Cause cause, uint32_t value = 0);
  bool fault(const Step& op, Cause cause, uint32_t value = 0) {
    return fault(op.address, cause, value);
  }
  /// BranchWritePC and BXWritePC (A2.3.1).
  bool branch_to(uint32_t address) {
    state.pc = address & ~1u;
    return false;
  }
  bool interwork_to(uint32_t target);
  /// The time a branch takes beyond its own.
  void refill(unsigned cycles) {
    state.cycles += cycles;
    state.refilling = cycles < timing::most_refill;
  }
  void sleep(bool for_event);
  /// `b .` in a fault handler: how one that gives up ends.
  void spin_in_fault();
  /// Tells the listener about each case once. Inside a block state.pc is behind what is executed,
  /// so it is the instruction's address for that long.
  void report(Unpredictable which, uint32_t instruction);

  /// What both executors do behind an operation that left: account for it, then see to its event.
  void account(const Step& op);
  void conclude(const Step& op);
  /// In between, while executions are counted.
  void count(const Step& op) {
    if (event.kind == Event::Kind::none) counts->left(op, state.pc);
  }
  /// Takes the event.
  void handle_event();

 private:
  Core& core_;
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
  if (event.kind == Event::Kind::fault) state.it_state = op.it_before;
  if (event.kind == Event::Kind::exception_return) event.return_address = op.address;
  state.trail = timing::no_trail;
  handle_event();
  if (counts != nullptr) counts->moved(next_address(op), state.pc);
}

template <typename T>
inline Access MemoryAccess::load(const Step& op, uint32_t address, uint32_t& value) {
  const Memory::Page& p = direct(address);
  if (__builtin_expect(p.read != nullptr && (address & (sizeof(T) - 1)) == 0, 1)) {
    T data;
    std::memcpy(&data, p.read + (address & (Memory::page_size - 1)), sizeof(T));
    value = data;
    if (__builtin_expect(p.wait_states != 0, 0)) machine_.state.cycles += p.wait_states;
    return Access::ok;
  }
  return load_slow(op, address, sizeof(T), value);
}

template <typename T>
inline Access MemoryAccess::store(const Step& op, uint32_t address, uint32_t value) {
  const Memory::Page& p = direct(address);
  if (__builtin_expect(p.write != nullptr && (address & (sizeof(T) - 1)) == 0, 1)) {
    T data = static_cast<T>(value);
    std::memcpy(p.write + (address & (Memory::page_size - 1)), &data, sizeof(T));
    if (__builtin_expect(p.wait_states != 0, 0)) machine_.state.cycles += p.wait_states;
    return Access::ok;
  }
  return store_slow(op, address, sizeof(T), value);
}

}  // namespace capsoc::cortex_m3
