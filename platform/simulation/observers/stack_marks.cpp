#include "observers/stack_marks.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "armv7m/exception_frame.h"
#include "base/split.h"
#include "observers/symbols.h"

namespace capsoc::run {
namespace {

constexpr std::size_t most_stacks = 256;  // what a guest can make us keep

}  // namespace

StackMarks::~StackMarks() {
  view_.soc().cpu.core().remove_observer(*this);
}

std::optional<Error> StackMarks::add_limit(const std::string& text) {
  const auto address = address_of(text, "cpu.stack_limit", view_.program());
  if (!address) return Error{address.error()};
  limits_.push_back({address.value(), text});
  return std::nullopt;
}

std::optional<Error> StackMarks::open() {
  for (const std::string& text : split(settings_.limit(), ','))
    if (auto error = add_limit(text)) return error;
  if (limits_.empty() && !settings_.marks()) return std::nullopt;
  view_.soc().cpu.core().add_observer(*this, true, false);
  return std::nullopt;
}

StackMark& StackMarks::main_stack() {
  if (stacks_.empty()) started(view_.soc().cpu.core());
  return stacks_.front();
}

/// The stack that was left at this PSP, before or after an exception's frame was unstacked.
StackMark& StackMarks::process_stack(uint32_t psp) {
  main_stack();
  const bool extended = view_.soc().cpu.core().state().has_fp_context();
  const auto is_here = [psp, extended](const StackMark& stack) {
    if (!stack.process) return false;
    return psp == stack.suspended_at || armv7m::is_unstacked(psp, stack.suspended_at, extended);
  };
  auto found = std::find_if(stacks_.begin(), stacks_.end(), is_here);
  if (found == stacks_.end()) {
    if (stacks_.size() >= most_stacks) return stacks_.back();
    stacks_.push_back({true, psp, psp, 0, psp});
    found = stacks_.end() - 1;
  }
  process_ = static_cast<std::size_t>(found - stacks_.begin());
  return *found;
}

void StackMarks::look(StackMark& stack, uint32_t stack_pointer, uint32_t instruction) {
  if (stack_pointer > stack.top) {
    stack.top = stack_pointer;
    if (stack.lowest == 0) stack.lowest = stack_pointer;
  }
  if (stack_pointer >= stack.lowest) return;
  stack.lowest = stack_pointer;
  stack.instruction = instruction;
  if (!overflow_.empty()) return;
  for (const Limit& limit : limits_) {
    if (stack_pointer >= limit.address || stack.top < limit.address) continue;
    overflow_ = fmt::format("{} is {:#010x}, {} bytes below cpu.stack_limit = {}, at {}",
                            name_of(stack), stack_pointer, limit.address - stack_pointer,
                            limit.name, view_.place(instruction));
    sc_core::sc_stop();
    view_.soc().cpu.core().attention();
    return;
  }
}

void StackMarks::retired(const armv7m::Core& core, const armv7m::DecodedOp& op) {
  const armv7m::State& state = core.state();
  if (!state.uses_psp()) return look(main_stack(), state.r[13], op.address);
  if (process_ == 0) process_stack(state.r[13]);
  look(stacks_[process_], state.r[13], op.address);
}

void StackMarks::entered(const armv7m::Core& core, unsigned, armv7m::Entry, uint64_t) {
  const armv7m::State& state = core.state();
  constexpr uint32_t from_process = 1U << 2;
  if ((state.r[14] & from_process) != 0 && process_ != 0) {
    stacks_[process_].suspended_at = state.psp();
    look(stacks_[process_], state.psp(), state.pc);
  }
  look(main_stack(), state.msp(), state.pc);
}

void StackMarks::returned(const armv7m::Core& core, unsigned) {
  if (core.state().uses_psp()) process_stack(core.state().psp());
}

void StackMarks::started(const armv7m::Core& core) {
  process_ = 0;
  const uint32_t msp = core.state().msp();
  if (stacks_.empty()) stacks_.push_back({false, msp, msp});
}

std::string StackMarks::name_of(const StackMark& mark) const {
  std::string name = mark.process ? "PSP" : "MSP";
  const loader::Symbol* object = view_.program().object_at(mark.top - 4);
  if (object == nullptr || object->is_code) return name;
  return fmt::format("{} ({}, {} bytes)", name, object->name, object->size);
}

void StackMark::visit(Archive& archive) {
  archive("process", process);
  archive("top", top);
  archive("lowest", lowest);
  archive("instruction", instruction);
  archive("suspended_at", suspended_at);
}

void StackMarks::visit_gathered(Archive& archive) {
  archive("stacks", stacks_);
  archive("present", process_);
  archive("overflow", overflow_);
  if (archive.loading() && process_ != 0 && process_ >= stacks_.size())
    archive.refuse("has no such stack");
}

void StackMarks::finish(RunResult& result) {
  for (const StackMark& mark : stacks_)
    result.stacks.push_back({name_of(mark), mark.top, mark.lowest});
}

std::string StackMarks::crash() const {
  return overflow_.empty() ? "" : "the firmware's stack overflowed: " + overflow_;
}

std::optional<Finding> StackMarks::finding() const {
  if (stacks_.empty()) return std::nullopt;
  std::string text;
  for (const StackMark& mark : stacks_)
    text +=
        fmt::format("    {}: {} bytes, {:#010x} down to {:#010x}, at {}\n", name_of(mark),
                    mark.top - mark.lowest, mark.top, mark.lowest, view_.place(mark.instruction));
  return Finding{"the stacks so far", std::move(text)};
}

}  // namespace capsoc::run
