// The self-calibration coprocessor at register level, exact to the PCLK cycle. Normative text:
// docs/coprocessor.md. Plain C++: time is a cycle number that the caller hands in.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "coprocessor/datapath.h"
#include "coprocessor/device.h"
#include "coprocessor/harmonic_correction.h"
#include "coprocessor/idle_state.h"
#include "coprocessor/register_map.h"
#include "coprocessor/sequencer.h"
#include "coprocessor/turn_judge.h"
#include "coprocessor/types.h"

namespace capsoc::coprocessor {

class Coprocessor final : public Device {
 public:
  explicit Coprocessor(Options options);

  void reset() override;
  // CTRL.SRST: every register and the pipeline to power-on state; time goes on.
  void soft_reset();

  void advance(uint64_t cycle) override;
  std::optional<uint64_t> next_event() const override { return sequencer_.next_event(); }
  bool submit(uint64_t cycle, int32_t u, int32_t v, bool clip) override;
  RegisterAccess read(uint64_t cycle, uint32_t offset, bool debug) override;
  bool write(uint64_t cycle, uint32_t offset, uint32_t value) override;
  std::string_view guest_error() const override { return guest_error_; }
  bool interrupt() const override;
  bool idle() const override { return !sequencer_.busy(); }
  const Nodes& nodes() const override { return nodes_; }
  bool stage_nodes(unsigned stage, Nodes& nodes) const override;
  void visit(kit::Archive& archive) override;
  bool save_idle(IdleState& state) const override;
  bool load_idle(const IdleState& state) override;
  std::unique_ptr<Device> clone() const override { return std::make_unique<Coprocessor>(*this); }

 private:
  // Written at the end of the tick under way.
  struct Pending {
    ReferenceState reference;
    bool steer_frequency = false;
    Learning learning;
    PolarResult polar;
    bool keep_parameters = false, calibrate = false, lock = false, diverged = false;
    TurnJudge judge;
    uint32_t error_average = 0;
    Rotation load_rotation;
    Weights load_weights;

    void visit(kit::Archive& archive);
  };

  // state.cpp
  template <typename Self>
  static auto members_of(Self& c);

  // coprocessor.cpp
  void commit_tick();
  void start_tick();
  void start_load(unsigned stage);
  void start_results(Packet& packet);
  void commit_load(unsigned stage);
  void commit_results(const Packet& packet);
  void record_nodes(const Packet& packet);
  void packet_nodes(const Packet& packet, unsigned stage, Nodes& n) const;
  bool latch(uint64_t cycle, int32_t u, int32_t v, bool clip);

  // register_bank.cpp
  std::optional<uint32_t> peek(uint32_t offset) const;
  bool write_control(uint64_t cycle, uint32_t offset, uint32_t value);
  bool write_setting(uint32_t offset, uint32_t value);
  bool write_parameter(uint32_t offset, uint32_t value);
  bool write_pair(uint32_t offset, uint32_t value);
  void write_ctrl(uint32_t value);
  void write_correction(uint32_t value);
  void write_command(uint64_t cycle, uint32_t value);
  uint32_t status() const;
  uint32_t turn_flags() const;
  bool frozen() const;
  int64_t pair_value(unsigned pair) const;
  void set_pair(unsigned pair, int32_t high, uint32_t low);

  Options options_;
  uint64_t cycle_ = 0;  // the last edge that has passed
  Datapath datapath_;
  Sequencer sequencer_;

  // Registers
  uint32_t ctrl_ = 0;
  uint32_t flags_ = 0;
  Settings settings_;
  State state_;
  Results results_;
  JudgeSettings judge_settings_;
  TurnJudge judge_;
  uint32_t lock_threshold_ = 0;
  uint32_t diverge_threshold_ = 0;
  uint32_t soft_u_ = 0;
  uint32_t samples_ = 0;
  uint32_t early_count_ = 0;
  unsigned settled_ = 0;  // samples since reset, up to 64: below that the averages mean nothing
  // Low words of the 48-bit registers: FREQ, PHASE, AU, BU, CU, AV, BV, CV.
  std::array<uint32_t, 8> staged_low_{};
  std::array<uint32_t, 8> latched_low_{};
  CorrectionTable corrections_{};  // outlives a reset

  // Pipeline
  Packet held_;
  std::array<Packet, stage_count> pipe_;
  Rotation load_rotation_;
  Pending pending_;

  Nodes nodes_;
  std::string_view guest_error_;
};

}  // namespace capsoc::coprocessor
