#include "armv7m/executors/translator/step_calls.h"

#include <cstddef>

#include "armv7m/executors/execute.h"
#include "armv7m/machine.h"

namespace capsoc::armv7m {

using namespace asmjit;

namespace {

/// A step that changes masks, and what the run loop does after it, unless an exception may come.
bool mask(Machine& cpu, const Step& step) {
  HostContext& context = cpu.host_context;
  context.count(cpu.state);
  step.body->one(cpu, step);
  const PendingExceptions& pending = cpu.pending;
  const bool may_go_on = !cpu.requests.has(Requests::stops) &&
                         pending.highest_pending(pending.execution_priority()) == 0;
  if (may_go_on)
    cpu.requests.looked_at();
  else
    context.set_left(-1);
  return may_go_on;
}

}  // namespace

void StepCalls::emit(const Step& step) {
  const uint32_t lost = RegisterMap::changed_by_calls();
  registers_.store(lost | 1u << step.rn | 1u << step.rm | 1u << step.ra | 1u << step.rd);
  call(step.body->one, step);
  registers_.load(lost | written_by(step));
}

void StepCalls::emit_masks(const Step& step) {
  registers_.store_all();
  a_.mov(code_.context(&context_.budget), x86::r15);
  call(mask, step);
  a_.mov(x86::r15, code_.context(&context_.budget));
  registers_.load(RegisterMap::changed_by_calls());
}

void StepCalls::call(bool (*one)(Machine&, const Step&), const Step& step) {
  const auto place = static_cast<int32_t>(called_.size() * sizeof(CalledStep));
  called_.push_back({one, &step});
  context_.called = called_.data();
  a_.mov(x86::rax, code_.context(&context_.called));
  a_.lea(x86::rdi, code_.context(&machine_));
  a_.mov(x86::rsi, x86::ptr(x86::rax, place + static_cast<int32_t>(offsetof(CalledStep, step))));
  a_.sub(x86::rsp, 8);  // calls want a stack of 16-byte units
  a_.call(x86::ptr(x86::rax, place, 8));
  a_.add(x86::rsp, 8);
}

}  // namespace capsoc::armv7m
