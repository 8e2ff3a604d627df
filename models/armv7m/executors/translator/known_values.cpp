#include "armv7m/executors/translator/known_values.h"

#include "armv7m/executors/translator/block_plan.h"
#include "armv7m/machine.h"

namespace capsoc::armv7m {

void KnownValues::begin() {
  for (unsigned n = 0; n < 16; ++n) values_[n] = machine_.state.r[n];
}

/// What a step writes to its first register.
std::optional<uint32_t> KnownValues::result_of(const Step& step) const {
  std::optional<uint32_t> value;
  const auto known = [&](unsigned n) { return n < 16 ? values_[n] : std::nullopt; };
  switch (step.operation) {
    case Operation::mov_imm:
      value = step.imm;
      break;
    case Operation::mov_reg:
      if (step.shift.amount == 0) value = known(step.rm);
      break;
    case Operation::mov_high:
      if (step.rm != 15) value = known(step.rm);
      break;
    case Operation::movt:
      if (known(step.rd)) value = (*known(step.rd) & 0xFFFF) | step.imm << 16;
      break;
    case Operation::add_imm:
      if (known(step.rn)) value = *known(step.rn) + step.imm;
      break;
    case Operation::sub_imm:
      if (known(step.rn)) value = *known(step.rn) - step.imm;
      break;
    case Operation::add_reg:
    case Operation::add_high:
      if (step.rm != 15 && step.rn != 15 && known(step.rn)) {
        const bool scaled = known(step.rm) && step.shift.type == ShiftType::lsl;
        value = *known(step.rn) + (scaled ? *known(step.rm) << step.shift.amount : 0);
      }
      break;
    case Operation::adr:
      value = (pc_of(step) & ~3u) + step.imm;
      break;
    case Operation::mrs:
      value = machine_.state.psp();
      break;
    case Operation::ldr:
      if (step.addressing == Addressing::literal) {
        uint32_t word = 0;
        if (machine_.memory.debug_read((pc_of(step) & ~3u) + step.imm, &word, 4)) value = word;
      } else if (step.addressing == Addressing::offset && known(step.rn)) {
        // A driver's structure has the address of its device.
        uint32_t word = 0;
        if (machine_.memory.debug_read(*known(step.rn) + step.imm, &word, 4) &&
            MemoryAccess::is_device(word))
          value = word;
      }
      break;
    default:
      break;
  }
  return value;
}

void KnownValues::note(const Step& step) {
  const uint32_t changed = written_by(step);
  const std::optional<uint32_t> value = result_of(step);
  const bool moved_base =
      is(step, kind::transfer | kind::fp_transfer) && !is(step, kind::load | kind::exclusive);
  if (moved_base) return;  // a base that moves stays where it is, roughly
  for (unsigned n = 0; n < 16; ++n) {
    if ((changed >> n & 1) == 0) continue;
    if (is(step, kind::load) && n == step.rn && n != step.rd) continue;
    values_[n] = n == step.rd ? value : std::nullopt;
  }
}

}  // namespace capsoc::armv7m
