#include "regress/recording.h"

#include <algorithm>

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

Recorder::Recorder(const Options& options, Recording& recording, Looks looks)
    : model_(options), recording_(recording), looks_(looks) {}

// Whatever else happens at an edge, what it leaves is complete when time moves on.
void Recorder::close() {
  if (model_.interrupt() != interrupt_ || model_.idle() != idle_) {
    interrupt_ = model_.interrupt();
    idle_ = model_.idle();
    recording_.events.push_back({Event::Kind::level, edge_, 0, 0, interrupt_, idle_});
  }
  if (model_.nodes().commits == commits_) return;
  commits_ = model_.nodes().commits;
  if (looks_ == Looks::as_reads) {
    pending_looks_ = look_offsets.size();
    return;
  }
  recording_.events.push_back(
      {Event::Kind::look, edge_, static_cast<uint32_t>(recording_.words.size())});
  for (uint32_t offset : look_offsets)
    recording_.words.push_back(model_.read(edge_, offset, true).value);
}

// Every result in turn. The transfer at edge `until` may be a write, whose access and setup phases
// are the two intervals before it; and the read of a HI word fills a latch, so it is left out.
void Recorder::read_results(uint64_t until) {
  for (uint64_t at = std::max(edge_, bus_free_); pending_looks_ > 0 && at + 3 <= until; at += 2) {
    uint32_t offset = 0;
    do {
      offset = look_offsets[next_look_++ % look_offsets.size()];
      --pending_looks_;
    } while (is_pair(offset) && pending_looks_ > 0);
    if (is_pair(offset)) return;
    model_.advance(at);
    const RegisterAccess access = model_.read(at, offset, true);
    recording_.events.push_back({Event::Kind::read, at, offset, access.value, false, access.ok});
    bus_free_ = at + 2;
  }
}

void Recorder::reset() {
  bus_free_ = edge_ + 2;
  model_.reset();
  recording_.events.push_back({Event::Kind::reset, edge_});
}

void Recorder::advance(uint64_t cycle) {
  if (cycle > edge_) {
    close();
    if (looks_ == Looks::as_reads) read_results(cycle);
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
  if (!debug) bus_free_ = cycle + 2;
  if (!debug)
    recording_.events.push_back({Event::Kind::read, cycle, offset, access.value, false, access.ok});
  return access;
}

bool Recorder::write(uint64_t cycle, uint32_t offset, uint32_t value) {
  return write_bytes(cycle, offset, value, all_strobes);
}

bool Recorder::write_bytes(uint64_t cycle, uint32_t offset, uint32_t value, uint8_t strobes) {
  advance(cycle);
  const bool ok = model_.write_bytes(cycle, offset, value, strobes);
  bus_free_ = cycle + 1;
  recording_.events.push_back({Event::Kind::write, cycle, offset, value, false, ok, strobes});
  return ok;
}

}  // namespace capsoc::regress
