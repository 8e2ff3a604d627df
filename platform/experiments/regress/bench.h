// Drives a coprocessor as its bus and its ADC stream would: keeps the edge, one bus transfer and
// one sample at a time, and notes what was covered.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "coprocessor/device.h"
#include "coprocessor/sequencer.h"
#include "regress/coverage.h"

namespace capsoc::regress {

class Bench {
 public:
  struct Counts {
    uint64_t samples = 0;  ///< presented, latched or not
    uint64_t accesses = 0;
    uint64_t commits = 0;
    uint64_t edges = 0;
  };

  /// What is wrong with the results themselves, though both devices have them.
  struct Complaint {
    uint64_t edge = 0;
    std::string what;    ///< a sentence
    std::string report;  ///< several lines
  };

  enum class Bus {
    fastest,     ///< a transfer an interval, as the coprocessor can take it
    with_setup,  ///< each with APB's setup phase before it; a reset takes an edge
  };

  /// `failed` says whether the device under test has already differed.
  Bench(coprocessor::Device& device, coprocessor::Arithmetic arithmetic, Coverage& coverage,
        std::function<bool()> failed, Bus bus = Bus::fastest);

  /// The edge at which the next sample or write can act.
  uint64_t edge() const { return edge_; }
  void wait(uint64_t edges) { advance(edge_ + edges); }
  /// To `edge`, if that is still ahead.
  void wait_until(uint64_t edge) {
    if (edge > edge_) advance(edge);
  }

  /// A sample of the ADC stream at the present edge, or at the next if this one has had its sample
  /// or is closed. Returns whether it was latched.
  bool sample(uint32_t u, uint32_t v, bool clip = false);
  /// A bus write that acts at the present edge, or as soon as the bus is free. Strobes: PSTRB.
  void write(uint32_t offset, uint32_t value, uint8_t strobes = coprocessor::all_strobes);
  uint32_t read(uint32_t offset, bool debug = false);
  void pin_reset();
  /// Looks at the interrupt line.
  bool interrupt();
  /// Until the pipeline is empty.
  void drain();

  /// A 48-bit register by the offset of its LO word: FREQ and PHASE in 2^-48 turn, coefficients in
  /// Q2.46.
  void write_pair(uint32_t low_offset, int64_t value);
  void soft_sample(uint32_t u, uint32_t v);
  /// The edge at which the running tick ends; none while idle.
  std::optional<uint64_t> boundary() const;
  bool busy() const { return shadow_.busy(); }
  bool failed() const { return failed_(); }
  void complain(std::string what, std::string report);
  const std::optional<Complaint>& complaint() const { return complaint_; }

  const coprocessor::Nodes& nodes();
  const Counts& counts() const { return counts_; }
  /// Edges of a tick, and from the one that latches a sample to its results.
  uint64_t tick() const { return tick_; }
  uint64_t latency() const { return coprocessor::latency_of(tick_); }
  /// What takes `edges` with ticks of 32.
  uint64_t scaled(uint64_t edges) const { return edges * tick_ / coprocessor::tick_cycles; }
  coprocessor::Arithmetic arithmetic() const { return arithmetic_; }

 private:
  // Each brings the device and the shadow to `edge`.
  void advance(uint64_t edge);
  void open_edge();
  uint64_t bus_edge_for_write();
  void turn();
  void collect();

  // Coverage, bench_coverage.cpp
  size_t moment() const;
  void cover_commit();
  void cover_saturation(const coprocessor::Nodes& n);
  void cover_ties(const coprocessor::Nodes& n);
  void cover_flags(uint32_t flags);
  void cover_judge(const coprocessor::Nodes& n);
  void cover_slew(const coprocessor::Nodes& n);
  void cover_safety(const coprocessor::Nodes& n, uint32_t flags_before);
  void cover_parity(uint32_t offset, uint32_t value);
  void cover_interrupt(bool level);
  void cover_enables(uint32_t value);
  void cover_spacing();
  void cover_write(uint32_t offset, uint32_t value);
  void cover_mode_change(uint32_t offset, uint32_t value);
  void cover_collision(uint32_t offset, uint32_t value);
  void cover_pair_write(uint32_t offset);
  void cover_read(uint32_t offset, bool debug, bool ok);
  void shadow_reset();
  void shadow_latch(bool latched);

  coprocessor::Device& device_;
  unsigned tick_;
  coprocessor::Arithmetic arithmetic_;
  Coverage& coverage_;
  std::function<bool()> failed_;
  uint64_t setup_;  // intervals of a setup phase
  Counts counts_;
  std::optional<Complaint> complaint_;

  uint64_t edge_ = 1;
  bool sampled_ = false;   // the present edge has had its sample
  bool written_ = false;   // ... its write
  bool closed_ = false;    // ... a read after it
  uint64_t bus_free_ = 0;  // the first interval that may have the next access

  // What the pipeline does now, without data.
  coprocessor::Sequencer shadow_;
  uint64_t boundary_ = 0;
  uint64_t turned_ = 0;  // the last boundary
  bool held_ = false;
  bool load_waits_ = false;
  bool commit_seen_ = false;     // results of the last turn are to be collected
  std::array<bool, 5> ended_{};  // stages that ended at the last boundary

  // What software wrote last.
  uint32_t ctrl_ = 0;
  uint32_t loop_ = 0x0A04;
  std::array<uint32_t, 6> steps_{};
  uint64_t settled_at_ = 0;  // samples before it may have used other settings
  std::optional<uint64_t> last_sample_;
  std::array<uint8_t, 8> staged_{};   // of the pairs: LO written
  std::array<uint8_t, 8> latched_{};  // HI read, 2: and a commit since
  uint32_t flags_ = 0;
  uint32_t status_ = 0;
  unsigned since_reset_ = 0;
  uint32_t turn_flags_ = 0;
  int64_t glitches_ = 0;
  uint32_t judge_ = 0x13333;
  uint64_t judge_at_ = 0;  // samples before it may have used another
  uint32_t safety_ = 0;
  uint64_t safety_at_ = 0;
  uint64_t unfit_ = 0;       // registers that were last written with the wrong parity bit
  bool distrusted_ = false;  // the last sample
  std::optional<uint32_t> last_angle_;  // of the judge, 2^-32 turn
};

}  // namespace capsoc::regress
