#include "coprocessor/sequencer.h"

namespace capsoc::coprocessor {

bool Sequencer::latch(uint64_t cycle, unsigned channel) {
  if (held_) return false;
  held_ = true;
  held_channel_ = channel;
  wake(cycle);
  return true;
}

void Sequencer::request_load(uint64_t cycle) {
  load_pending_ = true;
  wake(cycle);
}

void Sequencer::select(uint64_t cycle, unsigned window, bool hold) {
  selection_.window = window;
  selection_.hold = hold;
  wake(cycle);
}

void Sequencer::restore(const Selection& selection) {
  reset();
  selection_ = selection;
}

void Sequencer::clear_active() {
  Sequencer cleared(tick_);
  cleared.selection_ = selection_;
  cleared.held_ = held_ && !is_own();
  cleared.held_channel_ = held_channel_;
  *this = cleared;
}

bool Sequencer::pipeline_empty() const {
  for (bool stage : occupied_)
    if (stage) return false;
  return true;
}

// At rest it decides at every edge, and something has happened at `cycle`.
void Sequencer::wake(uint64_t cycle) {
  if (running_ || !(load_pending_ || (held_ && may_enter()) || wants_change())) return;
  boundary_ = cycle + 1;
  running_ = true;
}

void Sequencer::turn() {
  left_.reset();
  if (changing_) {
    changing_ = false;
    left_ = selection_.active;
    selection_.active = target_;
    changed_at_ = boundary_;
    running_ = false;
    return wake(boundary_);
  }
  const bool had_tick = running_ticks();
  for (unsigned stage = stage_count - 1; stage > 0; --stage)
    occupied_[stage] = occupied_[stage - 1];
  occupied_[0] = false;
  if (load_stage_) {
    if (++*load_stage_ == load_stage_count) load_stage_.reset();
  }
  if (!load_stage_) {
    if (load_pending_ && pipeline_empty()) {
      load_stage_ = 0;
      load_pending_ = false;
    } else if (held_ && !load_pending_ && may_enter()) {
      occupied_[0] = true;
      held_ = false;
    }
  }
  if (running_ticks()) {
    boundary_ += tick_;
    return;
  }
  running_ = false;
  if (had_tick) return wake(boundary_);
  if (!wants_change()) return;
  changing_ = running_ = true;
  target_ = waits_for_window() ? selection_.window : held_channel_;
  boundary_ += change_cycles;
}

std::optional<uint64_t> Sequencer::next_event() const {
  if (!running_ || !any_busy()) return std::nullopt;
  for (unsigned stage = stage_count; stage-- > 0;)
    if (occupied_[stage]) return boundary_ + uint64_t{stage_count - 1 - stage} * tick_;
  if (load_stage_) return boundary_ + uint64_t{load_stage_count - 1 - *load_stage_} * tick_;
  if (changing_ || !(load_pending_ || (held_ && may_enter()))) return boundary_;
  // Nothing has started: the boundary is the start of a tick.
  return boundary_ + uint64_t{load_pending_ ? load_stage_count : stage_count} * tick_;
}

}  // namespace capsoc::coprocessor
