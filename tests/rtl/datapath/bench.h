// A Verilated datapath and the values of its ports, edge by edge.
#pragma once

#include <verilated.h>

#include <cstdint>
#include <memory>

#include "Vdatapath.h"
#include "coprocessor/datapath.h"
#include "coprocessor/harmonic_correction.h"
#include "coprocessor/register_map.h"
#include "coprocessor/turn_judge.h"
#include "coprocessor/types.h"

namespace capsoc::rtl_test {

using coprocessor::Coefficients;
using coprocessor::JudgeSettings;
using coprocessor::Parameters;
using coprocessor::ReferenceState;
using coprocessor::Settings;

inline constexpr uint64_t mask48 = (uint64_t{1} << 48) - 1;

// A 48-bit port word as a signed number.
inline int64_t sign48(uint64_t word) {
  return static_cast<int64_t>(word << 16) >> 16;
}

// The registers that the datapath reads.
struct Registers {
  Settings settings;
  bool calibrate = false;
  uint32_t lock_threshold = 1u << 21;
  uint32_t diverge_threshold = 1u << 29;
  JudgeSettings judge;
  bool frozen = false;
  ReferenceState reference;
  Coefficients coefficients;
  Parameters parameters;
};

// What the sequencer says about the running tick and the boundary that ends the interval.
struct Timing {
  bool boundary = false;
  bool enter = false;
  unsigned clock = 0;  // of the tick
  unsigned cycle = 0;
  bool rest = false;
  unsigned stage = 0;       // bit s: T0..T4 hold a sample
  unsigned load = 0;        // bit s: L0..L2
  unsigned load_start = 0;  // with boundary
};

class Bench {
 public:
  Bench() : context_(std::make_unique<VerilatedContext>()), top_(context_.get()) {
    top_.clk_i = 0;
    top_.rst_ni = 0;
    top_.eval();
    top_.rst_ni = 1;
    top_.eval();
  }
  ~Bench() { top_.final(); }
  Bench(const Bench&) = delete;
  Bench& operator=(const Bench&) = delete;

  void drive(const Registers& r) {
    top_.demod_i = r.settings.demodulate;
    top_.calib_i = r.calibrate;
    top_.block_i = r.settings.block;
    top_.guard_i = r.settings.guard;
    top_.correct_i = r.settings.correct;
    top_.ref_i = static_cast<uint8_t>(r.settings.source);
    top_.kp_i = static_cast<uint8_t>(r.settings.kp);
    top_.ki_i = static_cast<uint8_t>(r.settings.ki);
    top_.step_au_i = r.settings.steps_u.sine;
    top_.step_bu_i = r.settings.steps_u.cosine;
    top_.step_cu_i = r.settings.steps_u.constant;
    top_.step_av_i = r.settings.steps_v.sine;
    top_.step_bv_i = r.settings.steps_v.cosine;
    top_.step_cv_i = r.settings.steps_v.constant;
    top_.lock_threshold_i = r.lock_threshold;
    top_.diverge_threshold_i = r.diverge_threshold;
    top_.judge_i = r.judge.radius_limit |
                   r.judge.alarm_limit << coprocessor::judge_alarm_limit_shift |
                   r.judge.turns << coprocessor::judge_turns_shift |
                   (r.judge.count ? coprocessor::judge_count : 0) |
                   r.settings.slew << coprocessor::judge_slew_shift;
    top_.turn_limit_i = r.judge.turn_limit;
    top_.frozen_i = r.frozen;
    top_.phase_i = r.reference.phase & mask48;
    top_.freq_i = static_cast<uint64_t>(r.reference.frequency) & mask48;
    const auto word = [](int64_t weight) { return static_cast<uint64_t>(weight) & mask48; };
    top_.au_i = word(r.coefficients.u.sine);
    top_.bu_i = word(r.coefficients.u.cosine);
    top_.cu_i = word(r.coefficients.u.constant);
    top_.av_i = word(r.coefficients.v.sine);
    top_.bv_i = word(r.coefficients.v.cosine);
    top_.cv_i = word(r.coefficients.v.constant);
    top_.a1_i = static_cast<uint32_t>(r.parameters.a1);
    top_.a2_i = static_cast<uint32_t>(r.parameters.a2);
    top_.b1_i = static_cast<uint32_t>(r.parameters.b1);
    top_.b2_i = static_cast<uint32_t>(r.parameters.b2);
    top_.beta_i = r.parameters.beta;
    top_.phi_i = r.parameters.phi;
  }

  void drive(const Timing& t) {
    top_.boundary_i = t.boundary;
    top_.enter_i = t.enter;
    top_.clock_i = static_cast<uint8_t>(t.clock);
    top_.cycle_i = static_cast<uint8_t>(t.cycle);
    top_.rest_i = t.rest;
    top_.stage_i = static_cast<uint8_t>(t.stage);
    top_.load_i = static_cast<uint8_t>(t.load);
    top_.load_start_i = static_cast<uint8_t>(t.load_start);
  }

  // A write of CORRECTION: value s20, 2^-24 turn.
  void correct(bool write, unsigned node, int32_t value) {
    top_.correction_write_i = write;
    top_.correction_node_i = static_cast<uint8_t>(node);
    top_.correction_value_i = static_cast<uint32_t>(value) & coprocessor::correction_value_mask;
  }

  void hold(int32_t u, int32_t v, bool clip) {
    top_.held_u_i = static_cast<uint32_t>(u);
    top_.held_v_i = static_cast<uint32_t>(v);
    top_.held_clip_i = clip;
  }

  void settle() { top_.eval(); }

  void edge() {
    top_.clk_i = 1;
    top_.eval();
    top_.clk_i = 0;
    top_.eval();
  }

  uint32_t result(unsigned select) {
    top_.result_select_i = static_cast<uint8_t>(select);
    top_.eval();
    return top_.result_o;
  }

  Coefficients weights() const {
    return {{sign48(top_.au_o), sign48(top_.bu_o), sign48(top_.cu_o)},
            {sign48(top_.av_o), sign48(top_.bv_o), sign48(top_.cv_o)}};
  }

  Parameters parameters() const {
    const auto word = [](uint32_t value) { return static_cast<int32_t>(value); };
    return {word(top_.a1_o), word(top_.a2_o), word(top_.b1_o),
            word(top_.b2_o), top_.beta_o,     top_.phi_o};
  }

  Vdatapath& top() { return top_; }

 private:
  std::unique_ptr<VerilatedContext> context_;
  Vdatapath top_;
};

}  // namespace capsoc::rtl_test
