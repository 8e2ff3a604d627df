#include "armv7m/executors/translator/transfers.h"

#include <cstring>

#include "armv7m/machine.h"

namespace capsoc::armv7m {

using namespace asmjit;

namespace {

bool is_store(const DecodedOp& op) {
  return is(op, kind::store | kind::dual_store | kind::multiple_store | kind::exclusive_store);
}

}  // namespace

void Transfers::emit_transfer(const Step& step) {
  if (is(step, kind::multiple)) return emit_multiple(step);
  if (is(step, kind::dual_load | kind::dual_store)) return emit_dual(step);
  if (is(step, kind::exclusive)) return emit_exclusive(step);
  emit_single(step);
}

/// A load from a literal pool in the page of the code, whose bytes then are watched as code is.
void Transfers::emit_literal(const Step& step, uint32_t address) {
  const Memory::Page& page = machine_.memory.map().page(address);
  const uint32_t offset = address & (Memory::page_size - 1);
  uint32_t value = 0;
  std::memcpy(&value, page.read + offset, 4);
  plan_.page().code_lines |= 1ull << (offset / 64);
  const Gp to = registers_.destination(step.rd, x86::eax);
  a_.mov(to, value);
  registers_.written(step.rd, to);
  if (page.wait_states == 0) return flags_.keep_host_flags();
  code_.charge(page.wait_states);
}

void Transfers::emit_single(const Step& step) {
  Access access;
  access.store = is_store(step);
  access.rd = step.rd;
  switch (step.operation) {
    case Operation::ldrsb:
      access.is_signed = true;
      [[fallthrough]];
    case Operation::ldrb:
    case Operation::strb:
      access.size = 1;
      break;
    case Operation::ldrsh:
      access.is_signed = true;
      [[fallthrough]];
    case Operation::ldrh:
    case Operation::strh:
      access.size = 2;
      break;
    default:
      break;
  }
  Address address;
  if (step.addressing == Addressing::literal) {
    address.imm = (pc_of(step) & ~3u) + step.imm;
    const bool here = address.imm >> Memory::page_bits == step.address >> Memory::page_bits;
    if (here && access.size == 4 && (address.imm & 3) == 0 && step.rd != 15)
      return emit_literal(step, address.imm);
  } else {
    address.base = step.rn;
    if (step.addressing == Addressing::reg) {
      address.index = step.rm;
      address.shift = step.shift.amount;
    } else if (step.addressing != Addressing::post_indexed) {
      address.imm = step.imm;
    }
  }
  access.aligned =
      address.base == 13 && address.index == FlagOperand::none && (address.imm & 3) == 0;
  const bool to_pc = step.rd == 15;
  const bool indexed =
      step.addressing == Addressing::pre_indexed || step.addressing == Addressing::post_indexed;
  if (to_pc) {
    const int window = memory_.window_of(address, false);
    if (window < 0) return edges_.give_up(step);
    flags_.settle_all();
    const unsigned shift = memory_.through_window(address, access, window, edges_.exit_at(step));
    a_.mov(x86::eax, x86::ptr(x86::rcx, x86::rax, shift, 0, 4));
    edges_.find_entry(step);
    memory_.charge_waits(access, window);
  } else {
    memory_.emit_access(step, access, address);
  }
  if (indexed && (step.rn != step.rd || access.store))
    a_.emit(x86::Inst::kIdAdd, registers_.at(step.rn), Imm(static_cast<int32_t>(step.imm)));
  if (to_pc) edges_.go_to_entry(step, machine_.profile.timing.refill_loaded);
}

/// LDRD, STRD.
void Transfers::emit_dual(const Step& step) {
  Access access;
  access.store = is_store(step);
  access.rd = step.rd;
  access.ra = step.ra;
  Address address;
  if (step.addressing == Addressing::literal) {
    address.imm = (pc_of(step) & ~3u) + step.imm;
  } else {
    address.base = step.rn;
    if (step.addressing != Addressing::post_indexed) address.imm = step.imm;
  }
  memory_.emit_access(step, access, address);
  if (step.writeback)
    a_.emit(x86::Inst::kIdAdd, registers_.at(step.rn), Imm(static_cast<int32_t>(step.imm)));
}

/// LDREX and STREX, which leave a store that fails, or to another address, to C++.
void Transfers::emit_exclusive(const Step& step) {
  const State& state = machine_.state;
  Access access;
  access.store = is_store(step);
  access.rd = step.rd;
  access.exclusive = true;
  if (step.operation == Operation::ldrexb || step.operation == Operation::strexb) access.size = 1;
  if (step.operation == Operation::ldrexh || step.operation == Operation::strexh) access.size = 2;
  Address address;
  address.base = step.rn;
  address.imm = step.imm;
  if (access.store) {
    const Label exit = edges_.exit_at(step);
    a_.cmp(code_.state_byte(&state.exclusive), 0);
    a_.jz(exit);
    memory_.address_to(x86::eax, address, 0);
    a_.cmp(x86::eax, code_.state_word(&state.exclusive_address));
    a_.jne(exit);
    memory_.emit_access(step, access, address);
    a_.mov(code_.state_byte(&state.exclusive), 0);
    const Gp result = registers_.destination(step.ra, x86::eax);
    a_.mov(result, 0);
    return registers_.written(step.ra, result);
  }
  memory_.address_to(x86::eax, address, 0);
  a_.mov(code_.context(&context_.place, 4), x86::eax);
  memory_.emit_access(step, access, address);
  a_.mov(x86::eax, code_.context(&context_.place, 4));
  a_.mov(code_.state_word(&state.exclusive_address), x86::eax);
  a_.mov(code_.state_byte(&state.exclusive), 1);
}

/// LDM, STM, PUSH, POP.
void Transfers::emit_multiple(const Step& step) {
  const uint32_t bytes = 4 * step.list.count();
  const bool down = step.operation == Operation::ldmdb || step.operation == Operation::stmdb;
  Access access;
  access.store = is_store(step);
  access.list = step.list.bits;
  access.aligned = step.rn == 13;
  Address address;
  address.base = step.rn;
  if (down) address.imm = 0u - bytes;
  const Imm moved(static_cast<int32_t>(down ? 0u - bytes : bytes));
  const bool to_pc = !access.store && step.list.has(15);
  if (to_pc) return emit_return(step, access, address, moved);
  memory_.emit_access(step, access, address);
  // A base that is both loaded and written back is unpredictable, and left to stepping.
  if (step.writeback) a_.emit(x86::Inst::kIdAdd, registers_.at(step.rn), moved);
}

/// A load of several registers, the PC last, from a window. The target is read first: if it is not
/// translated, nothing has happened yet.
void Transfers::emit_return(const Step& step, const Access& access, const Address& address,
                            const Imm& moved) {
  const int window = memory_.window_of(address, false);
  if (window < 0) return edges_.give_up(step);
  flags_.settle_all();
  const unsigned shift = memory_.through_window(address, access, window, edges_.exit_at(step));
  const auto last = static_cast<int32_t>(4 * (access.words() - 1));
  a_.lea(x86::rax, x86::ptr(x86::rcx, x86::rax, shift));
  a_.mov(code_.context(&context_.place), x86::rax);
  a_.mov(x86::eax, x86::dword_ptr(x86::rax, last));
  edges_.find_entry(step);
  memory_.charge_waits(access, window);
  a_.mov(x86::rax, code_.context(&context_.place));
  memory_.transfer(access, x86::ptr(x86::rax, 0, 4));
  if (step.writeback) a_.emit(x86::Inst::kIdAdd, registers_.at(step.rn), moved);
  edges_.go_to_entry(step, machine_.profile.timing.refill_loaded);
}

void Transfers::emit_table_branch(const Step& step) {
  Access access;
  access.size = step.operation == Operation::tbb ? 1 : 2;
  Address address;
  address.index = step.rm;
  address.shift = step.operation == Operation::tbb ? 0 : 1;
  if (step.rn == 15) {  // a base of zero and the table's address
    address.imm = pc_of(step);
  } else {
    address.base = step.rn;
  }
  const int window = memory_.window_of(address, false);
  if (window < 0) return edges_.give_up(step);
  flags_.settle_all();
  const unsigned shift = memory_.through_window(address, access, window, edges_.exit_at(step));
  a_.movzx(x86::eax, x86::ptr(x86::rcx, x86::rax, shift, 0, access.size));
  a_.lea(x86::eax, x86::ptr(x86::rax, x86::rax, 0, static_cast<int32_t>(pc_of(step) | 1)));
  edges_.find_entry(step);
  memory_.charge_waits(access, window);
  edges_.go_to_entry(step, machine_.profile.timing.refill_loaded);
}

}  // namespace capsoc::armv7m
