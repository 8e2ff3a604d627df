#include "coprocessor/datapath.h"

#include "coprocessor/calibrator.h"
#include "coprocessor/lms_demodulator.h"
#include "coprocessor/paper_units.h"
#include "coprocessor/polar_unit.h"

namespace capsoc::coprocessor {

using fixed::round_shift;
using fixed::saturate32;

Rotation Datapath::rotation(uint64_t phase) const {
  return paper() ? rotate_paper(phase) : rotate(phase);
}

void Datapath::products(Packet& packet, const State& state) const {
  const Calibrated calibrated = paper() ? calibrate_paper(packet.u, packet.v, state.parameters)
                                        : calibrate(packet.u, packet.v, state.coefficients);
  packet.s = calibrated.s;
  packet.c = calibrated.c;
  packet.mirror = calibrated.mirror;
  packet.det = calibrated.det;
  packet.saturated |= calibrated.saturated;
  packet.phi = state.parameters.phi;
  const unsigned shift = paper() ? 0 : 31;
  packet.cal_s = saturate32(round_shift(packet.s, shift), packet.saturated);
  packet.cal_c = saturate32(round_shift(packet.c, shift), packet.saturated);
}

void Datapath::relative_angle(Packet& packet) const {
  if (paper()) {
    packet.zero = packet.cal_s == 0 && packet.cal_c == 0;
    const paper::Polar polar = paper::to_polar(
        packet.cal_s, packet.cal_c, options_.paper_operand_bits, options_.paper_plain_arctangent);
    packet.relative = polar.angle - packet.phi;
    packet.amplitude = polar.magnitude;
    packet.unsettled_t1 = packet.unsettled = !polar.settled;
    return;
  }
  const Polar polar = to_polar(packet.s, packet.c, 62);
  packet.zero = polar.zero;
  packet.relative = polar.angle;
  packet.amplitude = polar.magnitude;
  packet.saturated |= polar.saturated;
}

void Datapath::reference(Packet& packet, const Settings& settings, const State& state,
                         ReferenceState& next) const {
  const bool angle_source = settings.source == ReferenceSource::angle;
  uint64_t phase = angle_source ? to_phase48(packet.relative) : state.reference.phase;
  packet.reference_phase = upper_phase(phase);
  packet.residue = packet.zero ? 0 : static_cast<int32_t>(packet.relative - packet.reference_phase);
  packet.hold_weights = angle_source && packet.zero;
  packet.turn = settings.source != ReferenceSource::tracking && completes_turn(state.reference);
  if (paper() && !angle_source) {
    // Table 8's phi: data that reach the demodulator some samples after their reference.
    phase += static_cast<uint64_t>(options_.paper_reference_lead * state.reference.frequency);
  }
  packet.reference = rotation(phase & phase_mask);
  next = next_reference(state.reference, settings.source, packet.residue, settings.kp, settings.ki,
                        packet.saturated);
}

LearningPlan plan_learning(BlockLearning& block, const Settings& settings, bool learns,
                           uint32_t turn_flags) {
  const bool ended = block.window_ended;
  block.window_ended = false;
  if (!settings.block) {
    block.open = block.begun = false;
    return {learns, false, false};
  }
  LearningPlan plan;
  plan.from_sums = block.begun;
  if (ended) {
    const bool counts =
        settings.guard ? (turn_flags & turn_good) != 0 : (turn_flags & turn_timeout) == 0;
    plan.update = learns && block.begun && counts;
    block.open = true;
    block.begun = false;
  } else {
    plan.sum = learns && block.open;
    if (plan.sum) block.begun = true;
  }
  return plan;
}

void Datapath::demodulation(Packet& packet, const Settings& settings, const State& state,
                            const LearningPlan& plan, Learning& next) const {
  const Coefficients& base = plan.from_sums ? state.block.sums : state.coefficients;
  const auto channel = [&](const Weights& weights, const Weights& sums, const Steps& steps,
                           int32_t data) {
    return paper() ? demodulate_paper(weights, steps, data, packet.reference,
                                      options_.paper_step_shift, settings.slew)
                   : demodulate(weights, sums, steps, data, packet.reference, settings.slew);
  };
  const Demodulation u = channel(state.coefficients.u, base.u, settings.steps_u, packet.u);
  const Demodulation v = channel(state.coefficients.v, base.v, settings.steps_v, packet.v);
  packet.error_u = u.error;
  packet.error_v = v.error;
  packet.saturated |= u.error_saturated || v.error_saturated;
  next.error_sum_u = next_error_sum(state.error_sum_u, u.error);
  next.error_sum_v = next_error_sum(state.error_sum_v, v.error);
  next.update = plan.update;
  next.sum = plan.sum;
  if (!plan.update && !plan.sum) return;
  next.coefficients = {u.weights, v.weights};
  packet.saturated |= u.weights_saturated || v.weights_saturated;
}

PolarResult Datapath::parameters(Packet& packet, const Settings& settings,
                                 const State& state) const {
  const Coefficients& w = state.coefficients;
  PolarResult out;
  if (paper()) {
    const auto word = paper_word;
    const auto negated = [&](int64_t weight) {
      return saturate32(-int64_t{word(weight)}, packet.saturated);
    };
    out.parameters.b1 = word(w.u.constant);
    out.parameters.b2 = word(w.v.constant);
    const auto polar = [&](int32_t y, int32_t x) {
      return paper::to_polar(y, x, options_.paper_operand_bits, options_.paper_plain_arctangent);
    };
    out.parameters.a1 = paper::amplitude(word(w.u.sine), word(w.u.cosine), packet.saturated);
    out.parameters.a2 = paper::amplitude(word(w.v.sine), word(w.v.cosine), packet.saturated);
    const paper::Polar u = polar(word(w.u.cosine), word(w.u.sine));
    const paper::Polar v = polar(negated(w.v.sine), word(w.v.cosine));
    out.parameters.phi = u.angle;
    out.parameters.beta = v.angle - u.angle;
    packet.unsettled |= settings.demodulate && !(u.settled && v.settled);
    out.angle = packet.relative + packet.phi;
    return out;
  }
  out.parameters.b1 = saturate32(weight_q31(w.u.constant), packet.saturated);
  out.parameters.b2 = saturate32(weight_q31(w.v.constant), packet.saturated);
  const Polar u = to_polar(w.u.cosine, w.u.sine, 46);
  const Polar v = to_polar(-w.v.sine, w.v.cosine, 46);
  packet.saturated |= u.saturated || v.saturated;
  out.parameters.a1 = u.magnitude;
  out.parameters.a2 = v.magnitude;
  out.parameters.phi = u.angle;
  out.parameters.beta = v.angle - u.angle;
  out.angle = packet.relative + u.angle;
  return out;
}

}  // namespace capsoc::coprocessor
