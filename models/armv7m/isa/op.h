#pragma once

#include <cstdint>

namespace capsoc::armv7m {

/// What an instruction does, whatever its encoding; the rows of operations.def.
enum class Operation : uint8_t {
#define OPERATION(name, kind, flags, ends_block) name,
#include "armv7m/isa/operations.def"
#undef OPERATION
  count
};
// The order of the rows means nothing: is() and traits() tell what an operation is.
bool operator<(Operation, Operation) = delete;
bool operator<=(Operation, Operation) = delete;
bool operator>(Operation, Operation) = delete;
bool operator>=(Operation, Operation) = delete;

/// What sort of operation it is: the second column of operations.def. A bit each, so that sets of
/// kinds are sums of them.
namespace kind {
enum Kind : uint32_t {
  none = 1 << 0,
  data = 1 << 1,     ///< data processing that writes Rd
  compare = 1 << 2,  ///< data processing for the flags alone
  reverse = 1 << 3,  ///< one operand, encoded twice
  multiply = 1 << 4,
  long_multiply = 1 << 5,
  divide = 1 << 6,
  load = 1 << 7,
  store = 1 << 8,
  dual_load = 1 << 9,
  dual_store = 1 << 10,
  multiple_load = 1 << 11,
  multiple_store = 1 << 12,
  exclusive_load = 1 << 13,
  exclusive_store = 1 << 14,
  branch = 1 << 15,
  table_branch = 1 << 16,
  system = 1 << 17,  ///< changes the mode, the masks or the sleep, or may
  dsp = 1 << 18,     ///< of the DSP extension, with one result
  long_dsp = 1 << 19,
  // Of the floating-point extension
  fp = 1 << 20,       ///< among its registers
  fp_core = 1 << 21,  ///< from them to core registers, or back
  fp_load = 1 << 22,
  fp_store = 1 << 23,
  fp_load_multiple = 1 << 24,
  fp_store_multiple = 1 << 25,
};
constexpr uint32_t dsp_extension = dsp | long_dsp;
constexpr uint32_t two_results = long_multiply | long_dsp;  ///< in RdLo and RdHi
constexpr uint32_t data_processing =
    data | compare | reverse | multiply | long_multiply | divide | dsp_extension;
constexpr uint32_t exclusive = exclusive_load | exclusive_store;
constexpr uint32_t multiple = multiple_load | multiple_store;
constexpr uint32_t single_transfer = load | store | exclusive;
constexpr uint32_t transfer = single_transfer | dual_load | dual_store | multiple;
constexpr uint32_t fp_multiple = fp_load_multiple | fp_store_multiple;
constexpr uint32_t fp_transfer = fp_load | fp_store | fp_multiple;
constexpr uint32_t fp_extension = fp | fp_core | fp_transfer;
constexpr uint32_t any_branch = branch | table_branch;
}  // namespace kind

/// What an operation does to N, Z, C and V: the third column. flag_liveness.h derives from it which
/// flags are live. Those above `moves` can neither fault nor leave their block.
enum class FlagEffect : uint8_t {
  keeps,       ///< neither reads nor sets any
  logical,     ///< sets N and Z, and C where the operand is shifted
  arithmetic,  ///< sets all four
  with_carry,  ///< sets all four, reads C
  shift,       ///< sets N and Z, and C unless the amount is zero
  product,     ///< sets N and Z; no form without flags is kept apart
  compares,    ///< sets all four; its encoding has no S bit
  moves,       ///< keeps, unless it writes the PC; may leave the block if it writes SP
  may_fault,   ///< keeps, if it does not fault
  transfers,   ///< keeps, if it neither faults nor loads the PC
  unknown,     ///< taken to read all of them, and to leave the block
};

/// A row of operations.def.
struct OperationTraits {
  kind::Kind kind;
  FlagEffect flags;
  bool ends_block;  ///< execution may continue elsewhere after it, or the mode changes
};
constexpr OperationTraits operation_traits[] = {
#define OPERATION(name, sort, flags, ends_block) {kind::sort, FlagEffect::flags, ends_block},
#include "armv7m/isa/operations.def"
#undef OPERATION
};
constexpr const OperationTraits& traits(Operation operation) {
  return operation_traits[static_cast<unsigned>(operation)];
}
/// True if the operation is of one of the kinds in the set.
constexpr bool is(Operation operation, uint32_t kinds) {
  return (traits(operation).kind & kinds) != 0;
}

/// Addressing modes of the single and dual transfers.
enum class Addressing : uint8_t { offset, pre_indexed, post_indexed, reg, literal, unprivileged };

/// Shift types in the order of the encoding (DecodeImmShift), RRX being ROR #0.
enum class ShiftType : uint8_t { lsl, lsr, asr, ror, rrx };

/// A shift by a constant; an amount of 0 is none.
struct Shift {
  ShiftType type = ShiftType::lsl;
  uint8_t amount = 0;
};

/// The registers of LDM, STM, PUSH and POP.
struct RegisterList {
  uint16_t bits = 0;  ///< bit n: Rn
  constexpr bool has(unsigned n) const { return (bits >> n & 1) != 0; }
  constexpr bool has_below(unsigned n) const { return (bits & ((1u << n) - 1)) != 0; }
  constexpr unsigned count() const { return static_cast<unsigned>(__builtin_popcount(bits)); }
};

/// Bits of a register: of SBFX, UBFX, BFI and BFC, and with lsb 0 the result of SSAT, USAT and
/// those for halfwords.
struct BitField {
  uint8_t lsb = 0;
  int8_t width = 0;  ///< below 1: an msb below the lsb, UNPREDICTABLE
};

/// Sets of encodings, a bit each: the second column of isa.def.
namespace instruction_set {
enum Set : uint8_t {
  v6m = 1 << 0,   ///< Armv6-M, which Armv7-M contains
  v7m = 1 << 1,   ///< Armv7-M beyond that
  v7em = 1 << 2,  ///< the DSP extension of Armv7-M
  fpv4 = 1 << 3,  ///< its floating-point extension FPv4-SP
  all = v6m | v7m | v7em | fpv4,
};
}  // namespace instruction_set

constexpr uint8_t condition_always = 14;

/// One instruction after decoding: operands resolved as far as the encoding, its address and the
/// IT state allow. Free of anything an executor adds.
struct DecodedOp {
  uint32_t address = 0;  // of the instruction
  uint32_t imm = 0;  // the number: an immediate, expanded, or a signed offset in two's complement
  uint32_t encoding = 0;  // 16-bit: the halfword; 32-bit: first halfword in the upper half
  uint16_t row = 0;       // of isa.def
  RegisterList list;
  Operation operation{};
  uint8_t condition = condition_always;
  uint8_t it_before = 0;  // ITSTATE under which it was decoded
  uint8_t it_after = 0;   // ITSTATE for the next instruction
  uint8_t size = 2;       // bytes
  uint8_t rd = 0;         // Rd, Rt, RdLo
  uint8_t rn = 0;
  uint8_t rm = 0;
  uint8_t ra = 0;  // the second register of its kind: Ra, Rt2, RdHi, STREX's Rd
  BitField field;
  Shift shift;         // of Rm, or of what is saturated
  uint8_t cycles = 1;  // when executed, without what depends on operands, waits and branching
  Addressing addressing = Addressing::offset;
  bool set_flags : 1;
  bool writeback : 1;
  bool carry_from_imm : 1;  // an immediate that was rotated gives its bit 31 to C
  bool unallocated : 1;     // MRS or MSR of a special register that the core does not have
  bool refills_late : 1;    // a refill of one or two cycles takes one more to it
  bool sets_ge : 1;         // MSR that writes APSR.GE
  bool by_operands : 1;     // a long multiplication whose time depends on its operands

  DecodedOp()
      : set_flags(false),
        writeback(false),
        carry_from_imm(false),
        unallocated(false),
        refills_late(false),
        sets_ge(false),
        by_operands(false) {}
};
static_assert(sizeof(DecodedOp) <= 32);

constexpr bool is(const DecodedOp& op, uint32_t kinds) {
  return is(op.operation, kinds);
}

/// The address that an instruction reads as PC.
inline uint32_t pc_of(const DecodedOp& op) {
  return op.address + 4;
}
inline uint32_t next_address(const DecodedOp& op) {
  return op.address + op.size;
}
/// Registers of the floating-point extension. They are in the encoding alone; a double-precision
/// register n is the single-precision ones 2n and 2n + 1.
namespace fp_operand {
/// Of transfers and moves: double-precision registers.
constexpr bool is_double(const DecodedOp& op) {
  return (op.encoding & 1u << 8) != 0;
}
constexpr unsigned d(const DecodedOp& op) {
  return (op.encoding >> 12 & 15) << 1 | (op.encoding >> 22 & 1);
}
constexpr unsigned n(const DecodedOp& op) {
  return (op.encoding >> 16 & 15) << 1 | (op.encoding >> 7 & 1);
}
constexpr unsigned m(const DecodedOp& op) {
  return (op.encoding & 15) << 1 | (op.encoding >> 5 & 1);
}
/// The first single-precision register of a load or store.
constexpr unsigned first(const DecodedOp& op) {
  return is_double(op) ? (op.encoding >> 12 & 15) << 1 : d(op);
}
/// How many of them VLDM and VSTM transfer; the odd word of FLDMX and FSTMX is none.
constexpr unsigned count(const DecodedOp& op) {
  const unsigned words = op.encoding & 0xFF;
  return is_double(op) ? words & ~1u : words;
}
/// How many single-precision registers a load or store transfers.
constexpr unsigned transferred(const DecodedOp& op) {
  if (is(op, kind::fp_multiple)) return count(op);
  return is_double(op) ? 2 : 1;
}
/// Of VMOV between a core register and a single-precision one, or half of a double-precision one.
constexpr unsigned moved(const DecodedOp& op) {
  return is_double(op) ? (op.encoding >> 16 & 15) << 1 | (op.encoding >> 21 & 1) : n(op);
}
/// The first of the two that VMOV exchanges with two core registers.
constexpr unsigned pair(const DecodedOp& op) {
  return is_double(op) ? (op.encoding & 15) << 1 : m(op);
}
constexpr unsigned registers = 32;
}  // namespace fp_operand

/// True where a logical operation that sets the flags gives C a value: its operand was shifted, or
/// is an immediate that was rotated.
inline bool shifter_sets_carry(const DecodedOp& op) {
  return op.shift.amount != 0 || op.carry_from_imm;
}
/// The condition in the encoding of B<c>. Inside an IT block, where it is UNPREDICTABLE, both
/// count.
inline unsigned branch_condition(const DecodedOp& op) {
  return op.encoding >> (op.size == 4 ? 22 : 8) & 15;
}

/// True for an operation after which execution may continue elsewhere, or the machine's mode
/// changes.
bool ends_block(const DecodedOp& op);
/// The registers R0 to R15 that an operation writes if it does not fault, a bit each. Without those
/// that change with the mode: SP by MSR, R0 by a semihosting call, what an exception stacks.
uint32_t written_by(const DecodedOp& op);

}  // namespace capsoc::armv7m
