#include "coprocessor/coprocessor.h"

#include <algorithm>
#include <utility>

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

// Parity bits of registers that the pipeline writes together.
constexpr uint64_t weights_u_parity =
    parity_bit(reg_au_lo) | parity_bit(reg_bu_lo) | parity_bit(reg_cu_lo);
constexpr uint64_t weights_v_parity =
    parity_bit(reg_av_lo) | parity_bit(reg_bv_lo) | parity_bit(reg_cv_lo);
constexpr uint64_t parameters_parity = parity_bit(reg_a1) | parity_bit(reg_a2) |
                                       parity_bit(reg_b1) | parity_bit(reg_b2) |
                                       parity_bit(reg_beta) | parity_bit(reg_phi);

// Whether a word of `width` bits keeps its value without its upper `n` bits; the sign stays.
bool fits(int32_t value, unsigned width, unsigned n) {
  const unsigned kept = width - std::min(n, width - 1);
  const int32_t upper = value >> (kept - 1);
  return upper == 0 || upper == -1;
}

uint32_t error_limit(uint32_t safety) {
  return field(safety, safety_error_limit_mask);
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

IdleState power_on_state() {
  IdleState start;
  start.settings.steps_u = start_steps_u;
  start.settings.steps_v = start_steps_v;
  start.state.block.window_ended = true;  // the first sample begins a window
  start.state.coefficients.u.sine =
      start_weight(description::AU_HI_reset, description::AU_LO_reset);
  start.state.coefficients.v.cosine =
      start_weight(description::BV_HI_reset, description::BV_LO_reset);
  start.state.parameters.a1 = static_cast<int32_t>(description::A1_reset);
  start.state.parameters.a2 = static_cast<int32_t>(description::A2_reset);
  start.lock_threshold = description::LOCK_THRESHOLD_reset;
  start.diverge_threshold = description::DIVERGE_THRESHOLD_reset;
  return start;
}

Options checked(Options options) {
  options.channels = std::clamp(options.channels, 1, static_cast<int>(most_channels));
  options.paper_operand_bits = std::clamp(options.paper_operand_bits, 2, 32);
  options.paper_reference_lead = std::clamp(options.paper_reference_lead, -1024, 1024);
  options.paper_step_shift = std::clamp(options.paper_step_shift, 0, 31);
  options.paper_iteration_clocks = std::clamp(options.paper_iteration_clocks, 1, 2);
  if (options.arithmetic == Arithmetic::paper)
    options.block_learning = options.harmonic_correction = false;
  else
    options.paper_iteration_clocks = 1;
  return options;
}

}  // namespace

Coprocessor::Coprocessor(Options options)
    : options_(checked(options)),
      datapath_(options_),
      sequencer_(tick_cycles * static_cast<unsigned>(options_.paper_iteration_clocks)) {
  reset();
}

void Coprocessor::reset() {
  const unsigned count = channels();
  if (count > 1 && arch_.contexts.empty()) arch_.contexts.resize(count);
  unsigned active = sequencer_.active();
  for (unsigned i = 0; i < count; ++i) {
    soft_reset();
    const unsigned next = (active + 1) % count;
    if (next != active) change_context(active, next);
    active = next;
  }
  if (active != 0) change_context(active, 0);
  sequencer_.reset();
  arch_.refused = false;
}

void Coprocessor::soft_reset() {
  sequencer_.clear_active();
  IdleState start = power_on_state();
  start.cycle = arch_.cycle;
  start.corrections = arch_.corrections;  // a memory without a reset
  start.unfit_corrections = arch_.unfit_corrections;
  start.contexts = std::move(arch_.contexts);
  start.refused = arch_.refused;
  arch_ = std::move(start);
}

IdleState& Coprocessor::context(unsigned channel) {
  return channel == sequencer_.active() ? arch_ : arch_.contexts[channel];
}

const IdleState& Coprocessor::context(unsigned channel) const {
  return channel == sequencer_.active() ? arch_ : arch_.contexts[channel];
}

// What is not of a channel stays where it is.
void Coprocessor::change_context(unsigned from, unsigned to) {
  IdleState next = std::move(arch_.contexts[to]);
  next.cycle = arch_.cycle;
  next.nodes = arch_.nodes;
  next.refused = arch_.refused;
  next.contexts = std::move(arch_.contexts);
  next.contexts[to] = {};
  arch_.cycle = 0;
  arch_.nodes = {};
  arch_.refused = false;
  arch_.contexts.clear();
  next.contexts[from] = std::move(arch_);
  arch_ = std::move(next);
}

void Coprocessor::advance(uint64_t cycle) {
  arch_.cycle = std::max(arch_.cycle, cycle);
  while (sequencer_.due(cycle)) {
    const uint64_t unfit = arch_.unfit;
    commit_tick();
    sequencer_.turn();
    if (const auto left = sequencer_.left()) change_context(*left, sequencer_.active());
    start_tick(unfit);
  }
}

bool Coprocessor::submit_of(unsigned channel, uint64_t cycle, int32_t u, int32_t v, bool clip) {
  advance(cycle);
  if (channel >= channels() || (context(channel).ctrl & ctrl_adc) == 0 ||
      !latch(channel, cycle, u, v, clip))
    return false;
  held_.taken = cycle;
  return true;
}

bool Coprocessor::latch(unsigned channel, uint64_t cycle, int32_t u, int32_t v, bool clip) {
  if (!sequencer_.latch(cycle, channel)) {
    IdleState& registers = context(channel);
    if (registers.early_count != UINT32_MAX) ++registers.early_count;
    registers.flags |= flag_early;
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
void Coprocessor::start_tick(uint64_t unfit) {
  for (unsigned stage = stage_count - 1; stage > 0; --stage)
    if (sequencer_.occupied(stage)) pipe_[stage] = pipe_[stage - 1];
  if (sequencer_.entered()) {
    pipe_[0] = held_;
    datapath_.products(pipe_[0], arch_.state);
    pipe_[0].saturated_after[0] = pipe_[0].saturated;
  }
  if (sequencer_.occupied(1)) {
    datapath_.relative_angle(pipe_[1]);
    if (arch_.settings.correct) {
      const uint32_t phi = arch_.state.parameters.phi;
      if (reads_one(arch_.unfit_corrections, pipe_[1].relative, phi)) pipe_[1].bad_parity = true;
      pipe_[1].relative = corrected_angle(arch_.corrections, pipe_[1].relative, phi);
    }
    pipe_[1].saturated_after[1] = pipe_[1].saturated;
  }
  if (sequencer_.occupied(2)) {
    datapath_.reference(pipe_[2], arch_.settings, arch_.state, pending_.reference);
    pipe_[2].next_reference = pending_.reference;
    if (arch_.settings.source != ReferenceSource::tracking) pipe_[2].next_reference.frequency = 0;
    pipe_[2].saturated_after[2] = pipe_[2].saturated;
    pending_.steer_frequency = arch_.settings.source == ReferenceSource::tracking;
  }
  if (sequencer_.occupied(3)) {
    const bool learns = arch_.settings.demodulate && !frozen() && !pipe_[3].hold_weights;
    const LearningPlan plan =
        plan_learning(arch_.state.block, arch_.settings, learns, arch_.judge.last.flags);
    if (plan.from_sums && arch_.state.block.unfit != 0) pipe_[3].bad_parity = true;
    datapath_.demodulation(pipe_[3], arch_.settings, arch_.state, plan, pending_.learning);
    pipe_[3].next_coefficients =
        plan.update || plan.sum ? pending_.learning.coefficients : Coefficients{};
    pipe_[3].next_average =
        error_average(std::max(pending_.learning.error_sum_u, pending_.learning.error_sum_v));
    pipe_[3].misfit = !fits(pipe_[3].error_u, 32, error_limit(arch_.safety)) ||
                      !fits(pipe_[3].error_v, 32, error_limit(arch_.safety));
    pipe_[3].saturated_after[3] = pipe_[3].saturated;
  }
  pending_.bad_parity = (arch_.safety & safety_bad_parity) != 0;
  if (unfit != 0 || marks_coefficients()) {
    for (unsigned stage = 0; stage < stage_count; ++stage) {
      if (!sequencer_.occupied(stage)) continue;
      pipe_[stage].bad_parity = true;
      if ((unfit & parity_bit(reg_safety)) != 0) pipe_[stage].bad_safety = true;
    }
  }
  if (sequencer_.occupied(4)) start_results(pipe_[4]);
  if (const auto stage = sequencer_.load_stage()) start_load(*stage);
}

bool Coprocessor::marks_coefficients() const {
  return pending_.bad_parity && sequencer_.occupied(3) && pending_.learning.update;
}

void Coprocessor::commit_tick() {
  if (sequencer_.occupied(2)) {
    arch_.state.reference.phase = pending_.reference.phase;
    written(parity_bit(reg_phase_lo));
    // Only the tracking source owns the frequency: otherwise a word that software wrote in the
    // course of this tick would be lost.
    if (pending_.steer_frequency) {
      arch_.state.reference.frequency = pending_.reference.frequency;
      written(parity_bit(reg_freq_lo));
    }
  }
  if (sequencer_.occupied(3)) {
    if (pending_.learning.update) {
      arch_.state.coefficients = pending_.learning.coefficients;
      written(weights_u_parity | weights_v_parity);
    }
    BlockLearning& block = arch_.state.block;
    if (pending_.learning.sum) {
      block.sums = pending_.learning.coefficients;
      block.unfit = pending_.bad_parity ? BlockLearning::all_unfit : 0;
    }
    if (!block.begun) {
      block.sums = {};
      block.unfit = 0;
    }
    arch_.state.error_sum_u = pending_.learning.error_sum_u;
    arch_.state.error_sum_v = pending_.learning.error_sum_v;
  }
  if (sequencer_.occupied(4)) commit_results(pipe_[4]);
  if (const auto stage = sequencer_.load_stage()) commit_load(*stage);
}

void Coprocessor::start_load(unsigned stage) {
  const Parameters& p = arch_.state.parameters;
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
  if (stage == 1) {
    arch_.state.coefficients.u = pending_.load_weights;
    written(weights_u_parity);
  }
  if (stage == 2) {
    arch_.state.coefficients.v = pending_.load_weights;
    written(weights_v_parity);
  }
}

void Coprocessor::start_results(Packet& packet) {
  pending_.polar = datapath_.parameters(packet, arch_.settings, arch_.state);
  pending_.keep_parameters = !arch_.settings.demodulate;
  pending_.calibrate = (arch_.ctrl & ctrl_calib) != 0;
  pending_.error_average =
      error_average(std::max(arch_.state.error_sum_u, arch_.state.error_sum_v));
  const bool settled = arch_.settled + 1 >= settling_samples;
  const JudgedSample judged = {packet.amplitude,
                               packet.det,
                               packet.residue,
                               pending_.polar.angle,
                               packet.clip,
                               packet.saturated,
                               packet.zero || packet.unsettled,
                               packet.mirror,
                               packet.turn};
  pending_.judge = judge(arch_.judge, judged, arch_.judge_settings,
                         arch_.settings.source != ReferenceSource::numeric);
  pending_.findings = findings(packet, angle_step(arch_.judge, pending_.polar.angle));
  pending_.lock = settled && pending_.error_average < arch_.lock_threshold &&
                  pending_.judge.permits_lock(arch_.judge_settings.turns);
  pending_.diverged = settled && pending_.error_average > arch_.diverge_threshold;
}

uint32_t Coprocessor::findings(const Packet& packet, int32_t step) const {
  const uint32_t found =
      (packet.bad_parity ? safety_parity : 0) | (packet.misfit ? safety_misfit : 0) |
      (fits(step, 30, field(arch_.safety, safety_step_limit_mask)) ? 0 : safety_jump) |
      safety_missed;  // unless software takes the last result before this one comes
  return (found & arch_.safety) | (packet.bad_safety ? safety_parity : 0);
}

void Coprocessor::commit_results(const Packet& packet) {
  Results& r = arch_.results;
  const uint32_t taken = (arch_.flags & flag_result) != 0 ? 0 : safety_missed;
  arch_.flags |= (pending_.findings & ~taken) << flags_safety_shift;
  arch_.flags |= flag_result;
  if (packet.clip) arch_.flags |= flag_clip;
  if (packet.saturated) arch_.flags |= flag_sat;
  if (packet.zero) arch_.flags |= flag_zero;
  if (packet.unsettled) arch_.flags |= flag_unsettled;
  if (pending_.diverged) arch_.flags |= flag_diverged;
  if (pending_.lock != r.lock) arch_.flags |= flag_lockchg;
  if (packet.mirror != r.mirror) arch_.flags |= flag_mirrorchg;
  arch_.judge = pending_.judge;
  arch_.state.block.window_ended = arch_.judge.ended;
  if (arch_.judge.ended) arch_.flags |= flag_turn;
  if (arch_.judge.alarm) arch_.flags |= flag_alarm;
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
  r.valid =
      pending_.calibrate && !packet.zero && !packet.unsettled && (arch_.flags & flags_safety) == 0;
  if (r.valid) r.angle = pending_.polar.angle;
  if (!pending_.keep_parameters) {
    arch_.state.parameters = pending_.polar.parameters;
    written(parameters_parity);
  }
  ++arch_.samples;
  arch_.settled = std::min(arch_.settled + 1, settling_samples);
  record_nodes(packet);
}

void Coprocessor::packet_nodes(const Packet& packet, unsigned stage, Nodes& n) const {
  const auto upper_half = [](fixed::int128 x) { return static_cast<int64_t>(x >> 64); };
#define NODE(name, made_in, unit, format, model, when, rtl) \
  if (stage == (made_in)) n.name = static_cast<int64_t>(model);
#include "coprocessor/nodes.def"
}

bool Coprocessor::stage_nodes(unsigned stage, Nodes& nodes) const {
  if (stage >= stage_count || !sequencer_.occupied(stage) || !sequencer_.turns_after(arch_.cycle))
    return false;
  packet_nodes(pipe_[stage], stage, nodes);
  return true;
}

void Coprocessor::record_nodes(const Packet& packet) {
  ++arch_.nodes.commits;
  arch_.nodes.taken = packet.taken;
  arch_.nodes.channel = sequencer_.active();
  for (unsigned stage = 0; stage <= commit_stage; ++stage) packet_nodes(packet, stage, arch_.nodes);
}

bool Coprocessor::frozen() const {
  return (arch_.ctrl & ctrl_freeze) != 0 && (arch_.flags & flag_alarm) != 0;
}

bool Coprocessor::raises(const IdleState& s) {
  return ((s.flags & flag_result) && (s.ctrl & ctrl_ie_result)) ||
         ((s.flags & flag_lockchg) && (s.ctrl & ctrl_ie_lock)) ||
         ((s.flags & flags_error) && (s.ctrl & ctrl_ie_error)) ||
         ((s.flags & flag_turn) && (s.ctrl & ctrl_ie_turn)) ||
         ((s.flags & flag_alarm) && (s.ctrl & ctrl_ie_alarm)) ||
         ((s.flags & flags_safety) && (s.ctrl & ctrl_ie_safety));
}

bool Coprocessor::interrupt() const {
  return raises(arch_) || std::any_of(arch_.contexts.begin(), arch_.contexts.end(), raises);
}

}  // namespace capsoc::coprocessor
