#include "trace/call_tree.h"

#include <algorithm>
#include <utility>

#include "armv7m/active_exception.h"
#include "armv7m/exception_frame.h"
#include "trace/exception_name.h"

namespace capsoc::trace {
namespace {

using armv7m::Core;
using armv7m::DecodedOp;
using armv7m::Entry;
using armv7m::Operation;

/// Bounds on what a guest can make us keep: beyond them paths end early and threads are forgotten.
constexpr std::size_t most_nodes = 1U << 20, most_frames = 1U << 16, most_suspended = 1024;
/// A return address that is none: EXC_RETURN values lie above.
constexpr uint32_t nowhere = 0xFFFFFFFF;
constexpr uint32_t first_exc_return = 0xF0000000;

bool jumps_directly(const DecodedOp& op) {
  return op.operation == Operation::b || op.operation == Operation::bcond ||
         op.operation == Operation::cbz || op.operation == Operation::cbnz;
}

}  // namespace

CallTree::CallTree(Functions& functions)
    : functions_(functions), waiting_(functions.add_name("[waiting]")) {}

uint32_t CallTree::exception_function(unsigned number) {
  const auto [found, added] = exceptions_.try_emplace(number, 0);
  if (added) found->second = functions_.add_name("[" + exception_name(number) + "]");
  return found->second;
}

uint32_t CallTree::child(uint32_t node, uint32_t function) {
  const uint64_t key = uint64_t{node} << 32U | function;
  const auto found = children_.find(key);
  if (found != children_.end()) return found->second;
  if (nodes_.size() >= most_nodes) return node;
  nodes_.push_back({function, node, {}});
  return children_[key] = static_cast<uint32_t>(nodes_.size() - 1);
}

CallTree::Stack CallTree::new_stack(uint32_t function) {
  Stack stack;
  Frame root;
  root.function = function;
  root.return_address = root.stack = nowhere;
  root.node = child(0, function);
  stack.frames.push_back(root);
  return stack;
}

void CallTree::push(Stack& stack, Frame frame) {
  if (stack.frames.size() >= most_frames) return;
  frame.counted = counting_;
  frame.before = stack.total;
  frame.node = child(stack.frames.back().node, frame.function);
  stack.frames.push_back(frame);
}

/// Ends the frame on top; never the root.
void CallTree::pop(Stack& stack) {
  const Frame top = stack.frames.back();
  stack.frames.pop_back();
  const Cost inclusive = stack.total - top.before;
  if (!top.counted && inclusive.cycles == 0 && inclusive.instructions == 0) return;
  Calls& calls = calls_[{stack.frames.back().function, top.site, top.function}];
  calls.count += top.counted ? 1 : 0;
  calls.inclusive += inclusive;
}

void CallTree::end(Stack& stack) {
  while (stack.frames.size() > 1) pop(stack);
}

/// To the function on top of the present stack.
void CallTree::charge(Cost cost) {
  Stack& stack = nest_.back();
  stack.total += cost;
  nodes_[stack.frames.back().node].self += cost;
}

void CallTree::charge_name(uint32_t name, uint64_t cycles) {
  if (!counting_ || cycles == 0) return;
  by_name_[name] += Cost{cycles, 0};
}

void CallTree::wait_until(uint64_t cycle) {
  if (cycle <= cycle_) return;
  charge_name(waiting_, cycle - cycle_);
  if (counting_) nodes_[child(0, waiting_)].self += Cost{cycle - cycle_, 0};
  cycle_ = cycle;
}

void CallTree::started(const Core& core) {
  wait_until(core.cycles());
  for (Stack& stack : nest_) end(stack);
  for (Stack& stack : suspended_) end(stack);
  nest_.clear();
  suspended_.clear();
  nest_.push_back(new_stack(functions_.at(core.reg(15))));
}

void CallTree::begin(const Core& core) {
  cycle_ = core.cycles();
  nest_.clear();
  const unsigned exception = armv7m::active_exception(core);
  nest_.push_back(new_stack(exception == 0 ? functions_.at(core.reg(15)) : Functions::unknown));
  if (exception == 0) return;
  nest_.push_back(new_stack(exception_function(exception)));
  push_handler(core);
}

/// The handler's first frame, on the stack of its exception.
void CallTree::push_handler(const Core& core) {
  Frame handler;
  handler.function = functions_.at(core.reg(15));
  handler.return_address = handler.stack = nowhere;
  push(nest_.back(), handler);
}

void CallTree::issued(const Core& core) {
  if (nest_.empty()) nest_.push_back(new_stack(functions_.at(core.reg(15))));
  wait_until(core.cycles());
}

void CallTree::retired(const Core& core, const DecodedOp& op) {
  const Cost cost{core.cycles() - cycle_, 1};
  cycle_ = core.cycles();
  if (counting_) {
    by_address_[op.address] += cost;
    charge(cost);
  }
  const uint32_t pc = core.reg(15);
  if (pc >= first_exc_return) return;  // returned() or entered() follows
  const bool straight = pc == next_address(op);
  const bool links = op.operation == Operation::bl || op.operation == Operation::blx;
  if (links && !straight && (core.reg(14) & ~1U) == next_address(op)) return call(core, op.address);
  if (straight || jumps_directly(op)) {
    if (functions_.at(pc) == nest_.back().frames.back().function) return;
    if (functions_.at(pc) == functions_.at(op.address)) return;
  }
  jump(core, op.address);
}

void CallTree::call(const Core& core, uint32_t site) {
  Frame frame;
  frame.function = functions_.at(core.reg(15));
  frame.site = site;
  frame.return_address = core.reg(14) & ~1U;
  frame.stack = core.reg(13);
  push(nest_.back(), frame);
}

/// Ends the frames that a jump to `pc` returns from; false: it is no return.
bool CallTree::leave_frames(uint32_t pc, uint32_t stack_pointer) {
  Stack& stack = nest_.back();
  std::vector<Frame>& frames = stack.frames;
  while (frames.size() > 1 && frames.back().stack < stack_pointer) pop(stack);
  std::size_t at = frames.size();
  while (at > 1 && frames[at - 1].stack == stack_pointer && frames[at - 1].return_address != pc)
    --at;
  if (at <= 1 || frames[at - 1].stack != stack_pointer) return false;
  // Tail calls share their return address with the frame that they replaced.
  while (at > 2 && frames[at - 1].tail) --at;
  while (frames.size() >= at) pop(stack);
  return true;
}

/// Ends the frames above one that continues in the middle of its function, after a call that it
/// made with this stack pointer (longjmp); false: there is none.
bool CallTree::go_back(uint32_t pc, uint32_t stack_pointer) {
  Stack& stack = nest_.back();
  const uint32_t function = functions_.at(pc);
  if (pc == functions_[function].address) return false;
  for (std::size_t i = stack.frames.size() - 1; i > 0; --i) {
    if (stack.frames[i].stack != stack_pointer) return false;
    if (stack.frames[i - 1].function != function) continue;
    while (stack.frames.size() > i) pop(stack);
    return true;
  }
  return false;
}

/// Execution continues elsewhere than after the instruction at `from`, and not by a call.
void CallTree::jump(const Core& core, uint32_t from) {
  const uint32_t pc = core.reg(15);
  if (leave_frames(pc, core.reg(13)) || go_back(pc, core.reg(13))) return;
  Stack& stack = nest_.back();
  const uint32_t function = functions_.at(pc);
  const Frame& top = stack.frames.back();
  if (function == top.function || function == functions_.at(from)) return;
  // Functions that jump to one another go back to the frame that is there already.
  for (std::size_t i = stack.frames.size() - 1; i > 0 && stack.frames[i].tail; --i) {
    if (stack.frames[i - 1].function != function) continue;
    while (stack.frames.size() > i) pop(stack);
    return;
  }
  Frame frame;
  frame.function = function;
  frame.site = from;
  frame.return_address = top.return_address;
  frame.stack = top.stack;
  frame.tail = true;
  push(stack, frame);
}

void CallTree::entered(const Core& core, unsigned exception, Entry how, uint64_t since) {
  if (nest_.empty()) nest_.push_back(new_stack(functions_.at(core.reg(15))));
  wait_until(since);
  if (how != Entry::preempts && nest_.size() > 1) {
    end(nest_.back());
    nest_.pop_back();
  } else {
    nest_.back().interrupted_at = armv7m::stacked_frame(core);
  }
  const uint32_t name = exception_function(exception);
  nest_.push_back(new_stack(name));
  const uint64_t took = core.cycles() - cycle_;
  cycle_ = core.cycles();
  charge_name(name, took);
  if (counting_) charge({took, 0});
  push_handler(core);
}

void CallTree::returned(const Core& core, unsigned exception) {
  if (nest_.size() < 2) return;
  const uint64_t took = core.cycles() - cycle_;
  cycle_ = core.cycles();
  end(nest_.back());
  charge_name(exception_function(exception), took);
  if (counting_) charge({took, 0});
  nest_.pop_back();
  if (nest_.size() == 1) resume_thread(core);
}

void CallTree::resume_thread(const Core& core) {
  const auto here = [&core](const Stack& stack) {
    return armv7m::is_unstacked(core.reg(13), stack.interrupted_at, core.state().has_fp_context());
  };
  if (here(nest_.front())) return;
  suspended_.push_back(std::move(nest_.front()));
  nest_.clear();
  const auto found = std::find_if(suspended_.begin(), suspended_.end(), here);
  if (found != suspended_.end()) {
    nest_.push_back(std::move(*found));
    suspended_.erase(found);
    return;
  }
  nest_.push_back(new_stack(functions_.at(core.reg(15))));
  if (suspended_.size() <= most_suspended) return;
  end(suspended_.front());
  suspended_.erase(suspended_.begin());
}

void CallTree::finish(const Core& core) {
  wait_until(core.cycles());
  for (Stack& stack : nest_) end(stack);
  for (Stack& stack : suspended_) end(stack);
}

void CallTree::each_path(const Visitor& visit) const {
  std::vector<uint32_t> path;
  for (std::size_t i = 1; i < nodes_.size(); ++i) {
    if (nodes_[i].self.cycles == 0) continue;
    path.clear();
    for (std::size_t at = i; at != 0; at = nodes_[at].parent) path.push_back(nodes_[at].function);
    std::reverse(path.begin(), path.end());
    visit(path, nodes_[i].self);
  }
}

}  // namespace capsoc::trace
