#include "coprocessor/sequencer.h"

namespace capsoc::coprocessor {

bool Sequencer::latch(uint64_t cycle) {
  if (held_) return false;
  held_ = true;
  if (!running_) boundary_ = cycle + 1;
  running_ = true;
  return true;
}

void Sequencer::request_load(uint64_t cycle) {
  load_pending_ = true;
  if (!running_) boundary_ = cycle + 1;
  running_ = true;
}

bool Sequencer::pipeline_empty() const {
  for (bool stage : occupied_)
    if (stage) return false;
  return true;
}

void Sequencer::turn() {
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
    } else if (held_ && !load_pending_) {
      occupied_[0] = true;
      held_ = false;
    }
  }
  running_ = held_ || load_pending_ || load_stage_ || !pipeline_empty();
  if (running_) boundary_ += tick_;
}

std::optional<uint64_t> Sequencer::next_event() const {
  if (!running_) return std::nullopt;
  for (unsigned stage = stage_count; stage-- > 0;)
    if (occupied_[stage]) return boundary_ + uint64_t{stage_count - 1 - stage} * tick_;
  if (load_stage_) return boundary_ + uint64_t{load_stage_count - 1 - *load_stage_} * tick_;
  // Nothing has started: the boundary is the start of a tick.
  return boundary_ + uint64_t{load_pending_ ? load_stage_count : stage_count} * tick_;
}

}  // namespace capsoc::coprocessor
