#include "coprocessor/coprocessor.h"

#include <algorithm>

#include "coprocessor/calibrator.h"
#include "coprocessor/lms_demodulator.h"

namespace capsoc::coprocessor {
namespace {

constexpr unsigned settling_samples = 64;
constexpr int64_t start_weight = int64_t{1} << 45;     // 0.5, Q2.46
constexpr int32_t start_amplitude = int32_t{1} << 30;  // 0.5, Q1.31
constexpr uint32_t start_step = 1349307;               // omega / 2 for 0.05 Hz at 250 Hz, Q1.31

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
  return options;
}

}  // namespace

const std::array<NamedNode, node_count>& node_names() {
  static const std::array<NamedNode, node_count> names = {{
      {"u", 0, &Nodes::u},
      {"v", 0, &Nodes::v},
      {"clip", 0, &Nodes::clip},
      {"s_high", 0, &Nodes::s_high},
      {"s_low", 0, &Nodes::s_low},
      {"c_high", 0, &Nodes::c_high},
      {"c_low", 0, &Nodes::c_low},
      {"mirror", 0, &Nodes::mirror},
      {"cal_s", 0, &Nodes::cal_s},
      {"cal_c", 0, &Nodes::cal_c},
      {"det", 0, &Nodes::det},
      {"saturated_t0", 0, &Nodes::saturated_t0},
      {"relative", 1, &Nodes::relative},
      {"amplitude", 1, &Nodes::amplitude},
      {"zero", 1, &Nodes::zero},
      {"unsettled_t1", 1, &Nodes::unsettled_t1},
      {"saturated_t1", 1, &Nodes::saturated_t1},
      {"reference_phase", 2, &Nodes::reference_phase},
      {"residue", 2, &Nodes::residue},
      {"sine", 2, &Nodes::sine},
      {"cosine", 2, &Nodes::cosine},
      {"next_phase", 2, &Nodes::next_phase},
      {"next_frequency", 2, &Nodes::next_frequency},
      {"turn", 2, &Nodes::turn},
      {"saturated_t2", 2, &Nodes::saturated_t2},
      {"error_u", 3, &Nodes::error_u},
      {"error_v", 3, &Nodes::error_v},
      {"next_a_u", 3, &Nodes::next_a_u},
      {"next_b_u", 3, &Nodes::next_b_u},
      {"next_c_u", 3, &Nodes::next_c_u},
      {"next_a_v", 3, &Nodes::next_a_v},
      {"next_b_v", 3, &Nodes::next_b_v},
      {"next_c_v", 3, &Nodes::next_c_v},
      {"next_average", 3, &Nodes::next_average},
      {"saturated_t3", 3, &Nodes::saturated_t3},
      {"found_phi", 4, &Nodes::found_phi},
      {"found_a1", 4, &Nodes::found_a1},
      {"found_beta", 4, &Nodes::found_beta},
      {"found_a2", 4, &Nodes::found_a2},
      {"found_b1", 4, &Nodes::found_b1},
      {"found_b2", 4, &Nodes::found_b2},
      {"found_angle", 4, &Nodes::found_angle},
      {"saturated", 4, &Nodes::saturated},
      {"deviation", 4, &Nodes::deviation},
      {"travel", 4, &Nodes::travel},
      {"glitches", 4, &Nodes::glitches},
      {"phase", commit_stage, &Nodes::phase},
      {"frequency", commit_stage, &Nodes::frequency},
      {"a_u", commit_stage, &Nodes::a_u},
      {"b_u", commit_stage, &Nodes::b_u},
      {"c_u", commit_stage, &Nodes::c_u},
      {"a_v", commit_stage, &Nodes::a_v},
      {"b_v", commit_stage, &Nodes::b_v},
      {"c_v", commit_stage, &Nodes::c_v},
      {"a1", commit_stage, &Nodes::a1},
      {"a2", commit_stage, &Nodes::a2},
      {"b1", commit_stage, &Nodes::b1},
      {"b2", commit_stage, &Nodes::b2},
      {"beta", commit_stage, &Nodes::beta},
      {"phi", commit_stage, &Nodes::phi},
      {"angle", commit_stage, &Nodes::angle},
      {"error_average", commit_stage, &Nodes::error_average},
      {"status", commit_stage, &Nodes::status},
      {"flags", commit_stage, &Nodes::flags},
      {"samples", commit_stage, &Nodes::samples},
      {"turn_flags", commit_stage, &Nodes::turn_flags},
  }};
  return names;
}

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
  settings_.steps_u = settings_.steps_v = {start_step, start_step, start_step};
  state_ = {};
  state_.coefficients.u.sine = start_weight;
  state_.coefficients.v.cosine = start_weight;
  state_.parameters.a1 = state_.parameters.a2 = start_amplitude;
  results_ = {};
  judge_settings_ = {};
  judge_ = {};
  lock_threshold_ = 1u << 21;
  diverge_threshold_ = 1u << 29;
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
  return (ctrl_ & ctrl_adc) != 0 && latch(cycle, u, v, clip);
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
    datapath_.demodulation(pipe_[3], settings_, state_, frozen(), pending_.learning);
    pipe_[3].next_coefficients =
        pending_.learning.update ? pending_.learning.coefficients : Coefficients{};
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
  pending_.lock = settled && pending_.error_average < lock_threshold_ && !pending_.judge.alarm &&
                  pending_.judge.good_turns >= judge_settings_.turns;
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
  const auto high = [](fixed::int128 x) { return static_cast<int64_t>(x >> 64); };
  const Coefficients& w = packet.next_coefficients;
  const PolarResult& polar = pending_.polar;
  switch (stage) {
    case 0:
      n.u = packet.u;
      n.v = packet.v;
      n.clip = packet.clip;
      n.s_high = high(packet.s);
      n.s_low = static_cast<int64_t>(packet.s);
      n.c_high = high(packet.c);
      n.c_low = static_cast<int64_t>(packet.c);
      n.mirror = packet.mirror;
      n.cal_s = packet.cal_s;
      n.cal_c = packet.cal_c;
      n.det = packet.det;
      n.saturated_t0 = packet.saturated_after[0];
      break;
    case 1:
      n.relative = packet.relative;
      n.amplitude = packet.amplitude;
      n.zero = packet.zero;
      n.unsettled_t1 = packet.unsettled_t1;
      n.saturated_t1 = packet.saturated_after[1];
      break;
    case 2:
      n.reference_phase = packet.reference_phase;
      n.residue = packet.residue;
      n.sine = packet.reference.sine;
      n.cosine = packet.reference.cosine;
      n.next_phase = static_cast<int64_t>(packet.next_reference.phase);
      n.next_frequency = packet.next_reference.frequency;
      n.turn = packet.turn;
      n.saturated_t2 = packet.saturated_after[2];
      break;
    case 3:
      n.error_u = packet.error_u;
      n.error_v = packet.error_v;
      n.next_a_u = w.u.sine;
      n.next_b_u = w.u.cosine;
      n.next_c_u = w.u.constant;
      n.next_a_v = w.v.sine;
      n.next_b_v = w.v.cosine;
      n.next_c_v = w.v.constant;
      n.next_average = packet.next_average;
      n.saturated_t3 = packet.saturated_after[3];
      break;
    default:
      n.found_phi = polar.parameters.phi;
      n.found_a1 = polar.parameters.a1;
      n.found_beta = polar.parameters.beta;
      n.found_a2 = polar.parameters.a2;
      n.found_b1 = polar.parameters.b1;
      n.found_b2 = polar.parameters.b2;
      n.found_angle = polar.angle;
      n.saturated = packet.saturated;
      n.deviation = pending_.judge.deviation;
      n.travel = pending_.judge.travel;
      n.glitches = pending_.judge.glitches;
      break;
  }
}

bool Coprocessor::stage_nodes(unsigned stage, Nodes& nodes) const {
  if (stage >= stage_count || !sequencer_.occupied(stage) || !sequencer_.turns_after(cycle_))
    return false;
  packet_nodes(pipe_[stage], stage, nodes);
  return true;
}

void Coprocessor::record_nodes(const Packet& packet) {
  Nodes& n = nodes_;
  ++n.commits;
  for (unsigned stage = 0; stage < stage_count; ++stage) packet_nodes(packet, stage, n);
  n.phase = static_cast<int64_t>(state_.reference.phase);
  n.frequency = state_.reference.frequency;
  const Coefficients& w = state_.coefficients;
  n.a_u = w.u.sine;
  n.b_u = w.u.cosine;
  n.c_u = w.u.constant;
  n.a_v = w.v.sine;
  n.b_v = w.v.cosine;
  n.c_v = w.v.constant;
  const Parameters& p = state_.parameters;
  n.a1 = p.a1;
  n.a2 = p.a2;
  n.b1 = p.b1;
  n.b2 = p.b2;
  n.beta = p.beta;
  n.phi = p.phi;
  n.angle = results_.angle;
  n.error_average = results_.error_average;
  n.status = status();
  n.flags = flags_;
  n.samples = samples_;
  n.turn_flags = judge_.last.flags | int64_t{judge_.turn_count} << turn_count_shift;
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
