#pragma once

#include "cortex_m3/alu.h"
#include "cortex_m3/core.h"
#include "cortex_m3/timing.h"

namespace capsoc::cortex_m3 {

/// The semantics of the operations, one static function each, in execute_*.cpp.
struct Execute {
  using Access = Core::Access;

  /// Sets the executors of a step from its operation and operands.
  static void bind(Step& step);
  /// For a step of a block: the quickest chain, given what is known about the steps around it.
  /// `flags_dead`: no operation sees the flags it sets; `next` follows it, or is null.
  static void bind_in_block(Step& step, bool flags_dead, const Step* next);

  static const Executors* data_executors(const DecodedOp& op);
  static const Executors* memory_executors(const DecodedOp& op);
  static const Executors* branch_executors(const DecodedOp& op);
  static const Executors* system_executors(const DecodedOp& op);
  /// Null where the two do not fuse.
  static Chain compare_and_branch_chain(const DecodedOp& compare, const DecodedOp& branch);
  /// For a direct branch to the page it is in; null for other operations.
  static Chain linked_branch_chain(const DecodedOp& op);

  /// True for a saved ICI state (B1.4.2) before an instruction that cannot have left one: it is no
  /// load or store multiple.
  static bool cannot_continue(const DecodedOp& op) {
    const bool multiple = op.operation >= Operation::ldm && op.operation <= Operation::stmdb;
    return op.it_before != 0 && (op.it_before & 0xF) == 0 && !multiple;
  }

  /// Executes one step, obeying its condition.
  static bool one(Core& c, const Step& op) {
    return op.condition == condition_always ? op.body->one(c, op) : conditional(c, op);
  }

  /// Most cycles the step can take beyond DecodedOp::cycles, without device accesses.
  static uint32_t most_extra_cycles(const DecodedOp& op, uint32_t largest_wait);

  static void set_nz(Core& c, uint32_t value) { c.state_.n = c.state_.z = value; }
  static uint32_t read(const Core& c, const Step& op, unsigned n) {
    return n == 15 ? pc_of(op) : c.state_.r[n];
  }

  // Members of the operation families; see the sources for what each does.
  template <typename F, bool immediate, bool shifted, bool flags>
  static bool data(Core&, const Step&);
  template <ShiftType type, bool flags>
  static bool shift_register(Core&, const Step&);
  template <typename T, bool is_signed, Addressing mode>
  static bool load_one(Core&, const Step&);
  template <typename T, Addressing mode>
  static bool store_one(Core&, const Step&);
  template <unsigned condition>
  static bool branch_if(Core&, const Step&);
  template <typename T>
  static bool load_exclusive(Core&, const Step&);
  template <typename T>
  static bool store_exclusive(Core&, const Step&);
  static bool load_multiple(Core&, const Step&, uint32_t address, uint32_t written_back);
  static bool store_multiple(Core&, const Step&, uint32_t address, uint32_t written_back);
  static bool take_branch(Core&, uint32_t target);
  static bool branch_to_self(Core&, const Step&);
  static bool table_branch(Core&, const Step&, uint32_t offset, Access access);
  static bool conditional(Core&, const Step&);
  static bool align_sp(Core&, const Step&);
  static bool unpredictable(Core&, const Step&);
  static const Executors* unconditional(const DecodedOp& op);

  // Chains. Each ends in a call that compilers turn into a jump.
  static const Step* go_on(Core& c, const Step* next) { return next->chain(c, next); }
  static const Step* follow(Core&, const Step* branch);
  template <Handler one>
  static const Step* chain(Core&, const Step*);
  static const Step* conditional_chain(Core&, const Step*);
  template <unsigned condition>
  static const Step* linked_branch(Core&, const Step*);
  template <bool zero>
  static const Step* linked_compare_zero(Core&, const Step*);
  static const Step* linked_call(Core&, const Step*);
  static const Step* linked_branch_to_self(Core&, const Step*);
  template <Handler compare, unsigned condition>
  static const Step* compare_and_branch(Core&, const Step*);
  template <Handler compare>
  static Chain compare_and(unsigned condition);

#define OPERATION(name, ends) static bool name(Core&, const Step&);
#include "cortex_m3/operations.def"
#undef OPERATION
};

template <Handler one>
const Step* Execute::chain(Core& c, const Step* op) {
  if (__builtin_expect(one(c, *op), 1)) return go_on(c, op + 1);
  return c.leave_block(*op);
}

/// Takes a branch within its page.
inline const Step* Execute::follow(Core& c, const Step* branch) {
  c.state_.cycles += branch->cycles_before + branch->cycles + timing::pipeline_refill;
  c.state_.instructions += branch->instructions_to;
  const Step* target = branch->link;
  if (__builtin_expect(target != nullptr && c.state_.cycles + target->block_cycles < c.limit_, 1))
    return target;
  c.state_.pc = pc_of(*branch) + branch->imm;
  return c.resolve_link(*branch);
}

/// Both executors of an operation.
template <Handler one>
inline constexpr Executors both{one, Execute::chain<one>};

}  // namespace capsoc::cortex_m3
