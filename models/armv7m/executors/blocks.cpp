#include "armv7m/executors/blocks.h"

#include <algorithm>
#include <cstring>
#include <vector>

#include "armv7m/executors/block_links.h"
#include "armv7m/executors/execute.h"
#include "armv7m/isa/decoder.h"
#include "armv7m/isa/flag_liveness.h"
#include "armv7m/machine.h"

namespace capsoc::armv7m {
namespace {

constexpr unsigned usual_length = 32;       // a block grows past conditional branches up to here
constexpr unsigned straight_length = 64;    // ... and up to here to the first of them
constexpr uint32_t largest_bound = 0xFFFF;  // of Step::block_cycles

/// True if nothing can see the flags that an operation sets, and there is a form of it without.
bool flags_are_dead(const DecodedOp& op, uint8_t live_behind) {
  return has_form_without_flags(op) && (flag_use(op).sets & live_behind) == 0;
}

}  // namespace

Step closing_step(const Step& last) {
  Step close;
  close.address = next_address(last);
  close.operation = Operation::fall_through;
  close.it_before = close.it_after = last.it_after;
  close.size = 0;
  close.cycles = 0;
  close.cycles_before = static_cast<uint16_t>(last.cycles_before + last.cycles);
  close.instructions_to = last.instructions_to;
  close.trail = last.trail;
  return close;
}

Blocks::Blocks(Machine& machine, Stepping& stepping) : machine_(machine), stepping_(stepping) {
  machine_.block_builder = this;
}

std::unique_ptr<Step[]> Blocks::build(uint32_t address, CodePage& page) const {
  std::vector<Step> steps;
  const Debugging& debugging = machine_.debugging;
  const Memory::Page& memory = machine_.memory.map().page(address);
  const uint32_t wait = memory.wait_states, start = address & ~(Memory::page_size - 1);
  uint8_t it = 0;
  uint32_t cycles = 0, most = timing::most_refill;
  timing::Trail trail = timing::no_trail;  // no block is entered with one that pairs
  bool branches = false;
  while (true) {
    uint32_t offset = address - start;
    if (offset + 2 > Memory::page_size) break;
    if (debugging.has_breakpoints() && debugging.has_breakpoint(address)) break;
    uint16_t first, second = 0;
    std::memcpy(&first, memory.read + offset, 2);
    if (is_wide(first)) {
      if (offset + 4 > Memory::page_size) break;
      std::memcpy(&second, memory.read + offset + 2, 2);
    }
    Step step;
    static_cast<DecodedOp&>(step) = decode(address, first, second, it, machine_.profile);
    if (machine_.counts != nullptr) machine_.counts->decoded(step);
    const bool depends =
        it != 0 || (trail & timing::trail_pairs) != 0 || timing::folds(trail, step);
    if (steps.size() >= (branches ? usual_length : straight_length) && !depends) break;
    Execute::add_cycles(machine_, step, trail, wait);
    uint32_t bound =
        step.cycles + Execute::most_extra_cycles(step, machine_.memory.map().largest_wait());
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
    branches = branches || is(step, kind::branch);
  }
  if (steps.empty()) return nullptr;
  const std::vector<uint8_t> live = live_flags(
      steps.size(), [&](std::size_t i) -> const DecodedOp& { return steps[i]; },
      [](std::size_t) { return false; });
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const bool fuses = i + 1 < steps.size() && machine_.counts == nullptr;
    const bool dead = flags_are_dead(steps[i], live[i]);
    Execute::bind_in_block(steps[i], dead, fuses ? &steps[i + 1] : nullptr);
    if (machine_.counts != nullptr) Execute::bind_counted(steps[i]);
  }
  if (machine_.counts != nullptr) machine_.counts->line(steps.front().address);
  steps.push_back(closing_step(steps.back()));
  Execute::bind(steps.back());
  steps.front().block_cycles = static_cast<uint16_t>(most);
  auto block = std::make_unique<Step[]>(steps.size());
  std::copy(steps.begin(), steps.end(), block.get());
  return block;
}

bool Blocks::fits(const Step& first) const {
  return machine_.state.cycles + first.block_cycles < machine_.block_limit;
}

/// After a trail that pairs a block is worth its memory where another one ended, at the beginning
/// of a page, and not wherever a limit or an exception came between two instructions.
bool Blocks::may_begin(const State& state) {
  return (state.trail & timing::trail_pairs) == 0 || (state.pc & (Memory::page_size - 4)) == 0;
}

const Step* Blocks::begin(uint64_t limit) {
  State& state = machine_.state;
  const bool between = state.it_state == 0 && may_begin(state);
  const Step* op = between ? BlockLinks::find(machine_) : nullptr;
  if (op == nullptr || timing::hangs_on(state.trail, *op)) {
    const uint64_t before = state.instructions;
    stepping_.run(limit);
    stepped_ += state.instructions - before;
    return nullptr;
  }
  machine_.block_limit = limit;
  const bool fits_whole = fits(*op);
  BlockLinks::arrive(state, *op);
  if (__builtin_expect(fits_whole, 1)) return op;
  run_to_limit(op);
  return nullptr;
}

void Blocks::run(uint64_t limit) {
  const Step* op = begin(limit);
  while (op != nullptr) op = op->chain(machine_, op);
}

/// The limit may lie inside the block: looks at the clock before every operation.
void Blocks::run_to_limit(const Step* first) {
  State& state = machine_.state;
  for (const Step* op = first;; ++op) {
    if (state.cycles + op->cycles_before >= machine_.block_limit && op != first) {
      state.cycles += op->cycles_before;
      state.instructions += op[-1].instructions_to;
      state.it_state = op->it_before;
      state.trail = op[-1].trail;
      state.pc = op->address;
      return;
    }
    if (Execute::one(machine_, *op)) continue;
    machine_.account(*op);
    if (machine_.counts != nullptr) machine_.count(*op);
    return machine_.conclude(*op);
  }
}

}  // namespace capsoc::armv7m
