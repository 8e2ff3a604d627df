#include "armv7m/executors/translator/step_calls.h"

#include <cstddef>

#include "armv7m/executors/execute.h"
#include "armv7m/machine.h"

namespace capsoc::armv7m {

using namespace asmjit;

void StepCalls::emit(const Step& step) {
  const auto place = static_cast<int32_t>(called_.size() * sizeof(CalledStep));
  called_.push_back({step.body->one, &step});
  context_.called = called_.data();
  const uint32_t lost = RegisterMap::changed_by_calls();
  registers_.store(lost | 1u << step.rn | 1u << step.rm | 1u << step.ra | 1u << step.rd);
  a_.mov(x86::rax, code_.context(&context_.called));
  a_.lea(x86::rdi, code_.context(&machine_));
  a_.mov(x86::rsi, x86::ptr(x86::rax, place + static_cast<int32_t>(offsetof(CalledStep, step))));
  a_.sub(x86::rsp, 8);  // calls want a stack of 16-byte units
  a_.call(x86::ptr(x86::rax, place, 8));
  a_.add(x86::rsp, 8);
  registers_.load(lost | written_by(step));
}

}  // namespace capsoc::armv7m
