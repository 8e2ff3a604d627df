#pragma once

#include <cstdint>

namespace capsoc::cortex_m3 {

/// What an instruction does, whatever its encoding; the rows of operations.def.
enum class Operation : uint8_t {
#define OPERATION(name, ends_block) name,
#include "cortex_m3/operations.def"
#undef OPERATION
  count
};

/// Addressing modes of the single and dual transfers.
enum class Addressing : uint8_t { offset, pre_indexed, post_indexed, reg, literal, unprivileged };

/// Shift types in the order of the encoding (DecodeImmShift), RRX being ROR #0.
enum class ShiftType : uint8_t { lsl, lsr, asr, ror, rrx };

constexpr uint8_t condition_always = 14;

/// One instruction after decoding: operands resolved as far as the encoding, its address and the
/// IT state allow. Free of anything an executor adds.
struct DecodedOp {
  uint32_t address = 0;   // of the instruction
  uint32_t imm = 0;       // immediate, expanded; a signed offset in two's complement; register list
  uint32_t encoding = 0;  // 16-bit: the halfword; 32-bit: first halfword in the upper half
  Operation operation{};
  uint8_t condition = condition_always;
  uint8_t it_before = 0;  // ITSTATE under which it was decoded
  uint8_t it_after = 0;   // ITSTATE for the next instruction
  uint8_t size = 2;       // bytes
  uint8_t rd = 0;         // Rd, Rt, RdLo
  uint8_t rn = 0;
  uint8_t rm = 0;
  uint8_t ra = 0;  // Ra, Rt2, RdHi, STREX's Rd; msb, width-1 or saturation position
  ShiftType shift_type = ShiftType::lsl;
  uint8_t shift_n = 0;  // a modified immediate: 1 when its rotation sets the carry
  bool set_flags = false;
  Addressing addressing = Addressing::offset;
  bool writeback = false;
  uint8_t cycles = 1;  // when executed, without what depends on operands, waits and branching
  uint8_t encoding_index_low = 0, encoding_index_high = 0;  // row of isa.def, for disassembly
};
static_assert(sizeof(DecodedOp) <= 32);

/// The address that an instruction reads as PC.
inline uint32_t pc_of(const DecodedOp& op) {
  return op.address + 4;
}
inline uint32_t next_address(const DecodedOp& op) {
  return op.address + op.size;
}

/// True for an operation after which execution may go on elsewhere, or the machine's mode changes.
bool ends_block(const DecodedOp& op);

}  // namespace capsoc::cortex_m3
