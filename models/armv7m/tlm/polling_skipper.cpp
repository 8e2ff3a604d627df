#include "armv7m/tlm/polling_skipper.h"

#include <algorithm>

namespace capsoc::armv7m {

void PollingSkipper::made(const BusTransfer& transfer, bool is_read, bool steady, uint64_t limit,
                          uint64_t kernel_runs) {
  holds_ = enabled_ && steady && is_read;
  kernel_runs_ = kernel_runs;
  latest_ = transfer;
  latest_steady_ = steady;
  note(transfer, steady, limit);
}

/// What follows from every access, made or repeated.
void PollingSkipper::note(const BusTransfer& transfer, bool steady, uint64_t limit) {
  // What comes after it may change the status again, and be over when the iteration is.
  if (measuring_) {
    steady_until_ = steady ? std::min(steady_until_, limit) : 0;
    read_at_ = {read_at_[1], core_.cycles()};
  }
  seems_to_poll_ =
      enabled_ && !measuring_ && watch_.is_worth_a_look(transfer.address, transfer.value, steady);
}

bool PollingSkipper::skip_known(uint64_t limit) {
  if (!latest_steady_ || !(latest_ == only_read_)) return false;
  const std::optional<Turn> turn = core_.known_turn();
  if (!turn) return false;
  watch_.looked(true);
  core_.skip_turns(*turn, limit);
  return true;
}

std::optional<Turn> PollingSkipper::measure(uint64_t until_cycle) {
  steady_until_ = Core::never;
  read_at_ = {};
  measuring_ = true;
  const std::optional<Turn> turn = core_.repeat_turn(until_cycle);
  measuring_ = false;
  const bool polls = turn && steady_until_ > core_.cycles();
  const bool reads_once = polls &&
                          std::min(read_at_[0], read_at_[1]) < core_.cycles() - turn->cycles &&
                          std::max(read_at_[0], read_at_[1]) >= core_.cycles() - turn->cycles;
  only_read_ = reads_once ? latest_ : std::nullopt;
  if (polls || core_.cycles() < until_cycle) watch_.looked(polls);
  return turn;
}

}  // namespace capsoc::armv7m
