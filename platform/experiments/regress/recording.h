// What a scenario does at the pins, edge by edge, and what the model answers: the stimulus of a
// regression without the model, to be compared with many versions of the RTL.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "coprocessor/coprocessor.h"
#include "coprocessor/device.h"

namespace capsoc::regress {

struct Event {
  enum class Kind : uint8_t {
    sample,  ///< u, v, flag: clip, answer: latched
    write,   ///< offset, value, answer: no error
    read,    ///< offset, value: what it must show, answer: no error
    reset,   ///< of the pin, after the edge
    level,   ///< from this edge on: flag: interrupt, answer: idle
    look,    ///< offset: first of `look_offsets.size()` words in Recording::words
  };
  Kind kind;
  uint64_t edge;
  uint32_t offset_or_u = 0, value_or_v = 0;
  bool flag = false, answer = false;
  uint8_t strobes = coprocessor::all_strobes;  ///< of a write
};

/// Registers whose reading has no side effect and whose value a commit may change.
extern const std::array<uint32_t, 46> look_offsets;

struct Recording {
  std::vector<Event> events;    ///< by edge
  std::vector<uint32_t> words;  ///< of the looks
};

/// How what a commit leaves comes into the recording.
enum class Looks {
  without_clock,  ///< `look` events
  as_reads,       ///< `read` events in turn, wherever the bus has room for them and a setup phase
};

/// The model, with everything it is asked and answers written down.
class Recorder final : public coprocessor::Device {
 public:
  Recorder(const coprocessor::Options& options, Recording& recording,
           Looks looks = Looks::without_clock);

  void reset() override;
  void advance(uint64_t cycle) override;
  std::optional<uint64_t> next_event() const override { return model_.next_event(); }
  bool submit(uint64_t cycle, int32_t u, int32_t v, bool clip) override;
  coprocessor::RegisterAccess read(uint64_t cycle, uint32_t offset, bool debug) override;
  bool write(uint64_t cycle, uint32_t offset, uint32_t value) override;
  bool write_bytes(uint64_t cycle, uint32_t offset, uint32_t value, uint8_t strobes) override;
  bool interrupt() const override { return model_.interrupt(); }
  bool idle() const override { return model_.idle(); }
  const coprocessor::Nodes& nodes() const override { return model_.nodes(); }
  unsigned tick() const override { return model_.tick(); }
  /// To be called at the end: what the last edge left.
  void close();
  /// Events of earlier edges are all there.
  uint64_t edge() const { return edge_; }

 private:
  void read_results(uint64_t until);

  coprocessor::Coprocessor model_;
  Recording& recording_;
  Looks looks_;
  uint64_t edge_ = 0;
  uint64_t bus_free_ = 1;          // with setup phases, the first interval of the next access
  std::size_t next_look_ = 0;      // of those that are reads
  std::size_t pending_looks_ = 0;  // until each was read since the last commit
  uint64_t commits_ = 0;
  bool interrupt_ = false, idle_ = true;
};

}  // namespace capsoc::regress
