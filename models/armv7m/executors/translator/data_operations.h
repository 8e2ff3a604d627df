#pragma once

#include <cstdint>

#include "armv7m/executors/translator/block_edges.h"
#include "armv7m/executors/translator/block_plan.h"
#include "armv7m/executors/translator/flag_tracker.h"
#include "armv7m/executors/translator/host_code.h"
#include "armv7m/executors/translator/register_map.h"

namespace capsoc::armv7m {

/// The data-processing instructions (kind::data_processing), none of which writes the PC here. Uses
/// rax, rcx and rdx, and announces to the FlagTracker where the flags are that are wanted.
class DataOperations {
 public:
  /// `state`: of the guest, to whose C the shifter's carry goes. Not owned.
  DataOperations(const State& state, const BlockPlan& plan, HostCode& code, RegisterMap& registers,
                 FlagTracker& flags, BlockEdges& edges)
      : state_(state),
        plan_(plan),
        code_(code),
        registers_(registers),
        flags_(flags),
        edges_(edges) {}

  void emit_data(const Step& step);
  /// Computes R13 from other registers (writes_sp()); with bits set that SP does not have, it is
  /// left to C++.
  void emit_sp(const Step& step);
  /// The second operand: a number, a register, or a shifted one in `scratch`. `carry`: the
  /// shifter's carry goes to the state.
  asmjit::Operand second_operand(const Step& step, const Gp& scratch, bool carry);

 private:
  using HostFlags = FlagTracker::HostFlags;

  // data_operations.cpp
  void emit_logical(const Step& step);
  void emit_test(const Step& step);
  void emit_difference(const Step& step, bool reversed);
  void emit_sum(const Step& step);
  void emit_with_carry(const Step& step);
  void emit_high(const Step& step);
  bool store_shifter_carry(const Step& step) const;
  void shift_constant(const Gp& to, unsigned rm, Shift shift, bool carry);
  static Gp shift_place(const Step& step);
  static bool works_in_state(const Step& step, const asmjit::Operand& second);
  static bool leaves_host_flags(const Shift& shift);

  // data_bits.cpp
  void emit_shift_by_register(const Step& step);
  void emit_shift_with_carry(const Step& step);
  void emit_extract(const Step& step);
  void emit_extend(const Step& step);
  void emit_insert(const Step& step);
  void emit_reverse(const Step& step);

  // data_multiply.cpp
  void emit_multiply(const Step& step);
  void emit_long_multiply(const Step& step);
  void charge_operands(const Step& step, bool is_signed, bool accumulate);
  void emit_divide(const Step& step);

  const State& state_;
  const BlockPlan& plan_;
  HostCode& code_;
  RegisterMap& registers_;
  FlagTracker& flags_;
  BlockEdges& edges_;
  asmjit::x86::Assembler& a_ = code_.assembler();
};

}  // namespace capsoc::armv7m
