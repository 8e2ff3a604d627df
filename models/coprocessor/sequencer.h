// Sequencer: which stage of the pipeline holds a sample, and when ticks begin and end. It moves no
// data. docs/reference/coprocessor.md, "Time".
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "base/archive.h"

namespace capsoc::coprocessor {

inline constexpr unsigned tick_cycles = 32;  // of a device whose options do not say otherwise
inline constexpr unsigned stage_count = 5;
inline constexpr unsigned load_stage_count = 3;

// From the edge that latches a sample to its results, with ticks of `tick` cycles.
constexpr unsigned latency_of(unsigned tick) {
  return 1 + stage_count * tick;
}
inline constexpr unsigned latency_cycles = latency_of(tick_cycles);

inline constexpr unsigned most_channels = 16;
// Cycles in which the registers take over another channel's context.
inline constexpr unsigned change_cycles = 32;

// Whose context is in the registers, and what software wrote to CHANNEL.
struct Selection {
  unsigned active = 0;
  unsigned window = 0;
  bool hold = true;

  void visit(Archive& archive);
};

class Sequencer {
 public:
  explicit Sequencer(unsigned tick = tick_cycles) : tick_(tick) {}

  void reset() { *this = Sequencer(tick_); }
  // Of the active channel only: a sample of another one still waits.
  void clear_active();
  unsigned tick() const { return tick_; }

  // Latches a sample into the holding register at `cycle`; false: it is full, the sample is lost.
  bool latch(uint64_t cycle, unsigned channel = 0);

  // Asks for the load operation (parameters to coefficients). It waits until no sample is in the
  // pipeline; no sample enters meanwhile.
  void request_load(uint64_t cycle);

  // CHANNEL is written.
  void select(uint64_t cycle, unsigned window, bool hold);
  const Selection& selection() const { return selection_; }
  // Nothing is under way.
  void restore(const Selection& selection);
  unsigned active() const { return selection_.active; }
  // The window shows the registers.
  bool ready() const { return selection_.hold && !waits_for_window() && !changing_; }
  // It did so in the interval before edge `cycle`, too, which is the present one.
  bool was_ready(uint64_t cycle) const { return ready() && changed_at_ != cycle; }

  // A tick boundary lies at or before `cycle`, or the beginning or the end of a change of context.
  // The caller then commits what occupied() and load_stage() name, calls turn(), and starts what
  // they name afterwards.
  bool due(uint64_t cycle) const { return running_ && boundary_ <= cycle; }
  void turn();
  // The channel whose context the last turn() has put away for that of active().
  std::optional<unsigned> left() const { return left_; }
  // The interval after edge `cycle` is the last one of a tick.
  bool turns_after(uint64_t cycle) const { return running_ && boundary_ == cycle + 1; }

  bool occupied(unsigned stage) const { return occupied_[stage]; }
  // The stage of the load operation in the present tick, 0 .. 2.
  std::optional<unsigned> load_stage() const { return load_stage_; }
  // The sample entered T0 at the last boundary.
  bool entered() const { return occupied_[0]; }

  bool any_busy() const {
    return running_ticks() || load_pending_ || held_ || changing_ || wants_change();
  }
  // Busy with the active channel.
  bool busy() const { return running_ticks() || load_pending_ || (held_ && is_own()); }

  // The next cycle at which a result is committed, a load ends or busy changes.
  std::optional<uint64_t> next_event() const;

  void visit(Archive& archive);
  // What only several channels need. The selection is a part of the architectural state; `last` is
  // the number of the last channel.
  void visit_channels(Archive& archive, const Selection& selection, unsigned last);

 private:
  bool pipeline_empty() const;
  bool running_ticks() const { return load_stage_ || !pipeline_empty(); }
  bool is_own() const { return held_channel_ == selection_.active; }
  bool waits_for_window() const {
    return selection_.hold && selection_.window != selection_.active;
  }
  // A held sample.
  bool may_enter() const { return is_own() && !waits_for_window(); }
  bool wants_change() const { return selection_.hold ? waits_for_window() : held_ && !is_own(); }
  void wake(uint64_t cycle);

  unsigned tick_;  // cycles; no state
  bool running_ = false;
  uint64_t boundary_ = 0;  // the next tick boundary, while running
  bool held_ = false;
  unsigned held_channel_ = 0;
  Selection selection_;
  bool changing_ = false;  // it ends at the boundary
  unsigned target_ = 0;
  std::optional<unsigned> left_;
  std::optional<uint64_t> changed_at_;  // the end of the last change; matters at that edge only
  bool load_pending_ = false;
  std::optional<unsigned> load_stage_;
  std::array<bool, stage_count> occupied_{};
};

}  // namespace capsoc::coprocessor
