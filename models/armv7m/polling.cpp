// Loops that only wait: Core::repeat_turn, Core::skip_turns.
#include <algorithm>
#include <array>
#include <utility>

#include "armv7m/core.h"

namespace capsoc::armv7m {
namespace {

constexpr unsigned longest_turn = 64;  // instructions

/// Operations that leave nothing behind but registers and flags.
bool only_computes(const DecodedOp& op) {
  constexpr uint32_t kinds =
      kind::data_processing | kind::load | kind::dual_load | kind::multiple_load | kind::any_branch;
  return is(op, kinds) || op.operation == Operation::nop || op.operation == Operation::it ||
         op.operation == Operation::barrier;
}

/// What decides on everything that follows, as long as no memory is written.
struct Place {
  explicit Place(const State& state)
      : r(state.r), pc(state.pc), xpsr(state.xpsr()), trail(state.trail) {}
  bool operator==(const Place& other) const {
    return r == other.r && pc == other.pc && xpsr == other.xpsr && trail == other.trail;
  }
  decltype(State::r) r;
  uint32_t pc, xpsr;
  uint16_t trail;
};

}  // namespace

std::optional<Turn> Core::repeat_turn(uint64_t until_cycle) {
  ExecutionCounts* const counts = machine_.counts;
  if (counts == nullptr) return measure_turn(until_cycle);
  counts->begins(machine_.state.pc);
  counts->record(true);
  const std::optional<Turn> turn = measure_turn(until_cycle);
  counts->record(false);
  counts->ends(machine_.state.pc);
  return turn;
}

std::optional<Turn> Core::measure_turn(uint64_t until_cycle) {
  State& state = machine_.state;
  known_turn_.forget();
  if (turns_are_seen()) return std::nullopt;
  const uint64_t accesses = machine_.private_accesses;
  Place begin(state);
  Turn before{state.cycles, state.instructions};
  std::array<uint32_t, KnownTurn::longest> addresses{};
  unsigned length = 0;
  bool again = false;
  for (unsigned n = 0; n < longest_turn; ++n) {
    if (is_interrupted() || machine_.requests.has(Requests::attention)) return std::nullopt;
    if (state.cycles >= until_cycle) return std::nullopt;
    if (length < addresses.size()) addresses[length] = state.pc;
    ++length;
    if (!stepping_.step(only_computes)) return std::nullopt;
    if (machine_.private_accesses != accesses) return std::nullopt;
    if (state.pc != begin.pc) continue;
    const Place place(state);
    if (place == begin) {
      const Turn turn{state.cycles - before.cycles, state.instructions - before.instructions};
      if (length <= addresses.size()) known_turn_.keep(machine_, addresses, length, turn);
      return turn;
    }
    // The entry into a loop may leave other flags or registers than an iteration does, so the
    // measurement may restart once. Not each time: an iteration that calls a function twice passes
    // it twice.
    if (std::exchange(again, true)) continue;
    begin = place;
    before = {state.cycles, state.instructions};
    length = 0;
    if (machine_.counts != nullptr) machine_.counts->record(true);
  }
  return std::nullopt;
}

std::optional<Turn> Core::known_turn() const {
  if (machine_.counts != nullptr || turns_are_seen() || is_interrupted()) return std::nullopt;
  return known_turn_.at(machine_);
}

/// True if single instructions or accesses are observed, or the core runs no program normally.
bool Core::turns_are_seen() const {
  const State& state = machine_.state;
  const Listeners& listeners = machine_.listeners;
  return listeners.sees_instructions || listeners.sees_accesses ||
         machine_.debugging.has_breakpoints() || machine_.memory.is_watched() ||
         state.dwt.observes_steps() || state.sleeping || state.locked_up || !state.thumb;
}

/// True if something else than the next instruction comes first.
bool Core::is_interrupted() const {
  const PendingExceptions& pending = machine_.pending;
  return machine_.state.cycles >= machine_.state.systick.event() ||
         pending.highest_pending(pending.execution_priority()) != 0;
}

void Core::skip_turns(const Turn& turn, uint64_t until_cycle) {
  State& state = machine_.state;
  const uint64_t until = std::min(until_cycle, state.systick.event());
  if (turn.cycles == 0 || until <= state.cycles || is_interrupted()) return;
  const uint64_t turns = (until - state.cycles) / turn.cycles;
  state.cycles += turns * turn.cycles;
  state.instructions += turns * turn.instructions;
  if (machine_.counts != nullptr) machine_.counts->repeat(turns);
}

}  // namespace capsoc::armv7m
