#include "armv7m/executors/execute.h"

namespace capsoc::armv7m {
namespace {

bool goes_to_itself(const DecodedOp& op) {
  return pc_of(op) + op.imm == op.address;
}

}  // namespace

bool Execute::take_branch(Machine& cpu, uint32_t target, unsigned refill) {
  cpu.refill(refill);
  return cpu.branch_to(target);
}

bool Execute::b(Machine& cpu, const Step& op) {
  return take_branch(cpu, pc_of(op) + op.imm);
}

// `b .`: how a handler that gives up ends.
bool Execute::branch_to_self(Machine& cpu, const Step& op) {
  if (cpu.state.in_fault_handler()) cpu.spin_in_fault();
  return take_branch(cpu, op.address);
}

template <unsigned condition>
bool Execute::branch_if(Machine& cpu, const Step& op) {
  return cpu.state.condition_passed(condition) ? take_branch(cpu, pc_of(op) + op.imm) : true;
}

const Executors* Execute::branch_executors(const DecodedOp& op) {
  static constexpr const Executors* conditional_branches[16] = {&both<branch_if<0>>,
                                                                &both<branch_if<1>>,
                                                                &both<branch_if<2>>,
                                                                &both<branch_if<3>>,
                                                                &both<branch_if<4>>,
                                                                &both<branch_if<5>>,
                                                                &both<branch_if<6>>,
                                                                &both<branch_if<7>>,
                                                                &both<branch_if<8>>,
                                                                &both<branch_if<9>>,
                                                                &both<branch_if<10>>,
                                                                &both<branch_if<11>>,
                                                                &both<branch_if<12>>,
                                                                &both<branch_if<13>>,
                                                                &both<b>,
                                                                &both<b>};
  switch (op.operation) {
    case Operation::bcond:
      return conditional_branches[branch_condition(op)];
    case Operation::b:
      return goes_to_itself(op) ? &both<branch_to_self> : &both<b>;
#define ONE(name)       \
  case Operation::name: \
    return &both<name>;
      // A table of cases, which the formatter indents again each time.
      // clang-format off
    ONE(bl)
    ONE(bx)
    ONE(blx)
    ONE(cbz)
    ONE(cbnz)
    ONE(tbb)
    ONE(tbh)
      // clang-format on
#undef ONE
    default:
      return nullptr;
  }
}

template <unsigned condition>
const Step* Execute::linked_branch(Machine& cpu, const Step* op) {
  return cpu.state.condition_passed(condition) ? follow(cpu, op) : go_on(cpu, op + 1);
}

template <bool zero>
const Step* Execute::linked_compare_zero(Machine& cpu, const Step* op) {
  return (cpu.state.r[op->rn] == 0) == zero ? follow(cpu, op) : go_on(cpu, op + 1);
}

const Step* Execute::linked_branch_to_self(Machine& cpu, const Step* op) {
  return cpu.state.in_fault_handler() ? chain<branch_to_self>(cpu, op) : follow(cpu, op);
}

const Step* Execute::linked_call(Machine& cpu, const Step* op) {
  cpu.state.r[14] = next_address(*op) | 1;
  return follow(cpu, op);
}

Chain Execute::linked_branch_chain(const DecodedOp& op) {
  static constexpr Chain conditional_branches[16] = {
      linked_branch<0>,  linked_branch<1>,  linked_branch<2>,  linked_branch<3>,
      linked_branch<4>,  linked_branch<5>,  linked_branch<6>,  linked_branch<7>,
      linked_branch<8>,  linked_branch<9>,  linked_branch<10>, linked_branch<11>,
      linked_branch<12>, linked_branch<13>, linked_branch<14>, linked_branch<14>};
  uint32_t target = pc_of(op) + op.imm;
  if (target >> Memory::page_bits != op.address >> Memory::page_bits) return nullptr;
  switch (op.operation) {
    case Operation::b:
      return goes_to_itself(op) ? linked_branch_to_self : linked_branch<14>;
    case Operation::bcond:
      return conditional_branches[branch_condition(op)];
    case Operation::cbz:
      return linked_compare_zero<true>;
    case Operation::cbnz:
      return linked_compare_zero<false>;
    case Operation::bl:
      return linked_call;
    default:
      return nullptr;
  }
}

bool Execute::bl(Machine& cpu, const Step& op) {
  cpu.state.r[14] = next_address(op) | 1;
  return take_branch(cpu, pc_of(op) + op.imm);
}

bool Execute::bx(Machine& cpu, const Step& op) {
  cpu.refill(cpu.profile.timing.refill_register);
  return cpu.interwork_to(read(cpu, op, op.rm));
}

// BLXWritePC: unlike BX it never returns from an exception (A2.3.1).
bool Execute::blx(Machine& cpu, const Step& op) {
  uint32_t target = read(cpu, op, op.rm);
  cpu.state.r[14] = next_address(op) | 1;
  cpu.state.thumb = (target & 1) != 0;
  if (!cpu.state.thumb) cpu.requests.raise(Requests::changed);
  return take_branch(cpu, target, cpu.profile.timing.refill_register);
}

bool Execute::cbz(Machine& cpu, const Step& op) {
  return cpu.state.r[op.rn] == 0 ? take_branch(cpu, pc_of(op) + op.imm) : true;
}

bool Execute::cbnz(Machine& cpu, const Step& op) {
  return cpu.state.r[op.rn] != 0 ? take_branch(cpu, pc_of(op) + op.imm) : true;
}

bool Execute::tbb(Machine& cpu, const Step& op) {
  uint32_t offset = 0;
  Access a = cpu.memory.load<uint8_t>(op, read(cpu, op, op.rn) + cpu.state.r[op.rm], offset);
  return table_branch(cpu, op, offset, a);
}

bool Execute::tbh(Machine& cpu, const Step& op) {
  uint32_t offset = 0;
  Access a =
      cpu.memory.load<uint16_t>(op, read(cpu, op, op.rn) + (cpu.state.r[op.rm] << 1), offset);
  return table_branch(cpu, op, offset, a);
}

bool Execute::table_branch(Machine& cpu, const Step& op, uint32_t offset, Access access) {
  if (access == Access::fault) return false;
  return take_branch(cpu, pc_of(op) + 2 * offset, cpu.profile.timing.refill_loaded);
}

}  // namespace capsoc::armv7m
