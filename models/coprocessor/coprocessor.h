// The self-calibration coprocessor at register level, exact to the PCLK cycle. Normative text:
// docs/coprocessor.md. Plain C++: time is a cycle number that the caller hands in.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "coprocessor/datapath.h"
#include "coprocessor/register_map.h"
#include "coprocessor/sequencer.h"
#include "coprocessor/types.h"

namespace capsoc::coprocessor {

// The nodes of the last sample whose results were committed, for lockstep comparison. Raw words:
// signed formats sign-extended, unsigned ones zero-extended.
struct Nodes {
  int64_t u = 0, v = 0, cal_s = 0, cal_c = 0, amplitude = 0;  // Q1.31
  int64_t relative = 0, reference_phase = 0, residue = 0;     // 2^-32 turn
  int64_t sine = 0, cosine = 0, error_u = 0, error_v = 0;     // Q1.31
  // Registers as the commit leaves them.
  int64_t phase = 0, frequency = 0;                              // 2^-48 turn
  int64_t a_u = 0, b_u = 0, c_u = 0, a_v = 0, b_v = 0, c_v = 0;  // Q2.46
  int64_t a1 = 0, a2 = 0, b1 = 0, b2 = 0, beta = 0, phi = 0, angle = 0;
  int64_t error_average = 0, status = 0, flags = 0, samples = 0;
};

struct NamedNode {
  const char* name;
  int64_t Nodes::*value;
};
// Every node of Nodes by name, in pipeline order.
const std::array<NamedNode, 31>& node_names();

struct RegisterAccess {
  bool ok = false;  // false: no register there (PSLVERR)
  uint32_t value = 0;
};

class Coprocessor {
 public:
  explicit Coprocessor(Options options);

  // Power-on state at cycle 0.
  void reset();
  // CTRL.SRST: every register and the pipeline to power-on state; time goes on.
  void soft_reset();

  // Time. `cycle` is the number of PCLK edges so far and never decreases from call to call; every
  // function below that takes one advances to it first, so that at one edge the pipeline comes
  // before samples and register accesses.
  void advance(uint64_t cycle);

  // The cycle of the next commit, end of a load or fall of BUSY; none when idle.
  std::optional<uint64_t> next_event() const { return sequencer_.next_event(); }

  // The sample port of the ADC stream (Q1.31 words). Returns whether the sample was latched: not
  // while CTRL.ADC is 0 (ignored), not while another sample waits (dropped, counted, flagged
  // EARLY).
  bool submit(uint64_t cycle, int32_t u, int32_t v, bool clip);

  // 32-bit register access at a byte offset. debug: no side effect, LO registers show the present
  // value instead of the latched one.
  RegisterAccess read(uint64_t cycle, uint32_t offset, bool debug);
  // false: unmapped. A write that has no effect (read-only, reserved value) is true and explained
  // by guest_error().
  bool write(uint64_t cycle, uint32_t offset, uint32_t value);

  // What was wrong with the last write, for the log; empty if nothing was.
  std::string_view guest_error() const { return guest_error_; }

  bool interrupt() const;
  bool idle() const { return !sequencer_.busy(); }
  const Nodes& nodes() const { return nodes_; }

 private:
  // Results that software sees; committed together at the end of T4.
  struct Results {
    uint32_t raw_u = 0, raw_v = 0, cal_s = 0, cal_c = 0, angle = 0, error_u = 0, error_v = 0,
             residue = 0, reference_phase = 0, amplitude = 0, error_average = 0;
    bool lock = false, diverged = false, mirror = false, valid = false;
  };

  // Written at the end of the tick under way.
  struct Pending {
    ReferenceState reference;
    bool steer_frequency = false;
    Learning learning;
    PolarResult polar;
    bool keep_parameters = false, calibrate = false, lock = false, diverged = false;
    uint32_t error_average = 0;
    Rotation load_rotation;
    Weights load_weights;
  };

  // coprocessor.cpp
  void commit_tick();
  void start_tick();
  void start_load(unsigned stage);
  void start_results(Packet& packet);
  void commit_load(unsigned stage);
  void commit_results(const Packet& packet);
  void record_nodes(const Packet& packet);
  bool latch(uint64_t cycle, int32_t u, int32_t v, bool clip);

  // register_bank.cpp
  std::optional<uint32_t> peek(uint32_t offset) const;
  bool write_control(uint64_t cycle, uint32_t offset, uint32_t value);
  bool write_setting(uint32_t offset, uint32_t value);
  bool write_parameter(uint32_t offset, uint32_t value);
  bool write_pair(uint32_t offset, uint32_t value);
  void write_ctrl(uint32_t value);
  void write_command(uint64_t cycle, uint32_t value);
  void reject(const char* what);
  uint32_t status() const;
  int64_t pair_value(unsigned pair) const;
  void set_pair(unsigned pair, int32_t high, uint32_t low);

  Options options_;
  Datapath datapath_;
  Sequencer sequencer_;

  // Registers
  uint32_t ctrl_ = 0;
  uint32_t flags_ = 0;
  Settings settings_;
  State state_;
  Results results_;
  uint32_t lock_threshold_ = 0;
  uint32_t diverge_threshold_ = 0;
  uint32_t soft_u_ = 0;
  uint32_t samples_ = 0;
  uint32_t early_count_ = 0;
  unsigned settled_ = 0;  // samples since reset, up to 64: below that the averages mean nothing
  // Low words of the 48-bit registers: FREQ, PHASE, AU, BU, CU, AV, BV, CV.
  std::array<uint32_t, 8> staged_low_{};
  std::array<uint32_t, 8> latched_low_{};

  // Pipeline
  Packet held_;
  std::array<Packet, stage_count> pipe_;
  Rotation load_rotation_;
  Pending pending_;

  Nodes nodes_;
  std::string_view guest_error_;
};

}  // namespace capsoc::coprocessor
