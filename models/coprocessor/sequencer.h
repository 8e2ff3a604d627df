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

class Sequencer {
 public:
  explicit Sequencer(unsigned tick = tick_cycles) : tick_(tick) {}

  void reset() { *this = Sequencer(tick_); }
  unsigned tick() const { return tick_; }

  // Latches a sample into the holding register at `cycle`; false: it is full, the sample is lost.
  bool latch(uint64_t cycle);

  // Asks for the load operation (parameters to coefficients). It waits until no sample is in the
  // pipeline; no sample enters meanwhile.
  void request_load(uint64_t cycle);

  // A tick boundary lies at or before `cycle`. The caller then commits what occupied() and
  // load_stage() name, calls turn(), and starts what they name afterwards.
  bool due(uint64_t cycle) const { return running_ && boundary_ <= cycle; }
  void turn();
  // The interval after edge `cycle` is the last one of a tick.
  bool turns_after(uint64_t cycle) const { return running_ && boundary_ == cycle + 1; }

  bool occupied(unsigned stage) const { return occupied_[stage]; }
  // The stage of the load operation in the present tick, 0 .. 2.
  std::optional<unsigned> load_stage() const { return load_stage_; }
  // The sample entered T0 at the last boundary.
  bool entered() const { return occupied_[0]; }

  bool busy() const { return running_; }

  // The next cycle at which a result is committed, a load ends or busy changes.
  std::optional<uint64_t> next_event() const;

  void visit(Archive& archive);

 private:
  bool pipeline_empty() const;

  unsigned tick_;  // cycles; no state
  bool running_ = false;
  uint64_t boundary_ = 0;  // the next tick boundary, while running
  bool held_ = false;
  bool load_pending_ = false;
  std::optional<unsigned> load_stage_;
  std::array<bool, stage_count> occupied_{};
};

}  // namespace capsoc::coprocessor
