#include "armv7m/executors/translator/block_plan.h"

#include <algorithm>

#include "armv7m/executors/execute.h"
#include "armv7m/machine.h"

namespace capsoc::armv7m {
namespace {

constexpr uint32_t unaligned_most = 2;  // cycles of the parts of an access beyond the first

/// In no IT block.
bool stands_alone(const Step& step) {
  return step.condition == condition_always && step.it_before == 0 && step.it_after == 0;
}

bool is_translated_fp(const Step& step) {
  if (step.rd == 15) return step.operation != Operation::vmrs || step.condition == condition_always;
  if (is(step, kind::fp_transfer)) {
    const unsigned count = fp_operand::transferred(step);
    const bool from_pc = step.rn == 15 && step.addressing != Addressing::literal;
    return !from_pc && count != 0 && fp_operand::first(step) + count <= fp_operand::registers;
  }
  const bool moves_two = step.operation == Operation::vmov_pair_to_core ||
                         step.operation == Operation::vmov_pair_from_core;
  return !moves_two || fp_operand::pair(step) + 1 < fp_operand::registers;
}

}  // namespace

bool writes_sp(const Step& step) {
  if (step.body != &both<Execute::align_sp> || step.rd != 13 || step.set_flags) return false;
  switch (step.operation) {
    case Operation::add_imm:
    case Operation::sub_imm:
    case Operation::add_reg:
    case Operation::sub_reg:
    case Operation::mov_reg:
    case Operation::mov_high:
    case Operation::add_high:
      return step.shift.type != ShiftType::rrx;
    default:
      return false;
  }
}

bool moves_stack_pointer(const Step& step) {
  constexpr uint32_t psp = 9;
  const unsigned n = step.operation == Operation::mrs ? step.rd : step.rn;
  return (step.encoding & 0xFF) == psp && n < 13 && stands_alone(step);
}

namespace {

/// The special register of MRS and MSR.
uint32_t special_register(const Step& step) {
  return step.unallocated ? 0xFF : step.encoding & 0xFF;
}

}  // namespace

bool reads_masks(const Step& step) {
  const uint32_t which = special_register(step);
  const bool mask_or_control = which >= 16 && which <= 20;
  return step.operation == Operation::mrs && mask_or_control && step.rd < 13 && stands_alone(step);
}

bool masks_interrupts(const Step& step) {
  const uint32_t which = special_register(step);
  const bool primask_or_basepri = which >= 16 && which <= 18;
  const bool writes = step.operation == Operation::msr && primask_or_basepri && step.rn < 13;
  const bool changes = step.operation == Operation::cps && (step.imm & 1) == 0;
  return (writes || changes) && stands_alone(step);
}

bool is_translated(const Step& step) {
  if (writes_sp(step)) return true;
  if (step.body != Execute::unconditional(step)) return false;
  const bool leaves = is(step, kind::any_branch) || step.rd == 15 || step.list.has(15);
  if (leaves && step.it_after != 0) return false;
  switch (step.operation) {
    case Operation::mrs:
    case Operation::msr:
      return moves_stack_pointer(step) || reads_masks(step) || masks_interrupts(step);
    case Operation::cps:
      return masks_interrupts(step);
    case Operation::isb:
      return stands_alone(step);
    case Operation::b:
      return pc_of(step) + step.imm != step.address;
    case Operation::ssat:
    case Operation::usat:
      return false;
    case Operation::nop:
    case Operation::it:
    case Operation::barrier:
    case Operation::fall_through:
      return true;
    default:
      break;
  }
  if (is(step, kind::fp_extension)) return is_translated_fp(step);
  if (step.addressing == Addressing::unprivileged) return false;
  if (is(step, kind::multiple)) return step.list.bits != 0 && !step.list.has(13);
  return is(step, kind::data_processing | kind::any_branch | kind::load | kind::store |
                      kind::dual_load | kind::dual_store | kind::exclusive);
}

bool may_be_left_at(const Step& step) {
  return flag_use(step).exits || !is_translated(step) || writes_sp(step);
}

void BlockPlan::begin(const Step* head, CodePage& page) {
  head_ = head;
  page_ = &page;
  present_ = 0;
  collect_steps();
  visible_ = live_flags(
      steps_.size(), [&](std::size_t i) -> const DecodedOp& { return *steps_[i]; },
      [&](std::size_t i) { return may_be_left_at(*steps_[i]); });
}

/// Most cycles a translated step takes, without branching.
uint32_t BlockPlan::bound_of(const Step& step) const {
  uint32_t bound = step.cycles;
  const uint32_t wait = machine_.memory.map().largest_wait();
  if (is(step, kind::transfer)) bound += wait * std::max(2u, step.list.count()) + unaligned_most;
  if (is(step, kind::fp_transfer)) bound += wait * fp_operand::transferred(step);
  if (is(step, kind::divide)) bound += timing::divide_most;
  if (step.by_operands) bound += timing::long_multiply_most;
  return bound;
}

void BlockPlan::collect_steps() {
  steps_.clear();
  bound_ = timing::most_refill;
  for (const Step* step = head_;; ++step) {
    steps_.push_back(step);
    cut_ = steps_.size();
    if (bound_ + bound_of(*step) > most_cycles) {
      cut_ = steps_.size() - 1;
      return split();
    }
    bound_ += bound_of(*step);
    if (step->operation == Operation::fall_through) return;
    if (step->condition == condition_always && !is_translated(*step)) return;
  }
}

/// Lets the block run into another one where it is cut, or as soon before as one may begin there.
/// The flags must be all the block's own, or none, since the recipe of flags that it got uncomputed
/// can be passed on only as a whole.
void BlockPlan::split() {
  std::size_t place = 0;
  uint8_t own = 0;
  for (std::size_t i = 1; i <= cut_; ++i) {
    const Step& last = *steps_[i - 1];
    const FlagUse effects = flag_use(last);
    own |= effects.sets | effects.kills;
    const bool whole = own == 0 || own == flag::all;
    if (whole && steps_[i]->it_before == 0 && !timing::hangs_on(last.trail, *steps_[i])) place = i;
  }
  if (place == 0) return;
  close_ = closing_step(*steps_[place - 1]);
  Execute::bind(close_);
  steps_.resize(place);
  steps_.push_back(&close_);
  cut_ = steps_.size();
}

std::size_t BlockPlan::end_of_group(std::size_t begin) const {
  std::size_t end = begin;
  const uint8_t condition = steps_[begin]->condition;
  while (end < cut_ && steps_[end]->condition == condition) {
    const Step& step = *steps_[end++];
    if (step.set_flags || step.operation == Operation::cmp_high || ends_block(step)) break;
    if (!is_translated(step)) break;
  }
  return end;
}

uint8_t BlockPlan::visible_behind_group(std::size_t begin, std::size_t end) const {
  uint8_t visible = visible_[end - 1];
  for (std::size_t i = begin; i < end; ++i) {
    if (may_be_left_at(*steps_[i])) return flag::all;
    visible |= flag_use_if_executed(*steps_[i]).reads;
  }
  return visible;
}

int32_t BlockPlan::in_code_page(const void* member) const {
  return static_cast<int32_t>(static_cast<const uint8_t*>(member) -
                              reinterpret_cast<const uint8_t*>(page_));
}

}  // namespace capsoc::armv7m
