#include "explain/pending_report.h"

#include <fmt/format.h>

#include <algorithm>

#include "trace/exception_name.h"

namespace capsoc::run {
namespace {

namespace exception = armv7m::exception;
constexpr int lowest = 256;  // nothing is active or masked

std::string named(unsigned number) {
  const std::string name = trace::exception_name(number);
  if (number < exception::first_interrupt) return fmt::format("exception {} ({})", number, name);
  return fmt::format("exception {} ({}, line {})", number, name,
                     number - exception::first_interrupt);
}

/// What keeps exceptions of lower priority from being taken.
struct Obstacle {
  int priority = lowest;
  std::string text = "nothing";
};

/// Of all but the faults themselves, whose handlers are not what was to blame.
Obstacle obstacle_of(const armv7m::State& state) {
  Obstacle worst;
  const auto consider = [&worst](int priority, std::string text) {
    if (priority < worst.priority) worst = {priority, std::move(text)};
  };
  for (unsigned number = 1; number < exception::count; ++number) {
    if (!state.nvic.is_active(number) || exception::is_fault(number)) continue;
    const int priority = state.nvic.priority(number);
    consider(state.scb.group_priority(priority),
             fmt::format("{} runs, whose priority is {:#x}", named(number), priority));
  }
  if (state.basepri != 0)
    consider(state.scb.group_priority(static_cast<int>(state.basepri)),
             fmt::format("BASEPRI is {:#x}", state.basepri));
  if (state.primask != 0) consider(0, "PRIMASK is set (interrupts are off)");
  if (state.faultmask != 0) consider(-1, "FAULTMASK is set");
  return worst;
}

bool is_enabled(const armv7m::State& state, unsigned number) {
  if (number >= exception::mem_manage && number <= exception::usage_fault)
    return state.scb.fault_enabled(number);
  return number < exception::first_interrupt || state.nvic.is_enabled(number);
}

std::string reason(const armv7m::State& state, unsigned number, const Obstacle& obstacle) {
  const int priority = state.nvic.priority(number);
  if (!is_enabled(state, number))
    return number < exception::first_interrupt ? "it is disabled (SHCSR)"
                                               : "it is disabled (NVIC_ISER)";
  if (state.scb.group_priority(priority) >= obstacle.priority)
    return fmt::format("its priority {:#x} does not preempt: {}", priority, obstacle.text);
  return "it is the next one";
}

}  // namespace

std::string describe_pending(const soc::Soc& soc) {
  const armv7m::State& state = soc.cpu.core().state();
  const Obstacle obstacle = obstacle_of(state);
  std::string text;
  for (unsigned number = 2; number < exception::count; ++number)
    if (state.nvic.is_pending(number))
      text += fmt::format("    {}: {}\n", named(number), reason(state, number, obstacle));
  return text;
}

std::string describe_priority(const soc::Soc& soc) {
  return obstacle_of(soc.cpu.core().state()).text;
}

}  // namespace capsoc::run
