// Who called whom: the call stacks of the program, reconstructed from what the processor executes.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <tuple>
#include <unordered_map>
#include <vector>

#include "armv7m/core.h"
#include "trace/functions.h"

namespace capsoc::trace {

/// What something took.
struct Cost {
  uint64_t cycles = 0, instructions = 0;

  Cost& operator+=(const Cost& other) {
    cycles += other.cycles;
    instructions += other.instructions;
    return *this;
  }
  Cost operator-(const Cost& other) const {
    return {cycles - other.cycles, instructions - other.instructions};
  }
};

/// Follows calls, returns, tail calls, exceptions and switches of the thread's stack.
///
/// - BL and BLX with a register open a frame with the return address and the stack pointer.
/// - A return is a jump to a frame's return address with the stack pointer it was called with,
///   whatever the instruction. A jump that leaves the stack pointer above a frame (longjmp) ends
///   it.
/// - A jump from one function into another one is a tail call: a frame on top of the one that
///   jumped, with the same return address, so that both end with one return.
/// - An exception has its own stack, headed by a name like "[SysTick]" that takes the cycles
/// of
///   entry and return. What it takes is not in the inclusive cost of what it interrupted.
/// - A return to Thread mode at another stack pointer than the one that was interrupted (the switch
///   of an RTOS) continues with the stack that was interrupted there, or with a new one.
/// - Cycles outside any instruction (sleep) are those of "[waiting]".
class CallTree {
 public:
  explicit CallTree(Functions& functions);

  /// Costs and calls count while this is true; stacks are followed always.
  void count(bool on) { counting_ = on; }

  void issued(const armv7m::Core& core);
  void retired(const armv7m::Core& core, const armv7m::DecodedOp& op);
  void entered(const armv7m::Core& core, unsigned exception, armv7m::Entry how, uint64_t since);
  void returned(const armv7m::Core& core, unsigned exception);
  void started(const armv7m::Core& core);
  /// The trace begins in the middle of a program, between two instructions. The callers of the
  /// function under way are not known, nor what an exception under way interrupted.
  void begin(const armv7m::Core& core);
  /// Ends every frame; nothing may follow.
  void finish(const armv7m::Core& core);

  /// Costs of the instructions, by address.
  const std::unordered_map<uint32_t, Cost>& by_address() const { return by_address_; }
  /// Costs outside instructions, by function.
  const std::map<uint32_t, Cost>& by_name() const { return by_name_; }

  /// A place from which a function was called. `site` is the address of the call.
  struct Edge {
    uint32_t caller = 0, site = 0, callee = 0;
    bool operator<(const Edge& other) const {
      return std::tie(caller, site, callee) < std::tie(other.caller, other.site, other.callee);
    }
  };
  struct Calls {
    uint64_t count = 0;
    Cost inclusive;
  };
  const std::map<Edge, Calls>& calls() const { return calls_; }

  /// Calls with every path of functions, outermost first, that has its own cost.
  using Visitor = std::function<void(const std::vector<uint32_t>& path, const Cost& self)>;
  void each_path(const Visitor& visit) const;

 private:
  struct Frame {
    uint32_t function = 0, site = 0, return_address = 0, stack = 0;
    bool tail = false, counted = false;
    Cost before;        ///< of the stack, when the frame was opened
    uint32_t node = 0;  ///< its path
  };
  /// The frames of Thread mode or of one handler.
  struct Stack {
    std::vector<Frame> frames;
    Cost total;
    uint32_t interrupted_at = 0;  ///< the stack pointer of the exception's frame
  };
  struct Node {
    uint32_t function = 0, parent = 0;
    Cost self;
  };

  Stack new_stack(uint32_t function);
  void push(Stack& stack, Frame frame);
  void pop(Stack& stack);
  void end(Stack& stack);
  void charge(Cost cost);
  void charge_name(uint32_t name, uint64_t cycles);
  void wait_until(uint64_t cycle);
  void jump(const armv7m::Core& core, uint32_t from);
  void call(const armv7m::Core& core, uint32_t site);
  bool leave_frames(uint32_t pc, uint32_t stack_pointer);
  bool go_back(uint32_t pc, uint32_t stack_pointer);
  void resume_thread(const armv7m::Core& core);
  uint32_t child(uint32_t node, uint32_t function);
  uint32_t exception_function(unsigned number);
  void push_handler(const armv7m::Core& core);

  Functions& functions_;
  uint32_t waiting_;
  std::map<unsigned, uint32_t> exceptions_;
  std::vector<Stack> nest_;       ///< Thread mode, then the handlers that are active
  std::vector<Stack> suspended_;  ///< threads that were switched away from
  std::vector<Node> nodes_{Node{}};
  std::unordered_map<uint64_t, uint32_t> children_;
  std::map<uint32_t, Cost> by_name_;
  std::unordered_map<uint32_t, Cost> by_address_;
  std::map<Edge, Calls> calls_;
  uint64_t cycle_ = 0;  ///< everything up to here is accounted for
  bool counting_ = true;
};

}  // namespace capsoc::trace
