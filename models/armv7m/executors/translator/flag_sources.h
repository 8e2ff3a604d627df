#pragma once

#include <array>
#include <cstdint>

#include "armv7m/state.h"

namespace capsoc::armv7m {

/// Operands of flags that are not computed yet, kept from registers that were written since. The
/// last ones are for those that a block leaves to the next one.
constexpr unsigned words_aside = 10, words_left = 2;
using WordsAside = std::array<uint32_t, words_aside>;

/// A number that can be computed from registers as they are, and from words put aside
/// (HostContext::aside), which stand after the registers.
struct FlagOperand {
  static constexpr uint8_t none = 16, first_aside = 17;
  uint8_t base = none, plus = none, minus = none;
  uint32_t imm = 0;

  static FlagOperand reg(unsigned n) { return {static_cast<uint8_t>(n), none, none, 0}; }
  static FlagOperand number(uint32_t value) { return {none, none, none, value}; }
  static FlagOperand aside(unsigned n) { return reg(first_aside + n); }
  bool is_register() const { return base != none && plus == none && minus == none && imm == 0; }
  bool is_number() const { return base == none && plus == none && minus == none; }
  /// The registers and words put aside that it needs, a bit each.
  uint32_t registers() const;
  uint32_t value(const State& state, const WordsAside& aside) const;
  bool operator==(const FlagOperand& o) const {
    return base == o.base && plus == o.plus && minus == o.minus && imm == o.imm;
  }
};

/// Where a flag is to be had from.
struct FlagSource {
  enum class Of : uint8_t {
    memory,      ///< the state has it
    inherited,   ///< as it was when the block was entered: the state's, or HostContext::recipe's
    host,        ///< the host's carry or overflow, as it stands: for the next instruction only
    value,       ///< N and Z of x
    both,        ///< N and Z of x & y
    either,      ///< N and Z of x ^ y
    difference,  ///< of x - y
    sum,         ///< of x + y
  };
  Of of = Of::memory;
  FlagOperand x, y;
  uint32_t serial = 0;  ///< sources of one operation have one number

  bool pending() const { return of >= Of::value; }
  uint32_t registers() const { return pending() ? x.registers() | y.registers() : 0; }
  bool operator==(const FlagSource& o) const { return of == o.of && x == o.x && y == o.y; }
};

/// N and Z together, C, and V.
struct FlagSources {
  FlagSource nz, c, v;

  bool any_pending() const { return nz.pending() || c.pending() || v.pending(); }
  bool all_inherited() const;
  uint32_t registers() const { return nz.registers() | c.registers() | v.registers(); }
  bool operator==(const FlagSources& o) const { return nz == o.nz && c == o.c && v == o.v; }
  /// Writes what is pending into the state. `left` is what the block before left: it counts where
  /// a flag is inherited.
  void settle(State& state, const WordsAside& aside, const FlagSources& left) const;
};

}  // namespace capsoc::armv7m
