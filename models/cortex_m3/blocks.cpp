// The fast executor: basic blocks, cached by page and linked within it.
#include "cortex_m3/blocks.h"

#include <algorithm>
#include <vector>

#include "cortex_m3/core.h"
#include "cortex_m3/decoder.h"
#include "cortex_m3/execute.h"

namespace capsoc::cortex_m3 {
namespace {

constexpr unsigned usual_length = 32;       // a block grows past conditional branches up to here
constexpr uint32_t largest_bound = 0xFFFF;  // of Step::block_cycles

// What an operation does to the flags, for those that can neither fault nor leave the block.
enum : uint8_t { nz = 1, carry = 2, overflow = 4, all = 7 };
struct FlagUse {
  uint8_t reads = all, writes = 0, kills = 0;
  bool removable = false;  // a twin without flags exists
};

FlagUse flag_use(const DecodedOp& op) {
  const Operation o = op.operation;
  if (op.condition != condition_always) return {};
  if (o >= Operation::and_imm && o <= Operation::cmn_reg) {
    unsigned family = (static_cast<unsigned>(o) - static_cast<unsigned>(Operation::and_imm)) % 16;
    constexpr unsigned add = 5, rsb = 9, mov = 10, cmp = 14, adc = 6, sbc = 7;
    bool arithmetic = (family >= add && family <= rsb) || family >= cmp;
    static_assert(
        static_cast<unsigned>(Operation::and_reg) - static_cast<unsigned>(Operation::and_imm) ==
            16 &&
        static_cast<unsigned>(Operation::mov_imm) - static_cast<unsigned>(Operation::and_imm) ==
            mov);
    FlagUse use{0, 0, 0, true};
    if (family == adc || family == sbc) use.reads = carry;
    if (op.shift_type == ShiftType::rrx) use.reads = carry;
    if (op.set_flags) use.writes = use.kills = arithmetic ? all : op.shift_n != 0 ? nz | carry : nz;
    return use;
  }
  if (o >= Operation::lsl_reg && o <= Operation::ror_reg) {
    // An amount of zero keeps the carry.
    return op.set_flags ? FlagUse{carry, nz | carry, nz, true} : FlagUse{0, 0, 0, true};
  }
  if (o >= Operation::adr && o <= Operation::umlal) {
    uint8_t sets = o == Operation::mul && op.set_flags ? nz : 0;
    return {0, sets, sets, false};
  }
  return {};
}

/// Marks the operations whose flags are overwritten before anything can see them.
std::vector<bool> dead_flags(const std::vector<Step>& steps) {
  std::vector<bool> dead(steps.size(), false);
  uint8_t live = all;
  for (std::size_t i = steps.size(); i-- > 0;) {
    FlagUse use = flag_use(steps[i]);
    dead[i] = use.removable && use.writes != 0 && (use.writes & live) == 0;
    live = static_cast<uint8_t>((live & ~use.kills) | use.reads);
  }
  return dead;
}

Step closing_step(uint32_t address, const Step& last) {
  Step close;
  close.address = address;
  close.operation = Operation::fall_through;
  close.it_before = close.it_after = last.it_after;
  close.size = 0;
  close.cycles = 0;
  close.cycles_before = static_cast<uint16_t>(last.cycles_before + last.cycles);
  close.instructions_to = last.instructions_to;
  close.trail = last.trail;
  return close;
}

}  // namespace

/// Completes the time of a decoded step by its predecessor and the wait states of its fetch.
void Core::add_cycles(Step& step, uint16_t before, uint32_t wait_states) {
  const int paired = step.cycles + timing::pairing(before, step);
  const uint32_t fetch = wait_states * timing::words_fetched(step.address, step.size);
  step.cycles = static_cast<uint8_t>(static_cast<uint32_t>(paired) + fetch);
  step.trail = timing::trail_of(step);
}

std::unique_ptr<Step[]> Core::build_block(uint32_t address, CodePage& page) {
  std::vector<Step> steps;
  const Memory::Page& memory = memory_.page(address);
  const uint32_t wait = memory.wait_states, start = address & ~(Memory::page_size - 1);
  uint8_t it = 0;
  uint32_t cycles = 0, most = 0;
  timing::Trail trail = timing::no_trail;  // no block is entered with another one
  while (steps.size() < usual_length || it != 0 || trail != timing::no_trail) {
    uint32_t offset = address - start;
    if (offset + 2 > Memory::page_size) break;
    if (!breakpoints_.empty() && breakpoints_.count(address) != 0) break;
    uint16_t first, second = 0;
    std::memcpy(&first, memory.read + offset, 2);
    if (is_wide(first)) {
      if (offset + 4 > Memory::page_size) break;
      std::memcpy(&second, memory.read + offset + 2, 2);
    }
    Step step;
    static_cast<DecodedOp&>(step) = decode(address, first, second, it);
    add_cycles(step, trail, wait);
    uint32_t bound = step.cycles + Execute::most_extra_cycles(step, memory_.largest_wait());
    if (most + bound > largest_bound) break;
    most += bound;
    step.cycles_before = static_cast<uint16_t>(cycles);
    step.instructions_to = static_cast<uint16_t>(steps.size() + 1);
    Execute::bind(step);
    for (uint32_t at = offset; at < offset + step.size; at += 2)
      page.code_lines |= 1ull << (at / 64);
    cycles += step.cycles;
    address += step.size;
    it = step.it_after;
    trail = step.trail;
    steps.push_back(step);
    if (ends_block(step)) break;
  }
  if (steps.empty()) return nullptr;
  const std::vector<bool> dead = dead_flags(steps);
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const Step* next = i + 1 < steps.size() ? &steps[i + 1] : nullptr;
    Execute::bind_in_block(steps[i], dead[i], next);
  }
  steps.push_back(closing_step(address, steps.back()));
  Execute::bind(steps.back());
  steps.front().block_cycles = static_cast<uint16_t>(most);
  auto block = std::make_unique<Step[]>(steps.size());
  std::copy(steps.begin(), steps.end(), block.get());
  return block;
}

/// The record of a page that may be executed throughout, created on demand; null for the others.
CodePage* Core::executable_page(uint32_t address) {
  unsigned region = address >> 29;
  if (region == 2 || region >= 5) return nullptr;
  if (fast_pages_ == memory_.table()) return memory_.code_page(address);
  if (!mpu_uniform_in_page(address) || !mpu_allows(address, false, true, privileged()))
    return nullptr;
  CodePage* code = memory_.code_page(address);
  if (code != nullptr) memory_.view_page(fast_pages_, address).code = code;
  return code;
}

const Step* Core::find_block() {
  CodePage* code = fast_pages_[state_.pc >> Memory::page_bits].code;
  if (__builtin_expect(code == nullptr, 0)) code = executable_page(state_.pc);
  if (code == nullptr) return nullptr;
  std::unique_ptr<Step[]>& slot = code->blocks[(state_.pc & (Memory::page_size - 1)) >> 1];
  // There is none at a breakpoint, so that every way to it leads past the run loop.
  if (__builtin_expect(slot == nullptr, 0)) slot = build_block(state_.pc, *code);
  return slot.get();
}

/// Where execution goes on at state_.pc, if a block is there already and surely ends before the
/// limit.
inline const Step* Core::next_block() {
  const CodePage* code = fast_pages_[state_.pc >> Memory::page_bits].code;
  if (state_.it_state != 0 || state_.trail != timing::no_trail || code == nullptr) return nullptr;
  const Step* first = code->blocks[(state_.pc & (Memory::page_size - 1)) >> 1].get();
  return first != nullptr && state_.cycles + first->block_cycles < limit_ ? first : nullptr;
}

const Step* Core::leave_block(const Step& op) {
  finish(op);
  return check_ ? nullptr : next_block();
}

/// Behind a branch within its page that has no link yet, or whose target may not fit any more.
const Step* Core::resolve_link(const Step& branch) {
  if (branch.link == nullptr) branch.link = find_block();
  return next_block();
}

void Core::execute_block(uint64_t limit) {
  const Step* op = find_block();
  if (op == nullptr) return step();
  limit_ = limit;
  if (__builtin_expect(state_.cycles + op->block_cycles < limit, 1)) {
    while (op != nullptr) op = op->chain(*this, op);
    return;
  }
  // The budget may end inside: look at the clock before every operation.
  for (const Step* first = op;; ++op) {
    if (state_.cycles + op->cycles_before >= limit && op != first) {
      state_.cycles += op->cycles_before;
      state_.instructions += op[-1].instructions_to;
      state_.it_state = op->it_before;
      state_.trail = op[-1].trail;
      state_.pc = op->address;
      return;
    }
    if (!Execute::one(*this, *op)) break;
  }
  finish(*op);
}

}  // namespace capsoc::cortex_m3
