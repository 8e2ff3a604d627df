#pragma once

#include "armv7m/executors/block_links.h"
#include "armv7m/executors/step.h"
#include "armv7m/isa/alu.h"
#include "armv7m/isa/timing.h"
#include "armv7m/machine.h"

namespace capsoc::armv7m {

/// The semantics of the operations, one static function each, in execute_*.cpp.
struct Execute {
  /// Sets the executors of a step from its operation and operands.
  static void bind(Step& step);
  /// For a step of a block: the quickest chain, given what is known about the steps around it.
  /// `flags_dead`: no operation sees the flags it sets; `next` follows it, or is null.
  static void bind_in_block(Step& step, bool flags_dead, const Step* next);
  /// For a step of a block, bound otherwise, while executions are counted.
  static void bind_counted(Step& step);

  static const Executors* data_executors(const DecodedOp& op);
  static const Executors* memory_executors(const DecodedOp& op);
  static const Executors* branch_executors(const DecodedOp& op);
  static const Executors* dsp_executors(const DecodedOp& op);
  static const Executors* fp_executors(const DecodedOp& op);
  static const Executors* system_executors(const DecodedOp& op);
  /// Null where the two do not fuse.
  static Chain compare_and_branch_chain(const DecodedOp& compare, const DecodedOp& branch);
  /// For a direct branch to the page it is in; null for other operations.
  static Chain linked_branch_chain(const DecodedOp& op);

  /// True for a saved ICI state (B1.4.2) before an instruction that cannot have left one: it is no
  /// load or store multiple.
  static bool cannot_continue(const DecodedOp& op) {
    return op.it_before != 0 && (op.it_before & 0xF) == 0 &&
           !is(op, kind::multiple | kind::fp_multiple);
  }

  /// Executes one step, obeying its condition.
  static bool one(Machine& cpu, const Step& op) {
    return op.condition == condition_always ? op.body->one(cpu, op) : conditional(cpu, op);
  }

  /// Completes the time of a decoded step by its predecessor and the wait states of its fetch.
  static void add_cycles(const CoreContext& context, Step& step, uint16_t before,
                         uint32_t wait_states);
  /// Most cycles the step can take beyond DecodedOp::cycles, without device accesses.
  static uint32_t most_extra_cycles(const DecodedOp& op, uint32_t largest_wait);

  static void set_nz(Machine& cpu, uint32_t value) { cpu.state.n = cpu.state.z = value; }
  static uint32_t read(const Machine& cpu, const Step& op, unsigned n) {
    return n == 15 ? pc_of(op) : cpu.state.r[n];
  }

  // Members of the operation families; see the sources for what each does.
  template <typename F, bool immediate, bool shifted, bool flags>
  static bool data(Machine&, const Step&);
  template <ShiftType type, bool flags>
  static bool shift_register(Machine&, const Step&);
  template <typename T, bool is_signed, Addressing mode>
  static bool load_one(Machine&, const Step&);
  template <typename T, Addressing mode>
  static bool store_one(Machine&, const Step&);
  template <unsigned condition>
  static bool branch_if(Machine&, const Step&);
  template <typename T>
  static bool load_exclusive(Machine&, const Step&);
  template <typename T>
  static bool store_exclusive(Machine&, const Step&);
  static bool load_multiple(Machine&, const Step&, uint32_t address, uint32_t written_back);
  static bool store_multiple(Machine&, const Step&, uint32_t address, uint32_t written_back);
  static bool load_singles(Machine&, const Step&, uint32_t address, unsigned count,
                           uint32_t written_back);
  static bool store_singles(Machine&, const Step&, uint32_t address, unsigned count,
                            uint32_t written_back);
  static bool take_branch(Machine&, uint32_t target, unsigned refill = timing::refill_immediate);
  static bool branch_to_self(Machine&, const Step&);
  static bool table_branch(Machine&, const Step&, uint32_t offset, Access access);
  static bool conditional(Machine&, const Step&);
  static bool align_sp(Machine&, const Step&);
  static bool unpredictable(Machine&, const Step&);
  static const Executors* unconditional(const DecodedOp& op);

  // Chains. Each ends in a call that compilers turn into a jump.
  static const Step* go_on(Machine& cpu, const Step* next) { return next->chain(cpu, next); }
  static const Step* follow(Machine&, const Step* branch);
  template <Handler one>
  static const Step* chain(Machine&, const Step*);
  static const Step* conditional_chain(Machine&, const Step*);
  static const Step* counted_chain(Machine&, const Step*);
  template <unsigned condition>
  static const Step* linked_branch(Machine&, const Step*);
  template <bool zero>
  static const Step* linked_compare_zero(Machine&, const Step*);
  static const Step* linked_call(Machine&, const Step*);
  static const Step* linked_branch_to_self(Machine&, const Step*);
  template <Handler compare, unsigned condition>
  static const Step* compare_and_branch(Machine&, const Step*);
  template <Handler compare>
  static Chain compare_and(unsigned condition);

#define OPERATION(name, sort, flags, ends_block) static bool name(Machine&, const Step&);
#include "armv7m/isa/operations.def"
#undef OPERATION
};

template <Handler one>
const Step* Execute::chain(Machine& cpu, const Step* op) {
  if (__builtin_expect(one(cpu, *op), 1)) return go_on(cpu, op + 1);
  return BlockLinks::leave(cpu, *op);
}

/// Takes a branch within its page.
inline const Step* Execute::follow(Machine& cpu, const Step* branch) {
  cpu.state.cycles += branch->cycles_before + branch->cycles + timing::refill_immediate;
  cpu.state.instructions += branch->instructions_to;
  const Step* target = branch->link;
  if (__builtin_expect(
          target != nullptr && cpu.state.cycles + target->block_cycles < cpu.block_limit, 1)) {
    cpu.state.cycles += timing::refill_beyond(*target);
    return target;
  }
  cpu.state.pc = pc_of(*branch) + branch->imm;
  cpu.state.trail = timing::trail_refill;
  return BlockLinks::resolve_link(cpu, *branch);
}

/// Both executors of an operation.
template <Handler one>
inline constexpr Executors both{one, Execute::chain<one>};

}  // namespace capsoc::armv7m
