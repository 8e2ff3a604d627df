#include "regress/recording.h"

#include "coprocessor/register_map.h"

namespace capsoc::regress {

using namespace coprocessor;

const std::array<uint32_t, 46> look_offsets = {reg_ctrl,
                                               reg_status,
                                               reg_flags,
                                               reg_freq_hi,
                                               reg_phase_hi,
                                               reg_step_au,
                                               0x2C,
                                               0x30,
                                               0x34,
                                               0x38,
                                               reg_step_cv,
                                               reg_loop,
                                               reg_lock_threshold,
                                               reg_diverge_threshold,
                                               reg_error_average,
                                               0x54,
                                               0x5C,
                                               0x64,
                                               0x6C,
                                               0x74,
                                               reg_cv_hi,
                                               reg_a1,
                                               reg_a2,
                                               reg_b1,
                                               reg_b2,
                                               reg_beta,
                                               reg_phi,
                                               reg_raw_u,
                                               reg_raw_v,
                                               reg_cal_s,
                                               reg_cal_c,
                                               reg_angle,
                                               reg_err_u,
                                               reg_err_v,
                                               reg_residue,
                                               reg_samples,
                                               reg_ref_phase,
                                               reg_amplitude,
                                               reg_judge,
                                               reg_turn_limit,
                                               reg_turn_flags,
                                               reg_radius_max,
                                               reg_residue_max,
                                               reg_winding,
                                               reg_turn_samples,
                                               reg_turn_det};

Recorder::Recorder(const Options& options, Recording& recording)
    : model_(options), recording_(recording) {}

// Whatever else happens at an edge, what it leaves is complete when time moves on.
void Recorder::close() {
  if (model_.interrupt() != interrupt_ || model_.idle() != idle_) {
    interrupt_ = model_.interrupt();
    idle_ = model_.idle();
    recording_.events.push_back({Event::Kind::level, edge_, 0, 0, interrupt_, idle_});
  }
  if (model_.nodes().commits == commits_) return;
  commits_ = model_.nodes().commits;
  recording_.events.push_back(
      {Event::Kind::look, edge_, static_cast<uint32_t>(recording_.words.size())});
  for (uint32_t offset : look_offsets)
    recording_.words.push_back(model_.read(edge_, offset, true).value);
}

void Recorder::reset() {
  model_.reset();
  recording_.events.push_back({Event::Kind::reset, edge_});
}

void Recorder::advance(uint64_t cycle) {
  if (cycle > edge_) {
    close();
    edge_ = cycle;
  }
  model_.advance(cycle);
}

bool Recorder::submit(uint64_t cycle, int32_t u, int32_t v, bool clip) {
  advance(cycle);
  const bool latched = model_.submit(cycle, u, v, clip);
  recording_.events.push_back({Event::Kind::sample, cycle, static_cast<uint32_t>(u),
                               static_cast<uint32_t>(v), clip, latched});
  return latched;
}

RegisterAccess Recorder::read(uint64_t cycle, uint32_t offset, bool debug) {
  advance(cycle);
  const RegisterAccess access = model_.read(cycle, offset, debug);
  if (!debug)
    recording_.events.push_back({Event::Kind::read, cycle, offset, access.value, false, access.ok});
  return access;
}

bool Recorder::write(uint64_t cycle, uint32_t offset, uint32_t value) {
  advance(cycle);
  const bool ok = model_.write(cycle, offset, value);
  recording_.events.push_back({Event::Kind::write, cycle, offset, value, false, ok});
  return ok;
}

}  // namespace capsoc::regress
