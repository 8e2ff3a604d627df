#include "armv7m/isa/flag_liveness.h"

namespace capsoc::armv7m {

uint8_t flags_of_condition(unsigned condition) {
  // EQ NE, CS CC, MI PL, VS VC, HI LS, GE LT, GT LE
  constexpr uint8_t read[8] = {
      flag::nz,           flag::c, flag::nz, flag::v, flag::nz | flag::c, flag::nz | flag::v,
      flag::nz | flag::v, 0};
  return read[condition >> 1];
}

FlagUse flag_use_if_executed(const DecodedOp& op) {
  const auto with_s_bit = [&](uint8_t reads, uint8_t sets, uint8_t kills) {
    return op.set_flags ? FlagUse{reads, sets, kills, false} : FlagUse{reads, 0, 0, false};
  };
  const uint8_t rrx = op.shift.type == ShiftType::rrx ? flag::c : 0;
  const uint8_t logical = static_cast<uint8_t>(flag::nz | (shifter_sets_carry(op) ? flag::c : 0));
  const bool to_pc = op.rd == 15 || op.list.has(15);
  switch (traits(op.operation).flags) {
    case FlagEffect::keeps:
      return {0, 0, 0, false};
    case FlagEffect::logical:
      return with_s_bit(rrx, logical, logical);
    case FlagEffect::arithmetic:
      return with_s_bit(rrx, flag::all, flag::all);
    case FlagEffect::with_carry:
      return with_s_bit(flag::c, flag::all, flag::all);
    case FlagEffect::shift:  // an amount of zero keeps the carry
      return with_s_bit(op.set_flags ? flag::c : 0, flag::nz | flag::c, flag::nz);
    case FlagEffect::product:
      return with_s_bit(0, flag::nz, flag::nz);
    case FlagEffect::compares:
      return {0, flag::all, flag::all, false};
    case FlagEffect::moves:
      return to_pc ? FlagUse{} : FlagUse{0, 0, 0, op.rd == 13};
    case FlagEffect::may_fault:
      return {0, 0, 0, true};
    case FlagEffect::transfers:
      return to_pc ? FlagUse{} : FlagUse{0, 0, 0, true};
    case FlagEffect::unknown:
      break;
  }
  return {};
}

FlagUse flag_use(const DecodedOp& op) {
  FlagUse use = flag_use_if_executed(op);
  if (op.condition == condition_always) return use;
  if (op.condition > condition_always) return {};
  use.reads |= flags_of_condition(op.condition);
  use.kills = 0;
  return use;
}

bool has_form_without_flags(const DecodedOp& op) {
  switch (traits(op.operation).flags) {
    case FlagEffect::logical:
    case FlagEffect::arithmetic:
    case FlagEffect::with_carry:
    case FlagEffect::shift:
      return op.set_flags;
    default:
      return false;
  }
}

}  // namespace capsoc::armv7m
