#pragma once

#include <cstdint>

#include "armv7m/executors/translator/host_code.h"
#include "armv7m/executors/translator/host_context.h"

namespace capsoc::armv7m {

/// True for the guest registers that are in host registers throughout translated code: r0 to r7, SP
/// and LR.
bool pinned(unsigned n);
/// The host register of a guest register that is pinned.
Gp host_register(unsigned n);

/// Where the guest's registers are while translated code runs: ten in host registers, the others in
/// the state. Numbers above 16 name the words put aside (FlagOperand::first_aside), which lie in
/// the context. Writes the moves between these places. rax, rcx and rdx belong to no register and
/// serve as scratch.
class RegisterMap {
 public:
  /// `context` is not owned.
  RegisterMap(HostCode& code, const HostContext& context) : code_(code), context_(context) {}

  /// The value that r15 reads as from here on.
  void set_pc(uint32_t pc) { pc_ = pc; }

  /// The place of a register that is not pinned, or of a word put aside.
  Mem in_state(unsigned n) const;
  /// The place of a register, as an operand of an instruction.
  asmjit::Operand at(unsigned n) const;
  /// A register's value: in its host register, or else loaded to `scratch`.
  Gp read(unsigned n, const Gp& scratch);
  /// Loads a register's value; r15 reads as set_pc() says.
  void read_to(const Gp& to, unsigned n);
  void write(unsigned n, const Gp& from);
  /// Where to compute a register's new value; written() puts it where it belongs.
  Gp destination(unsigned n, const Gp& scratch) const {
    return pinned(n) ? host_register(n) : scratch;
  }
  void written(unsigned n, const Gp& from) {
    if (!pinned(n)) write(n, from);
  }
  /// Loads those of a set of registers that are pinned from the state, or stores them to it. Bit n:
  /// rn.
  void load(uint32_t registers);
  void store(uint32_t registers);
  void load_all() { load(0xFFFF); }
  void store_all() { store(0xFFFF); }
  /// The pinned registers that a function of the host may change.
  static uint32_t changed_by_calls();

 private:
  HostCode& code_;
  const HostContext& context_;
  asmjit::x86::Assembler& a_ = code_.assembler();
  uint32_t pc_ = 0;
};

/// The number of the PC where an operand reads it.
constexpr unsigned literal_pc = 15;

}  // namespace capsoc::armv7m
