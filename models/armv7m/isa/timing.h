#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "armv7m/isa/op.h"

namespace capsoc::armv7m {

/// Groups of instructions that take the same time on every core, in the order of the instruction
/// set summary of the Cortex-M3 TRM (ARM DDI 0337I, table 3-1).
enum class CycleClass : uint8_t {
  alu,
  multiply_add,
  multiply_long,
  multiply_accumulate_long,
  divide,
  load,
  store,
  store_reg,
  dual,
  multiple,
  branch,
  call,
  table,
  sleep,
  special,  ///< MRS, MSR
  barrier,
  system,
  fp_multiply_add,
  fp_divide,  ///< and the square root
  fp_pair     ///< moves of two registers
};
inline constexpr std::size_t cycle_classes = static_cast<std::size_t>(CycleClass::fp_pair) + 1;

/// The times that one core of the architecture has and another need not have (profile.h), in
/// cycles.
struct Timing {
  /// Of an instruction, by its class; `multiple` takes one more for each register.
  std::array<uint8_t, cycle_classes> cycles;
  uint8_t exception_entry;   ///< to the first instruction of the handler
  uint8_t exception_return;  ///< back to the interrupted program
  uint8_t tail_chain;        ///< from one handler to the next
  uint8_t late_arrival;      ///< a higher priority takes over the stacking that is under way
  // Beyond the branch itself: the target is in a register, or is loaded.
  uint8_t refill_register, refill_loaded;
  /// Refills, pairing and folding of the three-stage pipeline: the time of an instruction depends
  /// on the one before it.
  bool three_stages;
  /// Of SMULL, UMULL, SMLAL and UMLAL (multiply_long_extra).
  bool long_multiply_by_operands;
  /// Saving or restoring the floating-point registers of a context.
  uint8_t fp_state;

  constexpr unsigned of(CycleClass kind) const { return cycles[static_cast<std::size_t>(kind)]; }
};

/// Of the Cortex-M3: instructions as in the table below, exceptions by chapter 5 of the TRM.
inline constexpr Timing cortex_m3_timing{{
                                             1,  // alu
                                             2,  // multiply_add
                                             3,  // multiply_long
                                             4,  // multiply_accumulate_long
                                             2,  // divide
                                             2,  // load
                                             1,  // store
                                             2,  // store_reg
                                             3,  // dual
                                             1,  // multiple
                                             1,  // branch
                                             1,  // call
                                             3,  // table
                                             1,  // sleep
                                             2,  // special
                                             2,  // barrier
                                             2,  // system
                                             0,  // fp_multiply_add: none, as the two after it
                                             0,  // fp_divide: none
                                             0,  // fp_pair: none
                                         },
                                         12,
                                         10,
                                         6,
                                         0,
                                         2,
                                         3,
                                         true,
                                         true,
                                         0};

/// The times of all instructions, to be compared with the TRM. It depends on the instruction, its
/// operands, whether it branches, and the instruction executed right before it; never on how the
/// simulator executes it.
///
/// | TRM, table 3-1            | there          | here                                            |
/// |---------------------------|----------------|-------------------------------------------------|
/// | move, add, shift, logical | 1              | 1                                               |
/// | ... to the PC             | 1 + P          | 1 + 2 (P, below)                                |
/// | MUL                       | 1              | 1                                               |
/// | MLA, MLS                  | 2              | 2                                               |
/// | SMULL, UMULL              | 3 to 5         | 3, and 1 for each operand beyond 16 bits        |
/// | SMLAL, UMLAL              | 4 to 7         | 4, and 1 each, and 1 if both are                |
/// | SDIV, UDIV                | 2 to 12        | 2, and 1 for every 4 bits of quotient           |
/// | LDR, LDREX, STREX         | 2              | 2; 1 behind a load (pairing, below)             |
/// | LDR PC                    | 2 + P, above 4 | 2 + 3                                           |
/// | STR [Rn, #imm]            | 2, "always 1"  | 1: it goes to the write buffer                  |
/// | STR [Rn, Rm]              | 2              | 2; 1 behind a load                              |
/// | LDRD, STRD                | 1 + N          | 3                                               |
/// | LDM, STM, PUSH, POP       | 1 + N          | 1 + N, and 3 with the PC                        |
/// | B<c>, CBZ                 | 1 or 1 + P     | 1, 1 + 1 when taken                             |
/// | B, BL                     | 1 + P          | 1 + 1                                           |
/// | BX, BLX                   | 1 + P          | 1 + 2                                           |
/// | TBB, TBH                  | 2 + P, above 5 | 2 + 1 + 3: the load, the sum, the refill        |
/// | CPS, MRS, MSR             | 1 or 2         | 2                                               |
/// | DMB, DSB, ISB             | 1 + B          | 2                                               |
/// | NOP, SEV, CLREX           | 1              | 1                                               |
/// | IT                        | 1, or folded   | 1; 0 behind a 16-bit instruction (folding)      |
/// | WFI, WFE                  | 1 + W          | 1 + the sleep                                   |
/// | failed condition          | 1              | 1                                               |
///
/// P, the refill of the pipeline, is between 1 and 3 (3.3.1); it depends on where the target lies,
/// how wide it is, and how early its address is known. An earlier issue (DDI 0337E, 18.1) says
/// more: one cycle where the branch holds its target as a number, two where it is in a register. It
/// is longer to a 32-bit instruction that is not aligned, since its halves are in two words: a
/// cycle more here. Where the target is loaded it is three whatever the target (3.3.2, of LDR PC,
/// TBB and TBH). Wait states come on top: of a data access once an access, of a fetch once a word
/// that the instruction begins in. The parts of an unaligned access beyond the first take a cycle
/// each.
///
/// Four things are not known, and not modelled. When LDR Rx, [PC, #imm] pays its cycle for
/// contention with the fetch (3.3.2: "might"). How far the prefetch buffer of three words hides the
/// wait states of fetches, and what rows of unaligned 32-bit instructions cost in it. When a full
/// write buffer delays a store. After which instructions IT does not fold.
///
/// Of the Cortex-M0+, with the fast multiplier and without the single-cycle I/O port: instructions
/// by its TRM (ARM DDI 0484C, table 3-1). A pipeline of two stages: nothing depends on neighbours,
/// and every taken branch takes one cycle beyond its own.
///
/// | TRM, table 3-1            | there   | here                            |
/// |---------------------------|---------|---------------------------------|
/// | move, add, shift, logical | 1       | 1                               |
/// | MOV PC, ADD PC            | 2       | 1 + 1                           |
/// | MULS                      | 1 or 32 | 1                               |
/// | LDR, STR and their like   | 2 or 1  | 2; 1 is of the I/O port         |
/// | LDM, STM, PUSH, POP       | 1 + N   | 1 + N                           |
/// | POP with the PC           | 3 + N   | 1 + N + 2, N counts the PC      |
/// | B<c>                      | 1 or 2  | 1, 1 + 1 when taken             |
/// | B                         | 2       | 1 + 1                           |
/// | BL                        | 3       | 2 + 1                           |
/// | BX, BLX                   | 2       | 1 + 1                           |
/// | CPS                       | 1       | 1                               |
/// | MRS, MSR                  | 3       | 3                               |
/// | DMB, DSB, ISB             | 3       | 3                               |
/// | NOP, SEV, YIELD           | 1       | 1                               |
/// | WFI, WFE                  | 2       | 2 + the sleep                   |
/// | SVC, BKPT                 | depends | 1 + the exception               |
///
/// Exception entry takes 15 cycles (3.6.1). The TRM does not say what the rest takes. Here a return
/// counts as POP of the eight words with the PC, 3 + 8. The way from one handler to the next counts
/// as an entry without its eight words, 15 - 8. LDM and STM end before an interrupt is taken; the
/// chip abandons them, and begins them again.
inline constexpr Timing cortex_m0plus_timing{{
                                                 1,  // alu
                                                 0,  // multiply_add: none, as divide and table
                                                 0,  // multiply_long: none
                                                 0,  // multiply_accumulate_long: none
                                                 0,  // divide: none
                                                 2,  // load
                                                 2,  // store
                                                 2,  // store_reg
                                                 0,  // dual: none
                                                 1,  // multiple
                                                 1,  // branch
                                                 2,  // call
                                                 0,  // table: none
                                                 2,  // sleep
                                                 3,  // special
                                                 3,  // barrier
                                                 1,  // system
                                                 0,  // fp_multiply_add: none
                                                 0,  // fp_divide: none
                                                 0,  // fp_pair: none
                                             },
                                             15,
                                             11,
                                             7,
                                             0,
                                             1,
                                             2,
                                             false,
                                             false,
                                             0};

/// Of the Cortex-M4: as the Cortex-M3, except its multiplier of one cycle (ARM DDI 0439D, tables
/// 3-1 and 3-2).
///
/// | TRM, tables 3-1 and 3-2    | there      | here             |
/// |----------------------------|------------|------------------|
/// | MUL, MLA, MLS              | 1          | 1                |
/// | SMULL, UMULL, SMLAL, UMLAL | 1          | 1                |
/// | SDIV, UDIV                 | 2 to 12    | as the Cortex-M3 |
/// | all of the DSP extension   | 1          | 1                |
/// | IT behind a 16-bit one     | folded     | 0                |
/// | everything else            | as its TRM | as the Cortex-M3 |
///
/// What the Cortex-M3's TRM says of pairing and this one does not repeat is taken to hold: the
/// address that was just computed, and refills by the place of the target.
constexpr Timing make_cortex_m4_timing() {
  Timing made = cortex_m3_timing;
  for (const CycleClass kind :
       {CycleClass::multiply_add, CycleClass::multiply_long, CycleClass::multiply_accumulate_long})
    made.cycles[static_cast<std::size_t>(kind)] = 1;
  made.long_multiply_by_operands = false;
  return made;
}
inline constexpr Timing cortex_m4_timing = make_cortex_m4_timing();

/// Of the Cortex-M4 with FPU: as without, and its instructions by its TRM (ARM DDI 0439D, table
/// 7-1). An exception stacks and unstacks 17 words more where it has to, at one a cycle; so does
/// the first instruction that finds a save due.
///
/// | TRM, table 7-1                         | there   | here    |
/// |----------------------------------------|---------|---------|
/// | VADD, VSUB, VMUL, VNMUL, VABS, VNEG    | 1       | 1       |
/// | VCMP, VCVT                             | 1       | 1       |
/// | VMLA, VFMA and their like              | 3       | 3       |
/// | VDIV, VSQRT                            | 14      | 14      |
/// | VMOV of one register, VMRS, VMSR       | 1       | 1       |
/// | VMOV of two registers                  | 2       | 2       |
/// | VLDR, VSTR of a single, of a double    | 2, 3    | 2, 3    |
/// | VLDM, VSTM, VPUSH, VPOP of N words     | 1 + N   | 1 + N   |
///
/// Not modelled: the cycle more that a result takes to the next instruction if that consumes it,
/// the integer instructions that overlap with VDIV and VSQRT, and pairing of VLDR and VSTR.
constexpr Timing make_cortex_m4f_timing() {
  Timing made = cortex_m4_timing;
  made.cycles[static_cast<std::size_t>(CycleClass::fp_multiply_add)] = 3;
  made.cycles[static_cast<std::size_t>(CycleClass::fp_divide)] = 14;
  made.cycles[static_cast<std::size_t>(CycleClass::fp_pair)] = 2;
  made.fp_state = 17;
  return made;
}
inline constexpr Timing cortex_m4f_timing = make_cortex_m4f_timing();

/// What follows is common to the cores with three stages (Timing::three_stages): pairing, folding
/// and what operands add.
namespace timing {
/// Of every core: the branch holds its target as a number.
constexpr unsigned refill_immediate = 1;
constexpr unsigned most_refill = 3;

/// Most wait states that a memory may have. With them, the time of any instruction and its fetch
/// fits the byte of a decoded instruction; an LDM of 16 registers takes 17 cycles.
constexpr unsigned most_wait_states = 200;

/// Of saving floating-point registers, and how many words these are (Timing::fp_state).
constexpr uint32_t most_fp_save = cortex_m4f_timing.fp_state;

/// Cycles that a refill of one or two cycles takes longer because of its target instruction.
inline unsigned refill_beyond(const DecodedOp& target) {
  return target.refills_late ? 1 : 0;
}

/// Beyond the cycles of the table: operands that need more than half of the multiplier's width.
/// The TRM gives the range and its cause, early termination, but not the thresholds.
constexpr unsigned long_multiply_most = 3;
constexpr unsigned multiply_long_extra(uint32_t n, uint32_t m) {
  return (n >> 16 != 0 ? 1u : 0u) + (m >> 16 != 0 ? 1u : 0u);
}
constexpr unsigned multiply_accumulate_long_extra(uint32_t n, uint32_t m) {
  unsigned wide = multiply_long_extra(n, m);
  return wide == 2 ? 3 : wide;
}
/// Size of a signed operand, for the rules that ask for its significant bits.
constexpr uint32_t magnitude(uint32_t x) {
  return (x >> 31) ? 0u - x : x;
}

/// Beyond the two cycles every division takes: the divider retires about four quotient bits a
/// cycle, so the time follows the difference of the operands' magnitudes.
constexpr unsigned divide_most = 12;
inline unsigned divide_extra(uint32_t dividend, uint32_t divisor) {
  if (divisor == 0 || dividend < divisor) return 0;
  int difference = __builtin_clz(divisor) - __builtin_clz(dividend);
  return 1 + static_cast<unsigned>(difference) / 4;
}

/// Flash words that begin inside the instruction: each costs the region's wait states once.
constexpr unsigned words_fetched(uint32_t address, unsigned size) {
  return ((address & 2) == 0 || size == 4) ? 1 : 0;
}

// Pairing (TRM, 3.3.2 "Load/store timings") and folding.
//
// What an instruction leaves for its successor: nothing (0), or the registers it has just loaded
// or computed, that it was a 16-bit one, that it has branched and the pipeline is still refilled.
// Conditional instructions and branches leave no registers, exceptions, accesses to devices and
// faults nothing at all.
using Trail = uint16_t;
constexpr Trail no_trail = 0, trail_load = 0x100, trail_data = 0x200, trail_refill = 0x400,
                trail_narrow = 0x800;
constexpr Trail trail_pairs = trail_load | trail_data;
/// What some instructions mind that are executed next (minded_by), next to the refill.
constexpr Trail trail_for_neighbours = trail_pairs | trail_narrow;

inline Trail registers_left_by(const DecodedOp& op) {
  if (op.condition != condition_always) return no_trail;
  if (is(op, kind::single_transfer)) {
    // Nothing pipelines after a store or after a base update, and a load to the PC branches.
    // STREX counts as a load.
    if (is(op, kind::store) || op.writeback || op.rd == 15) return no_trail;
    const unsigned loaded = is(op, kind::exclusive_store) ? op.ra : op.rd;
    return static_cast<Trail>(trail_load | loaded << 4 | loaded);
  }
  constexpr uint32_t computes = kind::data_processing & ~uint32_t{kind::compare};
  if (!is(op, computes) || op.rd == 15) return no_trail;
  const bool is_long = is(op, kind::two_results);
  const unsigned second = is_long ? op.ra : op.rd;
  return static_cast<Trail>(trail_data | second << 4 | op.rd);
}

inline Trail trail_of(const DecodedOp& op) {
  const bool loads_pc = is(op, kind::multiple_load) && op.list.has(15);
  const Trail width = op.size == 2 && !loads_pc ? trail_narrow : no_trail;
  return static_cast<Trail>(registers_left_by(op) | width);
}

/// IT can be folded onto a 16-bit instruction in front of it and takes no time then (Cortex-M4 TRM,
/// ARM DDI 0439, table 3-1). The Cortex-M3 TRM only says that there is folding and that
/// ACTLR.DISFOLD switches it off.
inline bool folds(Trail before, const DecodedOp& op) {
  return op.operation == Operation::it && (before & trail_narrow) != 0;
}

/// True when the address of a transfer is made from a register of the trail.
inline bool address_uses(const DecodedOp& op, Trail trail) {
  const unsigned one = trail & 15, other = trail >> 4 & 15;
  const bool table = is(op, kind::table_branch);
  if (op.addressing != Addressing::literal && (op.rn == one || op.rn == other)) return true;
  return (op.addressing == Addressing::reg || table) && (op.rm == one || op.rm == other);
}

/// Cycles to add to an instruction for what was executed right before it.
inline int pairing(Trail before, const DecodedOp& op) {
  const bool transfer = is(op, kind::transfer | kind::table_branch);
  const bool pairs = (before & trail_pairs) != 0;
  if (!pairs || !transfer || op.condition != condition_always) return 0;
  // The register bank has no forwarding path to the address generation.
  if ((before & trail_data) != 0) return address_uses(op, before) ? 1 : 0;
  const bool pipelines = is(op, kind::single_transfer) && !op.writeback &&
                         !address_uses(op, before) && (is(op, kind::store) || op.rd != 15);
  return pipelines && op.cycles == 2 ? -1 : 0;
}

/// The bits of a trail that an instruction's time may depend on, except its refill.
inline Trail minded_by(const DecodedOp& op) {
  if (is(op, kind::transfer | kind::table_branch)) return trail_pairs;
  return op.operation == Operation::it ? trail_narrow : no_trail;
}
/// True when a block that begins with this instruction cannot be entered after this trail: its
/// operations are timed as if there were none.
inline bool hangs_on(Trail before, const DecodedOp& op) {
  return (before & trail_for_neighbours) != 0 && (before & minded_by(op)) != 0;
}
}  // namespace timing
}  // namespace capsoc::armv7m
