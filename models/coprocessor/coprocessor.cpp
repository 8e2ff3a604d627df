#include "coprocessor/coprocessor.h"

#include <algorithm>

#include "coprocessor/calibrator.h"
#include "coprocessor/lms_demodulator.h"

namespace capsoc::coprocessor {
namespace {

constexpr unsigned settling_samples = 64;
// Steps: omega / 2 for 0.05 Hz at 250 Hz.
constexpr Steps start_steps_u = {description::STEP_AU_reset, description::STEP_BU_reset,
                                 description::STEP_CU_reset};
constexpr Steps start_steps_v = {description::STEP_AV_reset, description::STEP_BV_reset,
                                 description::STEP_CV_reset};

// A coefficient as its register words are at reset.
constexpr int64_t start_weight(uint32_t high, uint32_t low) {
  return (int64_t{static_cast<int32_t>(high)} << 15) + static_cast<int32_t>(low);
}

// Weights as the arithmetic keeps them.
Weights stored(const Weights& weights, bool paper) {
  if (!paper) return weights;
  const auto word = [](int64_t weight) {
    bool clamped = false;
    return fixed::scale_up(fixed::saturate<32>(weight_q31(weight), clamped), 15);
  };
  return {word(weights.sine), word(weights.cosine), word(weights.constant)};
}

Options checked(Options options) {
  options.paper_operand_bits = std::clamp(options.paper_operand_bits, 2, 32);
  options.paper_reference_lead = std::clamp(options.paper_reference_lead, -1024, 1024);
  options.paper_step_shift = std::clamp(options.paper_step_shift, 0, 31);
  if (options.arithmetic == Arithmetic::paper)
    options.block_learning = options.harmonic_correction = false;
  return options;
}

}  // namespace

Coprocessor::Coprocessor(Options options) : options_(checked(options)), datapath_(options_) {
  reset();
}

void Coprocessor::reset() {
  soft_reset();
}

void Coprocessor::soft_reset() {
  sequencer_.reset();
  ctrl_ = 0;
  flags_ = 0;
  settings_ = {};
  settings_.steps_u = start_steps_u;
  settings_.steps_v = start_steps_v;
  state_ = {};
  state_.block.window_ended = true;  // the first sample begins a window
  state_.coefficients.u.sine = start_weight(description::AU_HI_reset, description::AU_LO_reset);
  state_.coefficients.v.cosine = start_weight(description::BV_HI_reset, description::BV_LO_reset);
  state_.parameters.a1 = static_cast<int32_t>(description::A1_reset);
  state_.parameters.a2 = static_cast<int32_t>(description::A2_reset);
  results_ = {};
  judge_settings_ = {};
  judge_ = {};
  lock_threshold_ = description::LOCK_THRESHOLD_reset;
  diverge_threshold_ = description::DIVERGE_THRESHOLD_reset;
  soft_u_ = 0;
  samples_ = 0;
  early_count_ = 0;
  settled_ = 0;
  staged_low_ = {};
  latched_low_ = {};
  nodes_ = {};
}

void Coprocessor::advance(uint64_t cycle) {
  cycle_ = std::max(cycle_, cycle);
  while (sequencer_.due(cycle)) {
    commit_tick();
    sequencer_.turn();
    start_tick();
  }
}

bool Coprocessor::submit(uint64_t cycle, int32_t u, int32_t v, bool clip) {
  advance(cycle);
  if ((ctrl_ & ctrl_adc) == 0 || !latch(cycle, u, v, clip)) return false;
  held_.taken = cycle;
  return true;
}

bool Coprocessor::latch(uint64_t cycle, int32_t u, int32_t v, bool clip) {
  if (!sequencer_.latch(cycle)) {
    if (early_count_ != UINT32_MAX) ++early_count_;
    flags_ |= flag_early;
    return false;
  }
  held_ = {};
  held_.u = u;
  held_.v = v;
  held_.clip = clip;
  return true;
}

// Everything below computes from the state at the tick's start, so that the order in which the
// stages are computed does not matter; commit_tick() writes it all at the tick's end.
void Coprocessor::start_tick() {
  for (unsigned stage = stage_count - 1; stage > 0; --stage)
    if (sequencer_.occupied(stage)) pipe_[stage] = pipe_[stage - 1];
  if (sequencer_.entered()) {
    pipe_[0] = held_;
    datapath_.products(pipe_[0], state_);
    pipe_[0].saturated_after[0] = pipe_[0].saturated;
  }
  if (sequencer_.occupied(1)) {
    datapath_.relative_angle(pipe_[1]);
    if (settings_.correct)
      pipe_[1].relative = corrected_angle(corrections_, pipe_[1].relative, state_.parameters.phi);
    pipe_[1].saturated_after[1] = pipe_[1].saturated;
  }
  if (sequencer_.occupied(2)) {
    datapath_.reference(pipe_[2], settings_, state_, pending_.reference);
    pipe_[2].next_reference = pending_.reference;
    if (settings_.source != ReferenceSource::tracking) pipe_[2].next_reference.frequency = 0;
    pipe_[2].saturated_after[2] = pipe_[2].saturated;
    pending_.steer_frequency = settings_.source == ReferenceSource::tracking;
  }
  if (sequencer_.occupied(3)) {
    const bool learns = settings_.demodulate && !frozen() && !pipe_[3].hold_weights;
    const LearningPlan plan = plan_learning(state_.block, settings_, learns, judge_.last.flags);
    datapath_.demodulation(pipe_[3], settings_, state_, plan, pending_.learning);
    pipe_[3].next_coefficients =
        plan.update || plan.sum ? pending_.learning.coefficients : Coefficients{};
    pipe_[3].next_average =
        error_average(std::max(pending_.learning.error_sum_u, pending_.learning.error_sum_v));
    pipe_[3].saturated_after[3] = pipe_[3].saturated;
  }
  if (sequencer_.occupied(4)) start_results(pipe_[4]);
  if (const auto stage = sequencer_.load_stage()) start_load(*stage);
}

void Coprocessor::commit_tick() {
  if (sequencer_.occupied(2)) {
    state_.reference.phase = pending_.reference.phase;
    // Only the tracking source owns the frequency: otherwise a word that software wrote in the
    // course of this tick would be lost.
    if (pending_.steer_frequency) state_.reference.frequency = pending_.reference.frequency;
  }
  if (sequencer_.occupied(3)) {
    if (pending_.learning.update) state_.coefficients = pending_.learning.coefficients;
    if (pending_.learning.sum) state_.block.sums = pending_.learning.coefficients;
    if (!state_.block.begun) state_.block.sums = {};
    state_.error_sum_u = pending_.learning.error_sum_u;
    state_.error_sum_v = pending_.learning.error_sum_v;
  }
  if (sequencer_.occupied(4)) commit_results(pipe_[4]);
  if (const auto stage = sequencer_.load_stage()) commit_load(*stage);
}

void Coprocessor::start_load(unsigned stage) {
  const Parameters& p = state_.parameters;
  const Rotation& r = load_rotation_;
  if (stage == 0) pending_.load_rotation = datapath_.rotation(to_phase48(p.phi));
  if (stage == 1) {
    pending_.load_weights = stored(coefficients_u(p, r.sine, r.cosine), datapath_.paper());
    pending_.load_rotation = datapath_.rotation(to_phase48(p.phi + p.beta));
  }
  if (stage == 2)
    pending_.load_weights = stored(coefficients_v(p, r.sine, r.cosine), datapath_.paper());
}

void Coprocessor::commit_load(unsigned stage) {
  if (stage < 2) load_rotation_ = pending_.load_rotation;
  if (stage == 1) state_.coefficients.u = pending_.load_weights;
  if (stage == 2) state_.coefficients.v = pending_.load_weights;
}

void Coprocessor::start_results(Packet& packet) {
  pending_.polar = datapath_.parameters(packet, settings_, state_);
  pending_.keep_parameters = !settings_.demodulate;
  pending_.calibrate = (ctrl_ & ctrl_calib) != 0;
  pending_.error_average = error_average(std::max(state_.error_sum_u, state_.error_sum_v));
  const bool settled = settled_ + 1 >= settling_samples;
  const JudgedSample judged = {packet.amplitude,
                               packet.det,
                               packet.residue,
                               pending_.polar.angle,
                               packet.clip,
                               packet.saturated,
                               packet.zero || packet.unsettled,
                               packet.mirror,
                               packet.turn};
  pending_.judge =
      judge(judge_, judged, judge_settings_, settings_.source != ReferenceSource::numeric);
  pending_.lock = settled && pending_.error_average < lock_threshold_ &&
                  pending_.judge.permits_lock(judge_settings_.turns);
  pending_.diverged = settled && pending_.error_average > diverge_threshold_;
}

void Coprocessor::commit_results(const Packet& packet) {
  Results& r = results_;
  flags_ |= flag_result;
  if (packet.clip) flags_ |= flag_clip;
  if (packet.saturated) flags_ |= flag_sat;
  if (packet.zero) flags_ |= flag_zero;
  if (packet.unsettled) flags_ |= flag_unsettled;
  if (pending_.diverged) flags_ |= flag_diverged;
  if (pending_.lock != r.lock) flags_ |= flag_lockchg;
  if (packet.mirror != r.mirror) flags_ |= flag_mirrorchg;
  judge_ = pending_.judge;
  state_.block.window_ended = judge_.ended;
  if (judge_.ended) flags_ |= flag_turn;
  if (judge_.alarm) flags_ |= flag_alarm;
  r.raw_u = static_cast<uint32_t>(packet.u);
  r.raw_v = static_cast<uint32_t>(packet.v);
  r.cal_s = static_cast<uint32_t>(packet.cal_s);
  r.cal_c = static_cast<uint32_t>(packet.cal_c);
  r.error_u = static_cast<uint32_t>(packet.error_u);
  r.error_v = static_cast<uint32_t>(packet.error_v);
  r.residue = static_cast<uint32_t>(packet.residue);
  r.reference_phase = packet.reference_phase;
  r.amplitude = static_cast<uint32_t>(packet.amplitude);
  r.error_average = pending_.error_average;
  r.lock = pending_.lock;
  r.diverged = pending_.diverged;
  r.mirror = packet.mirror;
  r.valid = pending_.calibrate && !packet.zero && !packet.unsettled;
  if (r.valid) r.angle = pending_.polar.angle;
  if (!pending_.keep_parameters) state_.parameters = pending_.polar.parameters;
  ++samples_;
  settled_ = std::min(settled_ + 1, settling_samples);
  record_nodes(packet);
}

void Coprocessor::packet_nodes(const Packet& packet, unsigned stage, Nodes& n) const {
  const auto upper_half = [](fixed::int128 x) { return static_cast<int64_t>(x >> 64); };
#define NODE(name, made_in, format, model, when, rtl) \
  if (stage == (made_in)) n.name = static_cast<int64_t>(model);
#include "coprocessor/nodes.def"
}

bool Coprocessor::stage_nodes(unsigned stage, Nodes& nodes) const {
  if (stage >= stage_count || !sequencer_.occupied(stage) || !sequencer_.turns_after(cycle_))
    return false;
  packet_nodes(pipe_[stage], stage, nodes);
  return true;
}

void Coprocessor::record_nodes(const Packet& packet) {
  ++nodes_.commits;
  nodes_.taken = packet.taken;
  for (unsigned stage = 0; stage <= commit_stage; ++stage) packet_nodes(packet, stage, nodes_);
}

bool Coprocessor::frozen() const {
  return (ctrl_ & ctrl_freeze) != 0 && (flags_ & flag_alarm) != 0;
}

bool Coprocessor::interrupt() const {
  return ((flags_ & flag_result) && (ctrl_ & ctrl_ie_result)) ||
         ((flags_ & flag_lockchg) && (ctrl_ & ctrl_ie_lock)) ||
         ((flags_ & flags_error) && (ctrl_ & ctrl_ie_error)) ||
         ((flags_ & flag_turn) && (ctrl_ & ctrl_ie_turn)) ||
         ((flags_ & flag_alarm) && (ctrl_ & ctrl_ie_alarm));
}

}  // namespace capsoc::coprocessor
