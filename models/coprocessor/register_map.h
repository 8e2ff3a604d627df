// Register map of the coprocessor (docs/reference/coprocessor.md). Offsets, fields, reset values
// and the rules of every register are generated from models/registers/capsoc.svd; what follows from
// them is here.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string_view>

#include "capsoc_coprocessor_map.h"

namespace capsoc::coprocessor {

inline constexpr uint32_t flags_all = flag_writable;
inline constexpr unsigned flag_count = 16;
static_assert(flags_all == (1u << flag_count) - 1);
// Those that raise the interrupt of CTRL.IE_ERROR.
inline constexpr uint32_t flags_error =
    flag_clip | flag_sat | flag_zero | flag_early | flag_diverged | flag_config | flag_unsettled;
// Those of the safety mechanisms, in the order of SAFETY's enables, from bit `flags_safety_shift`
// on.
inline constexpr uint32_t flags_safety = flag_parity | flag_misfit | flag_jump | flag_missed;
inline constexpr unsigned flags_safety_shift = 12;
static_assert(flags_safety == (safety_parity | safety_misfit | safety_jump | safety_missed)
                                  << flags_safety_shift);

// Registers with a parity bit: all that the datapath reads. A pair has one, at its LO.
constexpr uint64_t parity_bit(uint32_t offset) {
  return uint64_t{1} << offset / 4;
}
inline constexpr auto parity_registers = [] {
  constexpr uint32_t others[] = {reg_ctrl,  reg_loop,  reg_safety, reg_freq_lo, reg_phase_lo,
                                 reg_au_lo, reg_bu_lo, reg_cu_lo,  reg_av_lo,   reg_bv_lo,
                                 reg_cv_lo, reg_a1,    reg_a2,     reg_b1,      reg_b2,
                                 reg_beta,  reg_phi};
  std::array<uint32_t, std::size(others) + std::size(settings_registers)> all{};
  std::size_t count = 0;
  for (const uint32_t offset : others) all[count++] = offset;
  for (const uint32_t offset : settings_registers) all[count++] = offset;
  return all;
}();
inline constexpr uint64_t parity_bits = [] {
  uint64_t bits = 0;
  for (const uint32_t offset : parity_registers) bits |= parity_bit(offset);
  return bits;
}();

// What a word has in the field at a mask.
constexpr uint32_t field(uint32_t word, uint32_t mask) {
  return (word & mask) / (mask & (0 - mask));
}

// The rule of the register at a byte offset; null: there is none.
constexpr const registers::RegisterRule* find_rule(uint32_t offset) {
  if (offset % 4 != 0 || offset > reg_last || rules[offset / 4].about == nullptr) return nullptr;
  return &rules[offset / 4];
}

// Whether a register stands at a byte offset, for reads and writes alike.
constexpr bool is_register(uint32_t offset) {
  return find_rule(offset) != nullptr;
}

// Why a write has no effect, or not all of it; empty if nothing is wrong. It depends on the write
// alone.
std::string_view write_complaint(uint32_t offset, uint32_t value);

// The 48-bit registers: pairs of an even word LO, an odd word HI.
constexpr bool is_pair(uint32_t offset) {
  const auto* rule = find_rule(offset);
  return rule != nullptr && rule->pair != registers::no_pair;
}
constexpr bool is_pair_high(uint32_t offset) {
  return is_pair(offset) && rules[offset / 4].high;
}
// Its number, a Pair. The offset is one of a pair.
constexpr unsigned pair_index(uint32_t offset) {
  return rules[offset / 4].pair;
}

// `frequency` or `phase` or the weight, sign-extended, as both words.
struct PairWords {
  uint32_t high, low;
};
PairWords pair_words(unsigned pair, int64_t value);
// The same number of its words. Bits of `low` that FREQ and PHASE do not have are ignored.
int64_t pair_value(unsigned pair, PairWords words);

}  // namespace capsoc::coprocessor
