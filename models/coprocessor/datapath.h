// The five stages between registers. Each is a pure function of the sample in flight and of the
// state at the start of its tick; what it changes is written at the tick's end by the coprocessor.
#pragma once

#include <array>
#include <cstdint>

#include "base/fixed.h"
#include "coprocessor/reference_generator.h"
#include "coprocessor/register_map.h"
#include "coprocessor/types.h"

namespace capsoc::coprocessor {

// What a sample carries from stage to stage.
struct Packet {
  uint64_t taken = 0;  // as in Nodes
  int32_t u = 0;       // Q1.31
  int32_t v = 0;
  bool clip = false;
  bool saturated = false;
  // As a tick began with it, a register did not fit its parity bit, or a word of a memory that it
  // read; SAFETY did not.
  bool bad_parity = false;
  bool bad_safety = false;
  // T0
  fixed::int128 s = 0;  // Q62 (paper: Q31)
  fixed::int128 c = 0;
  int32_t cal_s = 0;  // Q1.31, saturated
  int32_t cal_c = 0;
  int32_t det = 0;  // Q1.31
  bool mirror = false;
  uint32_t phi = 0;  // paper: PHI as it was in T0
  // T1
  uint32_t relative = 0;  // angle against the reference, 2^-32 turn
  int32_t amplitude = 0;  // Q1.31
  bool zero = false;
  bool unsettled_t1 = false;  // paper: the arctangent has not converged
  bool unsettled = false;     // and with T4's
  // T2
  uint32_t reference_phase = 0;  // 2^-32 turn
  int32_t residue = 0;           // 2^-32 turn
  Rotation reference;
  bool hold_weights = false;  // angle source without an angle: nothing to learn
  ReferenceState next_reference;
  bool turn = false;  // PHASE + FREQ passes 0
  // T3
  int32_t error_u = 0;  // Q1.31
  int32_t error_v = 0;
  bool misfit = false;             // an error is beyond SAFETY.ERROR_LIMIT
  Coefficients next_coefficients;  // or a block's sums; 0 without an update
  uint32_t next_average = 0;       // Q1.31
  // `saturated` as the stages left it
  std::array<bool, 4> saturated_after{};

  void visit(Archive& archive);
};

// Registers that the pipeline reads.
struct Settings {
  bool demodulate = false;
  ReferenceSource source = ReferenceSource::numeric;
  unsigned kp = field(description::LOOP_reset, description::LOOP_KP_mask);
  unsigned ki = field(description::LOOP_reset, description::LOOP_KI_mask);
  Steps steps_u;
  Steps steps_v;
  unsigned slew = 0;  // JUDGE.SLEW, 0..7
  bool block = false;
  bool guard = false;
  bool correct = false;

  void visit(Archive& archive);
};

// Registers that the pipeline writes.
struct State {
  Coefficients coefficients;
  Parameters parameters;
  ReferenceState reference;
  uint64_t error_sum_u = 0;  // Q1.37
  uint64_t error_sum_v = 0;
  BlockLearning block;

  void visit(Archive& archive);
};

// What T3 writes.
struct Learning {
  bool update = false;  // of the coefficients
  bool sum = false;     // of the block's sums
  Coefficients coefficients;
  uint64_t error_sum_u = 0;
  uint64_t error_sum_v = 0;

  void visit(Archive& archive);
};

// What T4 finds.
struct PolarResult {
  Parameters parameters;
  uint32_t angle = 0;  // 2^-32 turn

  void visit(Archive& archive);
};

// What T3 does with its update, decided as the tick begins.
struct LearningPlan {
  bool update = false;     // it becomes the coefficients
  bool sum = false;        // it becomes the block's sums
  bool from_sums = false;  // it is added to the sums, else to the coefficients
};

// learns: with DEMOD, not frozen, and the sample has an angle if one is needed. turn_flags: of the
// window that ended last. Moves the block on.
LearningPlan plan_learning(BlockLearning& block, const Settings& settings, bool learns,
                           uint32_t turn_flags);

class Datapath {
 public:
  explicit Datapath(const Options& options) : options_(options) {}

  void products(Packet& packet, const State& state) const;  // T0
  void relative_angle(Packet& packet) const;                // T1
  void reference(Packet& packet, const Settings& settings, const State& state,
                 ReferenceState& next) const;  // T2
  // plan: what becomes of the update, see plan_learning
  void demodulation(Packet& packet, const Settings& settings, const State& state,
                    const LearningPlan& plan, Learning& next) const;  // T3
  PolarResult parameters(Packet& packet, const Settings& settings,
                         const State& state) const;  // T4

  // Rotation of either arithmetic.
  Rotation rotation(uint64_t phase) const;
  bool paper() const { return options_.arithmetic == Arithmetic::paper; }

 private:
  Options options_;
};

}  // namespace capsoc::coprocessor
