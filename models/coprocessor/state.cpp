// The state of the coprocessor's model, value by value (base/archive.h).
#include <algorithm>

#include "coprocessor/coprocessor.h"

namespace capsoc::coprocessor {

bool Device::change_idle(const IdleChange& change) {
  IdleState state;
  if (!save_idle(state)) return false;
  return !change(state) || load_idle(state);
}

void Weights::visit(Archive& archive) {
  archive("sine", sine);
  archive("cosine", cosine);
  archive("constant", constant);
}

void Coefficients::visit(Archive& archive) {
  archive("u", u);
  archive("v", v);
}

void BlockLearning::visit(Archive& archive) {
  archive("sums", sums);
  archive("open", open);
  archive("begun", begun);
  archive("window_ended", window_ended);
  archive.at_most("unfit", unfit, all_unfit);
}

void Steps::visit(Archive& archive) {
  archive("sine", sine);
  archive("cosine", cosine);
  archive("constant", constant);
}

void Parameters::visit(Archive& archive) {
  archive("a1", a1);
  archive("a2", a2);
  archive("b1", b1);
  archive("b2", b2);
  archive("beta", beta);
  archive("phi", phi);
}

void ReferenceState::visit(Archive& archive) {
  archive("phase", phase);
  archive("frequency", frequency);
}

void Rotation::visit(Archive& archive) {
  archive("sine", sine);
  archive("cosine", cosine);
}

void JudgeSettings::visit(Archive& archive) {
  archive("radius_limit", radius_limit);
  archive("alarm_limit", alarm_limit);
  archive.at_most("turns", turns, 3u);
  archive("count", count);
  archive("turn_limit", turn_limit);
}

void TurnRecord::visit(Archive& archive) {
  archive("radius_max", radius_max);
  archive("residue_max", residue_max);
  archive("winding", winding);
  archive("samples", samples);
  archive("det", det);
  archive("flags", flags);
}

void TurnJudge::visit(Archive& archive) {
  archive("window", window);
  archive("last", last);
  archive("wild", wild);
  archive("turn_count", turn_count);
  archive.at_most("good_turns", good_turns, 3u);
  archive.at_most("glitches", glitches, 16u);
  archive("alarm", alarm);
  archive("any", any);
  archive("last_angle", last_angle);
  archive("deviation", deviation);
  archive("travel", travel);
  archive("ended", ended);
}

void Packet::visit(Archive& archive) {
  archive("taken", taken);
  archive("u", u);
  archive("v", v);
  archive("clip", clip);
  archive("saturated", saturated);
  archive("bad_parity", bad_parity);
  archive("bad_safety", bad_safety);
  archive("s", s);
  archive("c", c);
  archive("cal_s", cal_s);
  archive("cal_c", cal_c);
  archive("det", det);
  archive("mirror", mirror);
  archive("phi", phi);
  archive("relative", relative);
  archive("amplitude", amplitude);
  archive("zero", zero);
  archive("unsettled_t1", unsettled_t1);
  archive("unsettled", unsettled);
  archive("reference_phase", reference_phase);
  archive("residue", residue);
  archive("reference", reference);
  archive("hold_weights", hold_weights);
  archive("next_reference", next_reference);
  archive("turn", turn);
  archive("error_u", error_u);
  archive("error_v", error_v);
  archive("misfit", misfit);
  archive("next_coefficients", next_coefficients);
  archive("next_average", next_average);
  archive("saturated_after", saturated_after);
}

void Settings::visit(Archive& archive) {
  archive("demodulate", demodulate);
  archive.at_most("source", source, ReferenceSource::angle);
  archive.at_most("kp", kp, 31u);
  archive.at_most("ki", ki, 31u);
  archive("steps_u", steps_u);
  archive("steps_v", steps_v);
  archive.at_most("slew", slew, 7u);
  archive("block", block);
  archive("guard", guard);
  archive("correct", correct);
}

void State::visit(Archive& archive) {
  archive("coefficients", coefficients);
  archive("parameters", parameters);
  archive("reference", reference);
  archive("error_sum_u", error_sum_u);
  archive("error_sum_v", error_sum_v);
  archive("block", block);
}

void Learning::visit(Archive& archive) {
  archive("update", update);
  archive("sum", sum);
  archive("coefficients", coefficients);
  archive("error_sum_u", error_sum_u);
  archive("error_sum_v", error_sum_v);
}

void PolarResult::visit(Archive& archive) {
  archive("parameters", parameters);
  archive("angle", angle);
}

void Sequencer::visit(Archive& archive) {
  archive("running", running_);
  archive("boundary", boundary_);
  archive("held", held_);
  archive("load_pending", load_pending_);
  archive("load_stage", load_stage_);
  archive("occupied", occupied_);
  if (load_stage_ && *load_stage_ >= load_stage_count) archive.refuse("has no such load stage");
}

void Sequencer::visit_channels(Archive& archive, const Selection& selection, unsigned last) {
  selection_ = selection;
  archive.at_most("held_channel", held_channel_, last);
  archive("changing", changing_);
  archive.at_most("target", target_, last);
}

void Selection::visit(Archive& archive) {
  archive("active", active);
  archive("window", window);
  archive("hold", hold);
}

void Results::visit(Archive& archive) {
  archive("raw_u", raw_u);
  archive("raw_v", raw_v);
  archive("cal_s", cal_s);
  archive("cal_c", cal_c);
  archive("angle", angle);
  archive("error_u", error_u);
  archive("error_v", error_v);
  archive("residue", residue);
  archive("reference_phase", reference_phase);
  archive("amplitude", amplitude);
  archive("error_average", error_average);
  archive("lock", lock);
  archive("diverged", diverged);
  archive("mirror", mirror);
  archive("valid", valid);
}

void Coprocessor::Pending::visit(Archive& archive) {
  archive("reference", reference);
  archive("steer_frequency", steer_frequency);
  archive("learning", learning);
  archive("polar", polar);
  archive("keep_parameters", keep_parameters);
  archive("calibrate", calibrate);
  archive("findings", findings);
  archive("lock", lock);
  archive("diverged", diverged);
  archive("judge", judge);
  archive("error_average", error_average);
  archive("load_rotation", load_rotation);
  archive("load_weights", load_weights);
  archive("bad_parity", bad_parity);
}

void IdleState::visit(Archive& archive) {
  archive("cycle", cycle);
  archive("ctrl", ctrl);
  archive("flags", flags);
  archive("settings", settings);
  archive("state", state);
  archive("results", results);
  archive("judge_settings", judge_settings);
  archive("judge", judge);
  archive("lock_threshold", lock_threshold);
  archive("diverge_threshold", diverge_threshold);
  archive("soft_u", soft_u);
  archive("safety", safety);
  archive("unfit", unfit);
  if ((unfit & ~parity_bits) != 0) archive.refuse("has a parity bit of no such register");
  archive("samples", samples);
  archive("early_count", early_count);
  archive.at_most("settled", settled, 64u);
  archive("staged_low", staged_low);
  archive("latched_low", latched_low);
  archive("corrections", corrections);
  const auto fits = [](int32_t value) {
    return fixed::sign_extend<20>(static_cast<uint32_t>(value)) == value;
  };
  if (!std::all_of(corrections.begin(), corrections.end(), fits))
    archive.refuse("has a correction that does not fit 20 bits");
  archive("unfit_corrections", unfit_corrections);
  archive("nodes", nodes);
  if (contexts.empty()) return;
  const std::size_t channels = contexts.size();
  archive("selection", selection);
  archive("refused", refused);
  archive.sequence("contexts", contexts, channels);
  if (contexts.size() != channels || selection.active >= channels || selection.window >= channels)
    archive.refuse("has another number of channels");
}

void Coprocessor::visit(Archive& archive) {
  arch_.selection = sequencer_.selection();
  arch_.visit(archive);
  archive("sequencer", sequencer_);
  if (options_.channels > 1) sequencer_.visit_channels(archive, arch_.selection, channels() - 1);
  archive("held", held_);
  archive("pipe", pipe_);
  archive("load_rotation", load_rotation_);
  archive("pending", pending_);
}

bool Coprocessor::save_idle(IdleState& state) const {
  if (!idle()) return false;
  state = arch_;
  state.selection = sequencer_.selection();
  return true;
}

bool Coprocessor::load_idle(const IdleState& state) {
  if (state.contexts.size() != arch_.contexts.size()) return false;
  sequencer_.restore(state.selection);
  arch_ = state;
  held_ = {};
  pipe_ = {};
  load_rotation_ = {};
  pending_ = {};
  return true;
}

}  // namespace capsoc::coprocessor
