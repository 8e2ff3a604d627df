// What the register description alone decides about an access. docs/reference/coprocessor.md,
// "Registers".
#include "base/fixed.h"
#include "coprocessor/lms_demodulator.h"
#include "coprocessor/register_map.h"
#include "coprocessor/types.h"

namespace capsoc::coprocessor {
namespace {

// Words of FREQ and PHASE: HI has 32 bits, LO the 16 bits below. Those of a coefficient: HI is the
// number rounded to Q1.31 and saturated, LO what is then missing.
constexpr bool is_split(unsigned pair) {
  return pair == pair_freq || pair == pair_phase;
}

constexpr uint32_t split_low = description::FREQ_LO_VALUE_mask;
static_assert(split_low == 0xFFFF && description::PHASE_LO_VALUE_mask == split_low);

// The report of a write of a value outside the range.
std::string_view range_complaint(uint32_t offset) {
  if (offset == reg_a1 || offset == reg_a2)
    return "a negative amplitude is ignored: write less than 2^31";
  if (offset >= reg_step_au && offset <= reg_step_cv)
    return "a step of 1.0 or more is ignored: write less than 2^31";
  return "a value outside the register's range is ignored";
}

}  // namespace

std::string_view write_complaint(uint32_t offset, uint32_t value) {
  const auto* rule = find_rule(offset);
  if (rule == nullptr) return "";
  if (rule->read_only()) return "write to a read-only register is ignored";
  if (!rule->in_range(value)) return range_complaint(offset);
  if (offset == reg_ctrl) {
    if (value & ctrl_srst) return "";
    if (field(value, ctrl_ref_mask) == 3)
      return "CTRL.REF 3 is reserved: the reference source stays as it was";
  }
  return value & ~rule->about->writable_mask ? rule->reserved_complaint : "";
}

PairWords pair_words(unsigned pair, int64_t value) {
  if (is_split(pair))
    return {static_cast<uint32_t>(static_cast<uint64_t>(value) >> 16),
            static_cast<uint32_t>(value & split_low)};
  bool clamped = false;
  const int32_t high = fixed::saturate32(weight_q31(value), clamped);
  const int32_t low = fixed::saturate32(value - fixed::scale_up(int64_t{high}, 15), clamped);
  return {static_cast<uint32_t>(high), static_cast<uint32_t>(low)};
}

int64_t pair_value(unsigned pair, PairWords words) {
  const int64_t high = static_cast<int32_t>(words.high);
  if (is_split(pair)) return fixed::scale_up(high, 16) + (words.low & split_low);
  return fixed::scale_up(high, 15) + static_cast<int32_t>(words.low);
}

}  // namespace capsoc::coprocessor
