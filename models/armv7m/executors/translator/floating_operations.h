#pragma once

#include <cstdint>
#include <vector>

#include "armv7m/executors/translator/block_edges.h"
#include "armv7m/executors/translator/flag_tracker.h"
#include "armv7m/executors/translator/host_code.h"
#include "armv7m/executors/translator/host_context.h"
#include "armv7m/executors/translator/memory_paths.h"
#include "armv7m/executors/translator/register_map.h"
#include "armv7m/executors/translator/step_calls.h"

namespace capsoc::armv7m {

class Machine;

/// The floating-point extension. Its registers stay in the state.
///
/// The host computes where its result and the guest's flags are known to be the guest's. FPSCR
/// rounds to nearest and does not flush, and its flag of inexact results is set already
/// (HostContext::fp_native). The result is a normal number, well above the smallest one. Then no
/// other flag could be raised. All else is done after the block by a call of the step's executor,
/// which computes in integers.
class FloatingOperations {
 public:
  /// Nothing is owned.
  FloatingOperations(const Machine& machine, const HostContext& context, HostCode& code,
                     RegisterMap& registers, FlagTracker& flags, BlockEdges& edges,
                     MemoryPaths& memory, StepCalls& calls)
      : machine_(machine),
        context_(context),
        code_(code),
        registers_(registers),
        flags_(flags),
        edges_(edges),
        memory_(memory),
        calls_(calls) {}

  void begin();
  /// A step of kind::fp_extension that is_translated().
  void emit(const Step& step);
  /// What the host does not compute, after the block.
  void emit_slow_ways();

 private:
  using Xmm = asmjit::x86::Xmm;
  /// A step that is called where the host cannot compute.
  struct SlowStep {
    Label entry, back;
    const Step* step;
  };

  Mem single(unsigned n) const;
  Mem status() const;
  void check_context(const Step& step);
  void emit_transfer(const Step& step);
  void emit_move(const Step& step);
  void emit_status(const Step& step);
  void emit_native(const Step& step);
  void emit_arithmetic(const Step& step, const Label& otherwise);
  void emit_fused(const Step& step, const Xmm& sum);
  void emit_comparison(const Step& step, const Label& otherwise);
  void emit_to_integer(const Step& step, const Label& otherwise);
  void emit_from_integer(const Step& step);
  void normal_to_eax(const Xmm& number, const Label& otherwise);
  void call(const Step& step);

  const Machine& machine_;
  const HostContext& context_;
  HostCode& code_;
  RegisterMap& registers_;
  FlagTracker& flags_;
  BlockEdges& edges_;
  MemoryPaths& memory_;
  StepCalls& calls_;
  asmjit::x86::Assembler& a_ = code_.assembler();
  std::vector<SlowStep> slow_;
  bool checked_ = false;  // what precedes in the block has used the extension
};

}  // namespace capsoc::armv7m
