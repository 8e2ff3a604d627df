// The self-calibration coprocessor at register level, exact to the PCLK cycle. Normative text:
// docs/reference/coprocessor.md. Plain C++: time is a cycle number that the caller hands in.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

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
  // CTRL.SRST: every register of the active channel and the pipeline to power-on state; time
  // continues.
  void soft_reset();

  void advance(uint64_t cycle) override;
  std::optional<uint64_t> next_event() const override { return sequencer_.next_event(); }
  bool submit(uint64_t cycle, int32_t u, int32_t v, bool clip) override {
    return submit_of(0, cycle, u, v, clip);
  }
  bool submit_of(unsigned channel, uint64_t cycle, int32_t u, int32_t v, bool clip) override;
  unsigned channels() const override { return static_cast<unsigned>(options_.channels); }
  RegisterAccess read(uint64_t cycle, uint32_t offset, bool debug) override;
  bool write(uint64_t cycle, uint32_t offset, uint32_t value) override;
  bool interrupt() const override;
  bool idle() const override { return !sequencer_.any_busy(); }
  const Nodes& nodes() const override { return arch_.nodes; }
  bool stage_nodes(unsigned stage, Nodes& nodes) const override;
  unsigned tick() const override { return sequencer_.tick(); }
  void visit(Archive& archive) override;
  bool save_idle(IdleState& state) const override;
  bool load_idle(const IdleState& state) override;
  std::unique_ptr<Device> clone() const override { return std::make_unique<Coprocessor>(*this); }

 private:
  // Written at the end of the tick under way.
  struct Pending {
    ReferenceState reference;
    bool steer_frequency = false;
    Learning learning;
    bool bad_parity = false;  // SAFETY.BAD_PARITY: what the tick writes gets the wrong parity bits
    PolarResult polar;
    bool keep_parameters = false, calibrate = false, lock = false, diverged = false;
    TurnJudge judge;
    uint32_t error_average = 0;
    uint32_t findings = 0;  // of the safety mechanisms that are on: places of SAFETY's enables
    Rotation load_rotation;
    Weights load_weights;

    void visit(Archive& archive);
  };

  // coprocessor.cpp
  void commit_tick();
  // unfit: registers that do not fit their parity bit, before what the tick before has written.
  void start_tick(uint64_t unfit);
  // The coefficients on their way through the tick get wrong parity bits.
  bool marks_coefficients() const;
  void start_load(unsigned stage);
  void start_results(Packet& packet);
  void commit_load(unsigned stage);
  void commit_results(const Packet& packet);
  void record_nodes(const Packet& packet);
  void packet_nodes(const Packet& packet, unsigned stage, Nodes& n) const;
  bool latch(unsigned channel, uint64_t cycle, int32_t u, int32_t v, bool clip);
  // The channel's registers, wherever they are.
  IdleState& context(unsigned channel);
  const IdleState& context(unsigned channel) const;
  void change_context(unsigned from, unsigned to);
  // The channel's part of the interrupt.
  static bool raises(const IdleState& registers);

  // register_bank.cpp
  struct Registers;
  void write_pair(const registers::RegisterRule& rule, uint32_t value);
  void write_ctrl(uint32_t value);
  void write_safety(uint32_t value);
  void write_correction(uint32_t value);
  void write_command(uint64_t cycle, uint32_t value);
  void write_loop(uint32_t value);
  void write_judge(uint32_t value);
  uint32_t version() const;
  uint32_t status() const;
  uint32_t channel_word() const;
  void write_channel(uint64_t cycle, uint32_t value);
  // The window is open for an access of a register; one that is refused is noted.
  bool shows(uint32_t offset, bool is_ready, bool debug);
  uint32_t turn_flags() const;
  uint32_t loop() const;
  uint32_t judge_word() const;
  bool frozen() const;
  // Registers were written, and their parity bits (parity_bit()) with them.
  void written(uint64_t bits) { arch_.unfit &= ~bits; }
  uint32_t findings(const Packet& packet, int32_t step) const;

  Options options_;
  Datapath datapath_;
  Sequencer sequencer_;

  // The architectural state: all that is left while nothing is in the pipeline.
  IdleState arch_;

  // Pipeline
  Packet held_;
  std::array<Packet, stage_count> pipe_;
  Rotation load_rotation_;
  Pending pending_;
};

}  // namespace capsoc::coprocessor
