#pragma once

#include <asmjit/x86.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "armv7m/executors/step.h"

namespace capsoc::armv7m {

struct State;

using Gp = asmjit::x86::Gp;
using Mem = asmjit::x86::Mem;
using Label = asmjit::Label;
using Cond = asmjit::x86::CondCode;

// Operands as asmjit has them.
asmjit::Imm immediate_of(uint32_t value);
/// The memory at, and for LEA the value of, base + displacement and base + (index << shift) +
/// displacement, in 64 bits.
Mem sum_of(const Gp& base, int32_t displacement);
Mem sum_of(const Gp& base, const Gp& index, unsigned shift = 0, int32_t displacement = 0);

/// The host code of one block while it is written: the assembler, what all code addresses, the
/// block's constants and, if wanted, its listing. rbp holds the address of the guest's state, r15
/// HostContext::budget. One object serves all blocks, one after the other: begin(), instructions
/// through assembler(), embed_constants(), then bytes() if complete().
class HostCode {
 public:
  /// `state`: of the guest. Not owned. Other members of the machine are addressed relative to it,
  /// so they must lie within 2 GiB of it.
  explicit HostCode(const State& state) : state_(state) {}
  HostCode(const HostCode&) = delete;
  HostCode& operator=(const HostCode&) = delete;

  /// Drops the previous block's code and its labels.
  void begin();
  asmjit::x86::Assembler& assembler() { return assembler_; }
  /// The block cannot be used: an internal check failed.
  void fail() { errors_.any = true; }

  /// A word, a byte, or `size` bytes of the state or of what lies near it.
  Mem state_word(const void* member) const;
  Mem state_byte(const void* member) const;
  Mem context(const void* member, unsigned size = 8) const;
  /// 8 bytes next to the code with this value.
  Mem constant(uint64_t value);

  /// Takes cycles from the budget. A register: in its lower half; it is cleared by it.
  void charge(const Gp& cycles);
  void charge(uint64_t cycles);

  /// Writes the constants, aligned to 8 bytes. Once, after the instructions.
  void embed_constants();
  /// True if every instruction was encoded and every label is bound.
  bool complete() const { return !errors_.any && !holder_.hasUnresolvedLinks(); }
  std::size_t size() const { return holder_.textSection()->bufferSize(); }
  const uint8_t* bytes() const { return holder_.textSection()->data(); }
  std::size_t offset_of(const Label& label) const { return holder_.labelOffset(label); }

  /// Whether a listing is written, too. Before begin().
  void list(bool wanted) { listing_wanted_ = wanted; }
  /// The guest's instruction; the library lists what it assembles after this line.
  void list_step(const Step& step);
  void list_line(const char* text);
  /// Of the last block; empty if none was wanted.
  std::string listing() const { return {log_.data(), log_.dataSize()}; }

 private:
  struct Constant {
    Label label;
    uint64_t value;
  };
  class Errors : public asmjit::ErrorHandler {
   public:
    void handleError(asmjit::Error, const char*, asmjit::BaseEmitter*) override { any = true; }
    bool any = false;
  };

  void begin_listing();

  const State& state_;
  Errors errors_;
  asmjit::CodeHolder holder_;
  asmjit::StringLogger log_;
  bool listing_wanted_ = false;
  asmjit::x86::Assembler assembler_;
  std::vector<Constant> constants_;
};

}  // namespace capsoc::armv7m
