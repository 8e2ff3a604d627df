#include "armv7m/isa/unpredictable.h"

#include "armv7m/isa/decoder.h"

namespace capsoc::armv7m {
namespace {

constexpr UnpredictableCase cases[] = {
#define UNPREDICTABLE(name, section, what, choice) {#name, section, what, choice},
#include "armv7m/isa/unpredictable.def"
#undef UNPREDICTABLE
};

using O = Operation;

bool is_special(unsigned reg) {
  return reg == 13 || reg == 15;
}

/// ADD and SUB of the stack pointer by an immediate or a register, and its comparison.
bool stack_arithmetic_is_allowed(const DecodedOp& op) {
  if (op.rn != 13) return false;
  switch (op.operation) {
    case O::add_imm:
    case O::sub_imm:
    case O::cmp_imm:
    case O::cmn_imm:
      return true;
    case O::add_reg:
    case O::sub_reg:
      return op.rd != 13 || (op.shift.type == ShiftType::lsl && op.shift.amount <= 3);
    case O::cmp_reg:
    case O::cmn_reg:
      return true;
    default:
      return false;
  }
}

bool forbidden_data_registers(const DecodedOp& op, const Encoding& line) {
  const bool moves = op.operation == O::mov_reg && op.shift.amount == 0;
  if (moves && !op.set_flags) return op.rd == 15 || op.rm == 15 || (op.rd == 13 && op.rm == 13);
  if (line.has('m') && is_special(op.rm)) return true;
  if (line.has('a') && is_special(op.ra)) return true;
  const bool stack = stack_arithmetic_is_allowed(op);
  if (line.has('n') && is_special(op.rn) && !stack) return true;
  if (!line.has('d') || is(op, kind::compare)) return false;
  return op.rd == 15 || (op.rd == 13 && !(stack && op.rn == 13));
}

bool forbidden_transfer_registers(const DecodedOp& op, const Encoding& line) {
  const bool literal = op.addressing == Addressing::literal;
  if (literal && (op.writeback || op.operation == O::strd)) return true;
  if (line.has('n') && op.rn == 15 && !literal) return true;
  if (line.has('m') && is_special(op.rm)) return true;
  if (line.has('a') && is_special(op.ra)) return true;
  const bool user = op.addressing == Addressing::unprivileged;
  if (op.operation == O::ldr && !user) return false;
  if (op.operation == O::str && !user) return op.rd == 15;
  return is_special(op.rd);
}

bool forbidden_fp_registers(const DecodedOp& op) {
  const bool pair = op.operation == O::vmov_pair_to_core || op.operation == O::vmov_pair_from_core;
  if (op.operation == O::vmrs) return op.rd == 13;  // R15: the flags
  if (is(op, kind::fp_core)) return is_special(op.rd) || (pair && is_special(op.ra));
  return is(op, kind::fp_store | kind::fp_multiple) && op.rn == 15;
}

/// Registers of the floating-point extension that there are not, or a fraction that is too long.
bool forbidden_fp_operands(const DecodedOp& op, const Encoding& line) {
  constexpr uint32_t of_32_bits = 1u << 7;
  if (is(op, kind::fp_multiple)) {
    const unsigned count = fp_operand::count(op);
    return count == 0 || fp_operand::first(op) + count > fp_operand::registers;
  }
  if (op.operation == O::vmov_pair_to_core || op.operation == O::vmov_pair_from_core)
    return fp_operand::pair(op) + 2 > fp_operand::registers;
  const unsigned less = (op.encoding & 15) << 1 | (op.encoding >> 5 & 1);
  return line.form == Form::fp_fixed && (op.encoding & of_32_bits) == 0 && less > 16;
}

bool forbidden_register(const DecodedOp& op, const Encoding& line) {
  switch (op.operation) {
    case O::tbb:
    case O::tbh:
      return op.rn == 13 || is_special(op.rm);
    case O::mrs:
      return is_special(op.rd);
    case O::msr:
      return is_special(op.rn);
    default:
      break;
  }
  if (is(op, kind::fp_extension)) return forbidden_fp_registers(op);
  if (is(op, kind::multiple)) return op.rn == 15;
  if (is(op, kind::transfer)) return forbidden_transfer_registers(op, line);
  if (is(op, kind::data_processing)) return forbidden_data_registers(op, line);
  return false;
}

bool forbidden_list(const DecodedOp& op) {
  const RegisterList list = op.list;
  if (op.size == 2) return list.bits == 0;
  const bool stores = is(op, kind::multiple_store);
  return list.count() < 2 || list.has(13) || (list.has(14) && list.has(15)) ||
         (stores && list.has(15));
}

bool base_is_transferred(const DecodedOp& op, const Encoding& line) {
  if (!op.writeback) return false;
  if (!is(op, kind::multiple)) return op.rn == op.rd || (line.has('a') && op.rn == op.ra);
  if (!op.list.has(op.rn)) return false;
  // STM T1 may store its base if that is the lowest of the list.
  return op.size == 4 || op.list.has_below(op.rn);
}

bool has_one_destination_for_two(const DecodedOp& op) {
  if (is(op, kind::two_results | kind::dual_load)) return op.rd == op.ra;
  if (op.operation == O::vmov_pair_to_core) return op.rd == op.ra;
  return is(op, kind::exclusive_store) && (op.ra == op.rd || op.ra == op.rn);
}

bool field_is_impossible(const DecodedOp& op) {
  if (op.operation == O::sbfx || op.operation == O::ubfx) return op.field.lsb + op.field.width > 32;
  return (op.operation == O::bfi || op.operation == O::bfc) && op.field.width < 1;
}

/// i:imm3:imm8 of the forms 0x00xy00xy, 0xxy00xy00 and 0xxyxyxyxy with xy = 0.
bool repeats_zero(const DecodedOp& op, const Encoding& line) {
  constexpr uint32_t rotates = 1u << 26 | 1u << 14, repeats = 3u << 12;
  return line.form == Form::modified && (op.encoding & (rotates | 0xFF)) == 0 &&
         (op.encoding & repeats) != 0;
}

std::optional<Unpredictable> wide(const DecodedOp& op, const Encoding& line) {
  if (is(op, kind::multiple) && forbidden_list(op)) return Unpredictable::register_list;
  if (forbidden_register(op, line)) return Unpredictable::special_register;
  const bool preload = op.operation == O::nop && line.operation != O::nop;
  if (preload && (op.writeback || op.addressing == Addressing::unprivileged))
    return Unpredictable::preload_form;
  if (is(op, kind::transfer) && base_is_transferred(op, line))
    return Unpredictable::written_back_base;
  if (forbidden_fp_operands(op, line)) return Unpredictable::fp_operands;
  if (has_one_destination_for_two(op)) return Unpredictable::same_destination;
  if (is(op, kind::reverse) && op.rn != op.rm) return Unpredictable::two_operands_differ;
  if (field_is_impossible(op)) return Unpredictable::bit_field;
  if (repeats_zero(op, line)) return Unpredictable::repeated_zero;
  return std::nullopt;
}

/// The 16-bit encodings that reach all registers; decoding may have made plain ones of them.
bool high_registers_are_forbidden(const DecodedOp& op) {
  const uint32_t opcode = op.encoding >> 7;
  const bool adds = opcode >> 1 == 0x44, compares = opcode >> 1 == 0x45, calls = opcode == 0x8F;
  if (adds) return op.rn == 15 && op.rm == 15;
  if (compares) return op.rn == 15 || op.rm == 15 || (op.rn < 8 && op.rm < 8);
  return calls && op.rm == 15;
}

std::optional<Unpredictable> narrow(const DecodedOp& op, const Encoding& line) {
  if (is(op, kind::multiple) && forbidden_list(op)) return Unpredictable::register_list;
  if (op.operation == O::stm && base_is_transferred(op, line))
    return Unpredictable::written_back_base;
  if (high_registers_are_forbidden(op)) return Unpredictable::high_registers;
  if (op.operation == O::cps && (op.encoding & 3) == 0) return Unpredictable::cps_without_mask;
  if (op.operation != O::it) return std::nullopt;
  const unsigned condition = op.imm >> 4;
  const bool has_else = condition == 14 && __builtin_popcount(op.imm & 15) != 1;
  if (condition == 15 || has_else) return Unpredictable::it_condition;
  return std::nullopt;
}

bool special_name_is_allocated(const DecodedOp& op) {
  const uint32_t mask = op.encoding >> 10 & 3;
  return !op.unallocated && (op.operation == O::mrs || mask == 2 || op.sets_ge);
}

/// CPS that names FAULTMASK where there is none.
bool names_missing_mask(const DecodedOp& op) {
  return op.operation == O::cps && ((op.imm ^ op.encoding) & 1) != 0;
}

std::optional<Unpredictable> in_it_block(const DecodedOp& op) {
  if ((op.it_before & 0xF) == 0) return std::nullopt;
  if (op.size == 2 && op.encoding >> 6 == 0) return Unpredictable::inside_it_block;  // MOVS
  switch (op.operation) {
    case O::it:
    case O::cps:
    case O::cbz:
    case O::cbnz:
    case O::bcond:
      return Unpredictable::inside_it_block;
    default:
      break;
  }
  const bool branches =
      is(op, kind::any_branch) || (ends_block(op) && !is(op, kind::system | kind::none));
  const bool last = (op.it_before & 0xF) == 8;
  if (branches && !last) return Unpredictable::branch_in_it_block;
  return std::nullopt;
}

}  // namespace

const UnpredictableCase& describe(Unpredictable which) {
  return cases[static_cast<unsigned>(which)];
}

std::optional<Unpredictable> unpredictable_encoding(const DecodedOp& op) {
  if (op.operation == O::undefined || op.operation == O::fall_through) return std::nullopt;
  const Encoding& line = line_of(op);
  if ((op.encoding & line.ones) != line.ones || (op.encoding & line.zeros) != 0 ||
      names_missing_mask(op))
    return Unpredictable::should_be_bits;
  const bool special = op.operation == O::mrs || op.operation == O::msr;
  if (special && !special_name_is_allocated(op)) return Unpredictable::special_name;
  if (const auto found = op.size == 4 ? wide(op, line) : narrow(op, line)) return found;
  return in_it_block(op);
}

}  // namespace capsoc::armv7m
