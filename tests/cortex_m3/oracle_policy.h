#pragma once

#include <string>

#include "cortex_m3/decoder.h"

/// What of the instruction set Unicorn can judge, and what it gets wrong.
namespace capsoc::cortex_m3::test {

/// Operations left out because the oracle has no system side, and its known faults by name.
inline bool outside_the_oracle(const DecodedOp& op) {
  switch (op.operation) {
    case Operation::svc:
    case Operation::bkpt:
    case Operation::cps:
    case Operation::mrs:
    case Operation::msr:
    case Operation::wfi:
    case Operation::wfe:
    case Operation::sev:
    case Operation::it:  // ITSTATE is not compared here, only by the agreement test
    case Operation::barrier:
    case Operation::isb:
    case Operation::clrex:
    case Operation::coprocessor:  // Unicorn knows coprocessors
      return true;
    default:
      return false;
  }
}

inline bool unpredictable(const DecodedOp& op) {
  const Encoding* e = find_encoding(op.encoding, op.size);
  if (e == nullptr) return false;
  const std::string pattern = e->pattern;
  auto has = [&](char c) { return pattern.find(c) != std::string::npos; };
  auto special = [](unsigned n) { return n == 13 || n == 15; };
  bool multiple = op.operation >= Operation::ldm && op.operation <= Operation::stmdb;
  if (op.size == 4) {
    if ((has('d') && special(op.rd)) || (has('n') && special(op.rn)) ||
        (has('m') && special(op.rm)))
      return true;
    if (has('a') && special(op.ra)) return true;
    if (multiple &&
        ((op.imm & 0xA000) || __builtin_popcount(op.imm) < 2 || (op.imm & 0xC000) == 0xC000))
      return true;
    if (multiple && op.writeback && ((op.imm >> op.rn) & 1)) return true;
    if (op.writeback && (op.rn == op.rd || (has('a') && op.rn == op.ra))) return true;
    // The second register of a pair, and STREX's status register.
    if (has('a') && (op.rd == op.ra || (op.ra == op.rn && op.operation >= Operation::ldr)))
      return true;
    if (op.operation >= Operation::rev && op.operation <= Operation::clz && op.rn != op.rm)
      return true;
    if ((op.operation == Operation::sbfx || op.operation == Operation::ubfx) && op.imm + op.ra > 31)
      return true;
    if ((op.operation == Operation::bfi || op.operation == Operation::bfc) && op.ra < op.imm)
      return true;
    return e->form == Form::rotate && (op.encoding & 0x40);
  }
  if (multiple && op.imm == 0) return true;
  if (op.operation == Operation::stm && ((op.imm >> op.rn) & 1) && (op.imm & ((1u << op.rn) - 1)))
    return true;
  if ((op.operation == Operation::bx || op.operation == Operation::blx) &&
      ((op.encoding & 7) || op.rm == 15))
    return true;
  if (op.operation == Operation::cmp_high || op.operation == Operation::cmp_reg) {
    return (op.encoding >> 8) == 0x45 && (op.rn == 15 || op.rm == 15 || (op.rn < 8 && op.rm < 8));
  }
  // Unicorn keeps SP[1:0]; the architecture does not.
  return (op.operation == Operation::mov_high || op.operation == Operation::add_high) &&
         op.rd == 13;
}

/// The bits the manual writes as (1) and (0) in the encodings that have them.
inline uint32_t with_should_be_bits(const Encoding& e, uint32_t bits) {
  if (e.operation == Operation::tbb || e.operation == Operation::tbh) {
    return (bits & ~0xFF00u) | 0xF000u;
  }
  if (e.length == 16) return e.pattern[13] == 'x' ? bits & ~7u : bits;  // BX, BLX
  const std::string pattern = e.pattern;
  if (pattern.compare(0, 10, "1111001110") == 0 && pattern.compare(16, 4, "10x0") == 0) {
    // Hints and barriers: ones, but for bits 13 and 11 of hints.
    for (unsigned k = 12; k < 32; ++k) {
      const bool zero = k == 18 || (k == 20 && pattern[22] != 'x');
      if (pattern[k] == 'x') bits = zero ? bits & ~(1u << (31 - k)) : bits | 1u << (31 - k);
    }
    return bits;
  }
  if (e.form != Form::none && e.form != Form::plain_x4) return bits;
  for (unsigned k = 16; k < 32; ++k) {
    if (e.pattern[k] == 'x') bits |= 1u << (31 - k);
  }
  return bits;
}

inline bool leaves(const DecodedOp& op) {
  // So does it with what follows a load-exclusive, which ends its translation block.
  bool exclusive = op.operation >= Operation::ldrex && op.operation <= Operation::ldrexh;
  bool conditional = op.operation == Operation::bcond || op.operation == Operation::cbz ||
                     op.operation == Operation::cbnz;
  return exclusive || conditional || (op.operation != Operation::undefined && ends_block(op));
}

/// Known faults of Unicorn 2.0.1 with the Cortex-M3 model.
inline bool known_fault(const DecodedOp& op) {
  uint32_t e = op.encoding;
  if (op.size == 2) {
    return (e & 0xFFF0) == 0xB650  // SETEND executes, though M-profile has none
           || e == 0xBF10;         // YIELD is invalid
  }
  if ((e & 0xFFF000F0u) == 0xE8C00070u) return true;  // STREXD, of A and R profile, executes
  if (op.operation == Operation::nop) return true;    // YIELD.W is invalid
  return (e & 0xFF70F0C0u) == 0xF3200000u;            // SSAT16, USAT16 (DSP extension) execute
}

}  // namespace capsoc::cortex_m3::test
