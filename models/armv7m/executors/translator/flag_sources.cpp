#include "armv7m/executors/translator/flag_sources.h"

#include "armv7m/isa/alu.h"

namespace capsoc::armv7m {
namespace {

using Of = FlagSource::Of;

AddResult result_of(const FlagSource& source, const State& state, const WordsAside& aside) {
  const uint32_t x = source.x.value(state, aside), y = source.y.value(state, aside);
  switch (source.of) {
    case Of::both:
      return {x & y, false, false};
    case Of::either:
      return {x ^ y, false, false};
    case Of::difference:
      return add_with_carry(x, ~y, true);
    case Of::sum:
      return add_with_carry(x, y, false);
    default:
      return {x, false, false};
  }
}

}  // namespace

uint32_t FlagOperand::registers() const {
  uint32_t set = 0;
  for (const uint8_t n : {base, plus, minus})
    if (n != none) set |= 1u << n;
  return set;
}

uint32_t FlagOperand::value(const State& state, const WordsAside& aside) const {
  const auto word = [&](uint8_t n) {
    return n == none ? 0 : n < none ? state.r[n] : aside[n - first_aside];
  };
  return imm + word(base) + word(plus) - word(minus);
}

bool FlagSources::all_inherited() const {
  return nz.of == Of::inherited && c.of == Of::inherited && v.of == Of::inherited;
}

void FlagSources::settle(State& state, const WordsAside& aside, const FlagSources& left) const {
  const auto source = [](const FlagSource& own, const FlagSource& before) {
    return own.of == Of::inherited ? before : own;
  };
  if (const FlagSource s = source(nz, left.nz); s.pending())
    state.n = state.z = result_of(s, state, aside).value;
  if (const FlagSource s = source(c, left.c); s.pending())
    state.c = result_of(s, state, aside).carry;
  if (const FlagSource s = source(v, left.v); s.pending())
    state.v = result_of(s, state, aside).overflow;
}

}  // namespace capsoc::armv7m
