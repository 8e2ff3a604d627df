#include "armv7m/known_turn.h"

#include <cstring>

#include "armv7m/isa/decoder.h"
#include "armv7m/machine.h"

namespace capsoc::armv7m {
namespace {

/// Fields that an operation does not use count as well: a register too many only costs a
/// measurement.
uint32_t registers_named_by(const DecodedOp& op) {
  uint32_t set = 0;
  for (const unsigned n : {op.rd, op.rn, op.rm, op.ra})
    if (n < 15) set |= 1u << n;
  return set;
}

/// Whose outcome the registers they name, the flags and the one load do not decide.
bool depends_on_more(const DecodedOp& op) {
  return is(op, kind::dual_load | kind::multiple_load) || op.operation == Operation::it ||
         op.operation == Operation::tbb || op.operation == Operation::tbh;
}

}  // namespace

bool KnownTurn::Fetched::operator==(const Fetched& other) const {
  return address == other.address && wait_states == other.wait_states &&
         halfwords[0] == other.halfwords[0] && halfwords[1] == other.halfwords[1];
}

bool KnownTurn::Place::operator==(const Place& other) const {
  return pc == other.pc && xpsr == other.xpsr && control == other.control && trail == other.trail &&
         stalled == other.stalled && refilling == other.refilling &&
         private_accesses == other.private_accesses;
}

KnownTurn::Place KnownTurn::place_of(const Machine& machine) {
  const State& state = machine.state;
  return {state.pc,      state.xpsr(),    state.control,           state.trail,
          state.stalled, state.refilling, machine.private_accesses};
}

std::optional<KnownTurn::Fetched> KnownTurn::fetch(const Machine& machine, uint32_t address) {
  const Memory::Page& page = machine.memory.direct(address);
  const uint32_t offset = address & (Memory::page_size - 1);
  Fetched fetched;
  if (page.read == nullptr || offset + sizeof fetched.halfwords > Memory::page_size)
    return std::nullopt;
  fetched.address = address;
  fetched.wait_states = page.wait_states;
  std::memcpy(fetched.halfwords, page.read + offset, sizeof fetched.halfwords);
  return fetched;
}

void KnownTurn::keep(const Machine& machine, const std::array<uint32_t, longest>& addresses,
                     unsigned count, const Turn& turn) {
  forget();
  if (machine.state.it_state != 0 || !machine.memory.is_whole_view()) return;
  named_ = 0;
  unsigned loads = 0;
  for (unsigned n = 0; n < count; ++n) {
    const std::optional<Fetched> fetched = fetch(machine, addresses[n]);
    if (!fetched) return;
    const DecodedOp op =
        decode(fetched->address, fetched->halfwords[0], fetched->halfwords[1], 0, machine.profile);
    if (depends_on_more(op)) return;
    loads += is(op, kind::load) ? 1 : 0;
    named_ |= registers_named_by(op);
    code_[n] = *fetched;
  }
  if (loads != 1) return;
  count_ = count;
  place_ = place_of(machine);
  r_ = machine.state.r;
  turn_ = turn;
}

std::optional<Turn> KnownTurn::at(const Machine& machine) const {
  if (!turn_ || !machine.memory.is_whole_view() || !(place_ == place_of(machine)))
    return std::nullopt;
  for (unsigned n = 0; n < r_.size(); ++n)
    if ((named_ >> n & 1) != 0 && r_[n] != machine.state.r[n]) return std::nullopt;
  for (unsigned n = 0; n < count_; ++n) {
    const std::optional<Fetched> fetched = fetch(machine, code_[n].address);
    if (!fetched || !(*fetched == code_[n])) return std::nullopt;
  }
  return turn_;
}

}  // namespace capsoc::armv7m
