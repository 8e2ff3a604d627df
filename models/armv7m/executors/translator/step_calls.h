#pragma once

#include <vector>

#include "armv7m/executors/translator/host_code.h"
#include "armv7m/executors/translator/host_context.h"
#include "armv7m/executors/translator/register_map.h"

namespace capsoc::armv7m {

class Machine;

/// Steps that translated code leaves to their executors in C++ without leaving itself: those that
/// can neither fault nor leave their block.
class StepCalls {
 public:
  /// Nothing is owned. `context`: gets the table of the steps.
  StepCalls(const Machine& machine, HostContext& context, HostCode& code, RegisterMap& registers)
      : machine_(machine), context_(context), code_(code), registers_(registers) {}

  /// The call. The step finds its operands in the state, where the registers are that the call may
  /// change, too. The code holds no address, so that it is the same in every run. Changes rax, rcx,
  /// rdx and the host's flags. The step must outlive the code.
  void emit(const Step& step);
  /// The call of a step that changes interrupt masks. It is left out of translated code only if an
  /// exception may come now: then the next edge leaves. The block has to end after it.
  void emit_masks(const Step& step);
  /// All code was dropped.
  void forget() { called_.clear(); }

 private:
  const Machine& machine_;
  HostContext& context_;
  HostCode& code_;
  RegisterMap& registers_;
  asmjit::x86::Assembler& a_ = code_.assembler();
  void call(bool (*one)(Machine&, const Step&), const Step& step);

  std::vector<CalledStep> called_;
};

}  // namespace capsoc::armv7m
