// What the bench has seen, told to the coverage.
#include <algorithm>
#include <array>
#include <utility>

#include "base/fixed.h"
#include "capsoc_registers.h"
#include "coprocessor/register_map.h"
#include "regress/bench.h"

namespace capsoc::regress {

using namespace coprocessor;

namespace {

constexpr uint32_t quadrant(uint64_t angle) {
  return static_cast<uint32_t>(angle >> 30) & 3;
}

size_t loop_class(unsigned shift) {
  return shift == 0 ? 0 : shift < 16 ? 1 : shift == 16 ? 2 : shift < 31 ? 3 : 4;
}

bool is_step(uint32_t offset) {
  return offset >= reg_step_au && offset <= reg_step_cv;
}

constexpr int64_t weight_top = (int64_t{1} << 47) - 1;

}  // namespace

size_t Bench::moment() const {
  if (shadow_.load_stage()) return 10 + *shadow_.load_stage();
  unsigned occupied = 0, stage = 0;
  for (unsigned s = 0; s < stage_count; ++s)
    if (shadow_.occupied(s)) {
      ++occupied;
      stage = s;
    }
  if (load_waits_) return 9;
  if (occupied == 0) return held_ ? 1 : 0;
  if (occupied == 1) return 2 + stage;
  return occupied == stage_count ? 7 : 8;
}

void Bench::cover_commit() {
  const Nodes& n = device_.nodes();
  ++counts_.commits;
  if (since_reset_ < 64) ++since_reset_;
  coverage_.hit_if(since_reset_ == 63, Group::event, 8);
  coverage_.hit_if(since_reset_ == 64, Group::event, 9);
  coverage_.hit(Group::sample_quadrant, n.u >= 0 ? (n.v >= 0 ? 0 : 1) : (n.v < 0 ? 2 : 3));
  const auto relative = static_cast<uint64_t>(n.relative);
  coverage_.hit(Group::relative_quadrant, quadrant(relative));
  coverage_.hit(Group::angle_quadrant, quadrant(static_cast<uint64_t>(n.angle)));
  coverage_.hit(Group::phi_quadrant, quadrant(static_cast<uint64_t>(n.phi)));
  coverage_.hit(Group::beta_quadrant, quadrant(static_cast<uint64_t>(n.beta)));
  constexpr uint64_t half = uint64_t{1} << 31, turn = half * 2, near = 1 << 16;
  coverage_.hit_if(relative < half && half - relative < near, Group::seam, 0);
  coverage_.hit_if(relative >= half && relative - half < near, Group::seam, 1);
  coverage_.hit_if(turn - relative < near, Group::seam, 2);
  coverage_.hit_if(relative < near, Group::seam, 3);
  cover_saturation(n);
  cover_ties(n);
  cover_safety(n, flags_);
  cover_flags(static_cast<uint32_t>(n.flags));
  cover_judge(n);
  cover_slew(n);

  const auto status = static_cast<uint32_t>(n.status);
  const unsigned source = field(ctrl_, ctrl_ref_mask);
  coverage_.hit(Group::mode, source * 4 + (ctrl_ & 1) + ((ctrl_ >> 1) & 1) * 2);
  coverage_.hit_if(n.zero != 0, Group::event, source);
  coverage_.hit((Group::event), (status & status_mirror) != 0 ? 3 : 4);
  const uint32_t changed = status ^ status_;
  coverage_.hit_if((changed & status & status_lock) != 0, Group::event, 5);
  coverage_.hit_if((changed & ~status & status_lock) != 0, Group::event, 6);
  coverage_.hit_if((status & status_diverged) != 0, Group::event, 7);
  coverage_.hit_if((changed & ~status & status_valid) != 0, Group::event, 10);
  status_ = status;
  if (edge_ > settled_at_ + latency()) {
    coverage_.hit_if(source == 1, Group::loop, loop_class(field(loop_, description::LOOP_KP_mask)));
    coverage_.hit_if(source == 1, Group::loop,
                     5 + loop_class(field(loop_, description::LOOP_KI_mask)));
    for (unsigned i = 0; i < steps_.size() && (ctrl_ & ctrl_demod) != 0; ++i) {
      const uint32_t step = steps_[i];
      if (step < 2) coverage_.hit(Group::step, i * 3 + step);
      if (step == INT32_MAX) coverage_.hit(Group::step, i * 3 + 2);
    }
  }
  const int64_t a1 = n.a1;
  coverage_.hit(Group::magnitude, a1 == 0           ? 0
                                  : a1 < 2048       ? 1
                                  : a1 < 21474836   ? 2
                                  : a1 < 1073741824 ? 3
                                  : a1 < 2126008811 ? 4
                                                    : 5);
  for (uint8_t& latched : latched_)
    if (latched == 1) latched = 2;
}

void Bench::cover_saturation(const Nodes& n) {
  const auto ends = [&](int64_t value, int64_t top, size_t bin) {
    coverage_.hit_if(value == top, Group::saturation, bin);
    coverage_.hit_if(value == -top - 1, Group::saturation, bin + 1);
  };
  ends(n.error_u, INT32_MAX, 0);
  ends(n.error_v, INT32_MAX, 0);
  ends(n.cal_s, INT32_MAX, 2);
  ends(n.cal_c, INT32_MAX, 4);
  // The paper's words end at Q1.31.
  const int64_t top = arithmetic_ == Arithmetic::paper ? int64_t{INT32_MAX} << 15 : weight_top;
  const int64_t bottom = arithmetic_ == Arithmetic::paper ? -(int64_t{1} << 46) : -weight_top - 1;
  for (int64_t weight : {n.a_u, n.b_u, n.c_u, n.a_v, n.b_v, n.c_v}) {
    coverage_.hit_if(weight == top, Group::saturation, 6);
    coverage_.hit_if(weight == bottom, Group::saturation, 7);
  }
  ends(n.frequency, weight_top, 8);
  coverage_.hit_if(n.amplitude == INT32_MAX, Group::saturation, 10);
  coverage_.hit_if(n.a1 == INT32_MAX || n.a2 == INT32_MAX, Group::saturation, 11);
}

void Bench::cover_ties(const Nodes& n) {
  if (arithmetic_ == Arithmetic::precise) {
    for (int64_t weight : {n.a_u, n.b_u, n.a_v, n.b_v})
      if ((weight & 0x7FFF) == 0x4000) coverage_.hit(Group::tie, weight < 0 ? 1 : 0);
    coverage_.hit_if((n.c_u & 0x7FFF) == 0x4000, Group::tie, 7);
    coverage_.hit_if((n.s_low & INT32_MAX) == 1 << 30, Group::tie, 8);
    coverage_.hit_if((n.c_low & INT32_MAX) == 1 << 30, Group::tie, 9);
    if (edge_ > settled_at_ + latency())
      for (unsigned i = 0; i < 6; ++i) {
        const int64_t product = (i < 3 ? n.error_u : n.error_v) * steps_[i];
        if ((product & 0xFFFF) == 0x8000) coverage_.hit(Group::tie, product < 0 ? 4 : 3);
      }
  }
  const unsigned source = field(ctrl_, ctrl_ref_mask);
  if (edge_ <= settled_at_ + latency()) return;
  const unsigned kp = field(loop_, description::LOOP_KP_mask),
                 ki = field(loop_, description::LOOP_KI_mask);
  const auto residue = static_cast<uint64_t>(n.residue) << 16;
  const auto tie = [&](unsigned shift) {
    return shift > 16 && (residue & ((uint64_t{1} << shift) - 1)) == uint64_t{1} << (shift - 1);
  };
  coverage_.hit_if(source == 1 && tie(kp), Group::tie, 5);
  coverage_.hit_if(source == 1 && tie(ki), Group::tie, 6);
  coverage_.hit_if(source != 2 && (n.phase & 0xFFFF) == 0x8000, Group::tie, 2);
}

void Bench::cover_flags(uint32_t flags) {
  for (unsigned i = 0; i < flag_count; ++i)
    coverage_.hit_if((flags & ~flags_ & (1u << i)) != 0, Group::flag_set, i);
  flags_ |= flags;
}

void Bench::cover_judge(const Nodes& n) {
  const auto hit = [&](bool condition, size_t bin) {
    coverage_.hit_if(condition, Group::turn, bin);
  };
  const auto alarm = [&](bool condition, size_t bin) {
    coverage_.hit_if(condition, Group::alarm, bin);
  };
  const auto flags = static_cast<uint32_t>(n.turn_flags);
  const auto status = static_cast<uint32_t>(n.status);
  const uint32_t changed = status ^ status_;
  alarm(glitches_ == 1 && n.glitches == 0 && (status_ & status_alarm) == 0, 0);
  alarm((changed & status & status_alarm) != 0, 1);
  alarm((changed & status_ & status_alarm) != 0, 2);
  alarm((status & status_frozen) != 0, 3);
  alarm((changed & status & status_alarm) != 0 && (changed & status_ & status_lock) != 0, 4);
  glitches_ = n.glitches;

  const int32_t half_turns = static_cast<int32_t>(n.travel) >> 29;
  hit(half_turns == 3 || half_turns == -4, 25);
  const bool ended = (flags ^ turn_flags_) >> turn_turn_count_shift != 0;
  const bool turns_count = (judge_ & description::JUDGE_TURNS_mask) != 0;
  hit((flags & turn_residue) != 0, 28);
  hit(!ended && turns_count && (changed & status_ & status_lock) != 0 &&
          (status & status_alarm) == 0,
      29);
  constexpr int64_t residue_limit = int64_t{1} << 28;
  hit(std::abs(n.residue) == residue_limit - 1, 30);
  hit(std::abs(n.residue) == residue_limit, 31);
  const bool was_good = (turn_flags_ & turn_good) != 0;
  const bool some = turn_flags_ >> turn_turn_count_shift != 0;
  hit(ended && flags >> turn_turn_count_shift == 0, 27);
  turn_flags_ = flags;
  if (!ended) return;
  const bool good = (flags & turn_good) != 0;
  const bool count = (judge_ & judge_count) != 0;
  const bool timeout = (flags & turn_timeout) != 0;
  hit(good, 0);
  hit((flags & turn_octants_mask) != turn_octants_mask, 1);
  hit((flags & turn_clipped_mask) != 0, 2);
  hit((flags & turn_clipped_mask) == turn_clipped_mask, 3);
  const std::array<uint32_t, 6> bits = {turn_timeout, turn_radius,  turn_winding,
                                        turn_mirror,  turn_noangle, turn_sat};
  for (size_t i = 0; i < bits.size(); ++i) hit((flags & bits[i]) != 0, 4 + i);
  const std::array<int32_t, 8> edges = {60, 61, 66, 67, -62, -61, -67, -68};
  for (size_t i = 0; i < edges.size(); ++i)
    hit(static_cast<int32_t>(n.travel) >> 24 == edges[i], 10 + i);
  hit(field(status, description::STATUS_GOOD_TURNS_mask) == 3, 18);
  hit(good && some && !was_good, 19);
  hit(!good && was_good, 20);
  const bool by_angle = (ctrl_ & ctrl_ref_mask) != 0;
  hit(!count && !timeout && !by_angle, 21);
  hit(!count && !timeout && by_angle && n.travel > 0, 22);
  hit(!count && !timeout && by_angle && n.travel < 0, 23);
  hit(count && good, 24);
  hit(n.travel == 1 << 30 || n.travel == -(1 << 30), 26);
}

void Bench::cover_slew(const Nodes& n) {
  if (edge_ <= std::max(judge_at_, settled_at_) + latency()) return;
  const unsigned slew = field(judge_, description::JUDGE_SLEW_mask);
  std::array<bool, 2> limited{};
  for (size_t channel = 0; channel < 2; ++channel) {
    const int64_t error = channel == 0 ? n.error_u : n.error_v;
    const int64_t most = INT32_MAX >> (2 * slew);
    limited[channel] = error > most || error < -most - 1;
    if (slew == 0) {
      coverage_.hit_if(error == most || error == -most - 1, Group::slew, 0);
      continue;
    }
    const size_t where = error > most         ? 0
                         : error < -most - 1  ? 1
                         : error == most      ? 2
                         : error == -most - 1 ? 3
                                              : 4;
    coverage_.hit(Group::slew, 1 + (slew - 1) * 5 + where);
  }
  coverage_.hit_if(limited[0] && !limited[1], Group::slew, 36);
  coverage_.hit_if(limited[1] && !limited[0], Group::slew, 37);
  coverage_.hit_if((limited[0] || limited[1]) && (ctrl_ & ctrl_demod) == 0, Group::slew, 38);
}

void Bench::cover_safety(const Nodes& n, uint32_t flags_before) {
  const auto flags = static_cast<uint32_t>(n.flags), status = static_cast<uint32_t>(n.status);
  const bool valid = (status & status_valid) != 0;
  coverage_.hit_if((flags_before & flags_safety) != 0 && !valid && (ctrl_ & ctrl_calib) != 0,
                   Group::safety, 8);
  coverage_.hit_if((flags & flags_safety) == 0 && valid && distrusted_, Group::safety, 9);
  distrusted_ = (flags & flags_safety) != 0;
  const auto angle = static_cast<uint32_t>(n.found_angle);
  const uint32_t moved = (angle >> 2) - (last_angle_.value_or(angle) >> 2);
  const int64_t step = fixed::sign_extend<30>(moved);
  last_angle_ = angle;
  // This edge is in the last tick of the sample's way.
  if (edge_ + tick_ <= std::max(safety_at_, settled_at_) + latency()) return;
  const uint32_t found = (flags & ~flags_before & flags_safety) >> flags_safety_shift;
  if (found == safety_parity && (unfit_ & (unfit_ - 1)) == 0)
    for (size_t i = 0; i < parity_registers.size(); ++i)
      coverage_.hit_if(unfit_ == parity_bit(parity_registers[i]), Group::parity, i);

  const size_t memories_at = parity_registers.size();
  const bool is_memory = found == safety_parity && unfit_ == 0;
  coverage_.hit_if(is_memory && (ctrl_ & ctrl_correct) != 0, Group::parity, memories_at);
  coverage_.hit_if(is_memory && (ctrl_ & ctrl_block) != 0, Group::parity, memories_at + 1);

  const unsigned error_limit = field(safety_, safety_error_limit_mask),
                 step_limit = std::min(29u, field(safety_, safety_step_limit_mask));
  const auto most = [](unsigned bits) { return (int64_t{1} << bits) - 1; };
  const int64_t error_most = most(31 - error_limit), step_most = most(29 - step_limit);
  const auto beyond = [](int64_t value, int64_t largest) {
    return value > largest || value < -largest - 1;
  };
  const std::array<bool, 4> there = {unfit_ != 0,
                                     beyond(n.error_u, error_most) || beyond(n.error_v, error_most),
                                     beyond(step, step_most), (flags_before & flag_result) != 0};
  for (size_t i = 0; i < there.size(); ++i) {
    coverage_.hit_if(found == 1u << i, Group::safety, 2 * i);
    coverage_.hit_if(there[i] && (safety_ >> i & 1) == 0 && (found >> i & 1) == 0, Group::safety,
                     2 * i + 1);
  }
  constexpr size_t errors_at = 10, steps_at = errors_at + size_t{31} * 4;
  if (error_limit != 0 && (safety_ & safety_misfit) != 0)
    for (const int64_t error : {n.error_u, n.error_v}) {
      const size_t first = errors_at + (error_limit - 1) * 4;
      coverage_.hit_if(error == error_most, Group::safety, first);
      coverage_.hit_if(error == error_most + 1, Group::safety, first + 1);
      coverage_.hit_if(error == -error_most - 1, Group::safety, first + 2);
      coverage_.hit_if(error == -error_most - 2, Group::safety, first + 3);
    }
  if (step_limit != 0 && (safety_ & safety_jump) != 0)
    coverage_.hit(Group::safety,
                  steps_at + size_t{step_limit - 1} * 2 + (beyond(step, step_most) ? 1 : 0));
}

void Bench::cover_parity(uint32_t offset, uint32_t value) {
  const bool bad = (safety_ & safety_bad_parity) != 0;
  uint64_t bit = parity_bit(offset) & parity_bits;
  if (is_pair(offset)) bit = is_pair_high(offset) ? parity_bit(offset - 4) : 0;
  if (offset == reg_cmd && (value & cmd_phase0) != 0) bit = parity_bit(reg_phase_lo);
  unfit_ = bad ? unfit_ | bit : unfit_ & ~bit;
  if (offset != reg_safety) return;
  safety_ = value & safety_writable;
  safety_at_ = edge_;
}

void Bench::cover_interrupt(bool level) {
  const bool result = (flags_ & flag_result) != 0 && (ctrl_ & ctrl_ie_result) != 0;
  const bool lock = (flags_ & flag_lockchg) != 0 && (ctrl_ & ctrl_ie_lock) != 0;
  const bool error = (flags_ & flags_error) != 0 && (ctrl_ & ctrl_ie_error) != 0;
  const bool turn = (flags_ & flag_turn) != 0 && (ctrl_ & ctrl_ie_turn) != 0;
  const bool alarm = (flags_ & flag_alarm) != 0 && (ctrl_ & ctrl_ie_alarm) != 0;
  const bool safety = (flags_ & flags_safety) != 0 && (ctrl_ & ctrl_ie_safety) != 0;
  const bool others = result || lock || error || safety;
  coverage_.hit_if(level && safety && !result && !lock && !error && !turn && !alarm,
                   Group::interrupt, 7);
  coverage_.hit_if(level && turn && !others && !alarm, Group::interrupt, 5);
  coverage_.hit_if(level && alarm && !others && !turn, Group::interrupt, 6);
  coverage_.hit_if(level && result && !lock && !error, Group::interrupt, 0);
  coverage_.hit_if(level && lock && !result && !error, Group::interrupt, 1);
  coverage_.hit_if(level && error && !result && !lock, Group::interrupt, 2);
  coverage_.hit_if(!level && flags_ != 0, Group::interrupt, 3);
  coverage_.hit_if(!level && flags_ == 0, Group::interrupt, 4);
}

/// A write of CTRL that lets a flag through which was raised while it was masked or handled, and
/// one that takes it away: the line follows flag and enable, not the event.
void Bench::cover_enables(uint32_t value) {
  constexpr std::array<std::pair<uint32_t, uint32_t>, 6> kinds = {{{flag_result, ctrl_ie_result},
                                                                   {flag_lockchg, ctrl_ie_lock},
                                                                   {flags_error, ctrl_ie_error},
                                                                   {flag_turn, ctrl_ie_turn},
                                                                   {flag_alarm, ctrl_ie_alarm},
                                                                   {flags_safety, ctrl_ie_safety}}};
  const auto level = [&](uint32_t ctrl) {
    return std::any_of(kinds.begin(), kinds.end(), [&](const auto& kind) {
      return (flags_ & kind.first) != 0 && (ctrl & kind.second) != 0;
    });
  };
  // Alone: another flag would hold the line.
  for (size_t i = 0; i < kinds.size(); ++i) {
    const auto& [flag, enable] = kinds[i];
    if ((flags_ & flag) == 0 || ((ctrl_ ^ value) & enable) == 0) continue;
    coverage_.hit_if(!level(ctrl_) && !level(value & ~enable), Group::interrupt, 8 + i);
    coverage_.hit_if(!level(value) && !level(ctrl_ & ~enable), Group::interrupt, 14 + i);
  }
}

void Bench::cover_spacing() {
  if (last_sample_) {
    const uint64_t d = edge_ - *last_sample_;
    coverage_.hit(Group::spacing, d <= 1               ? 0
                                  : d < tick_ - 1      ? 1
                                  : d <= tick_ + 1     ? d + 3 - tick_
                                  : d < 2 * tick_      ? 5
                                  : d == 2 * tick_     ? 6
                                  : d < latency()      ? 7
                                  : d <= latency() + 1 ? d + 8 - latency()
                                  : d <= scaled(200)   ? 10
                                                       : 11);
  }
  last_sample_ = edge_;
}

void Bench::cover_write(uint32_t offset, uint32_t value) {
  const size_t index = register_index(offset);
  if (offset % 4 != 0) return coverage_.hit(Group::access, 6);
  if (index == std::size(registers::coprocessor::table)) return coverage_.hit(Group::access, 4);
  const auto& entry = registers::coprocessor::table[index];
  coverage_.hit(Group::write_of, index);
  coverage_.hit(Group::access, entry.access == registers::Access::read_only ? 7 : 1);
  const bool reserved_source =
      offset == reg_ctrl && (value & ctrl_ref_mask) == ctrl_ref_mask && (value & ctrl_srst) == 0;
  const bool rejected =
      ((is_step(offset) || offset == reg_a1 || offset == reg_a2) && (value >> 31) != 0) ||
      reserved_source;
  coverage_.hit_if(rejected, Group::access, 8);
  if (rejected) coverage_.hit_if((flags_ & flag_config) == 0, Group::flag_set, 8);
  if (rejected) flags_ |= flag_config;
  cover_collision(offset, value);
  if (offset == reg_flags) {
    for (unsigned i = 0; i < flag_count; ++i)
      coverage_.hit_if((value & flags_ & (1u << i)) != 0, Group::flag_cleared, i);
    coverage_.hit_if((value & flags_ & flag_alarm) != 0 && (status_ & status_alarm) != 0,
                     Group::alarm, 5);
    flags_ &= ~value;
  }
  if (is_pair(offset)) cover_pair_write(offset);
  if (!rejected || reserved_source) cover_parity(offset, value);
  if (!rejected || reserved_source) cover_mode_change(offset, value);
}

void Bench::cover_mode_change(uint32_t offset, uint32_t value) {
  const size_t base = busy() ? 17 : 0;
  if (offset == reg_ctrl && (value & ctrl_srst) == 0) {
    cover_enables(value);
    const uint32_t from = field(ctrl_, ctrl_ref_mask);
    uint32_t to = field(value, ctrl_ref_mask);
    if (to == 3) to = from;
    if (from != to) coverage_.hit(Group::mode_change, base + from * 2 + (to > from ? to - 1 : to));
    const uint32_t changed = ctrl_ ^ value;
    if ((changed & ctrl_demod) != 0)
      coverage_.hit(Group::mode_change, base + ((value & ctrl_demod) != 0 ? 6 : 7));
    if ((changed & ctrl_calib) != 0)
      coverage_.hit(Group::mode_change, base + ((value & ctrl_calib) != 0 ? 8 : 9));
    if ((changed & ctrl_ & ctrl_adc) != 0) coverage_.hit(Group::mode_change, base + 10);
    if ((changed & ctrl_freeze) != 0) coverage_.hit(Group::mode_change, base + 16);
    ctrl_ = (value & ctrl_writable & ~ctrl_ref_mask) | (to << ctrl_ref_shift);
    settled_at_ = edge_;
  }
  if (is_step(offset)) {
    coverage_.hit(Group::mode_change, base + 11);
    steps_[(offset - reg_step_au) / 4] = value;
    settled_at_ = edge_;
  }
  if (offset == reg_loop) {
    coverage_.hit(Group::mode_change, base + 12);
    loop_ = value & (description::LOOP_KP_mask | description::LOOP_KI_mask);
    settled_at_ = edge_;
  }
  if (offset == reg_lock_threshold || offset == reg_diverge_threshold)
    coverage_.hit(Group::mode_change, base + 13);
  if (offset == reg_judge) {
    coverage_.hit(Group::mode_change, base + 14);
    judge_ = value & judge_writable;
    judge_at_ = edge_;
  }
  if (offset == reg_turn_limit) coverage_.hit(Group::mode_change, base + 15);
}

void Bench::cover_collision(uint32_t offset, uint32_t value) {
  const auto cover = [&](bool condition, size_t bin) {
    coverage_.hit_if(condition, Group::collision, bin);
  };
  cover(sampled_, 10);
  cover(busy() && boundary_ == edge_ + 1, 12);
  cover(busy() && turned_ + 1 == edge_, 13);
  if (turned_ != edge_) return;
  const bool tracking = (field(ctrl_, ctrl_ref_mask)) == 1;
  const bool demod = (ctrl_ & ctrl_demod) != 0;
  cover(ended_[4] && offset == reg_flags && value != 0, 0);
  cover(ended_[4] && offset == reg_cmd && (value & cmd_clear) != 0, 1);
  cover(ended_[3] && demod && offset >= reg_au_lo && offset <= reg_cv_hi, 2);
  cover(ended_[2] && offset == reg_phase_hi, 3);
  cover(ended_[2] && tracking && offset == reg_freq_hi, 4);
  cover(ended_[4] && demod && offset >= reg_a1 && offset <= reg_phi, 5);
  cover(busy() && offset == reg_ctrl && (value & ctrl_srst) == 0, 6);
  cover(busy() && is_step(offset), 7);
  cover(ended_[4] && offset == reg_ctrl && (value & ctrl_srst) != 0, 8);
  cover(offset == reg_cmd && (value & cmd_load) != 0, 11);
}

void Bench::cover_pair_write(uint32_t offset) {
  uint8_t& staged = staged_[pair_index(offset)];
  if (is_pair_high(offset)) {
    coverage_.hit(Group::pair, staged != 0 ? 0 : 1);
    staged = 0;
  } else {
    coverage_.hit_if(staged != 0, Group::pair, 2);
    staged = 1;
  }
}

void Bench::cover_read(uint32_t offset, bool debug, bool ok) {
  if (offset % 4 != 0) return coverage_.hit(Group::access, 5);
  if (!ok) return coverage_.hit(Group::access, 3);
  coverage_.hit(Group::access, debug ? 2 : 0);
  if (debug) return;
  const size_t index = register_index(offset);
  if (index < std::size(registers::coprocessor::table)) coverage_.hit(Group::read_of, index);
  if (!is_pair(offset)) return;
  uint8_t& latched = latched_[pair_index(offset)];
  if (is_pair_high(offset)) {
    latched = 1;
  } else {
    coverage_.hit(Group::pair, latched != 0 ? 3 : 4);
    coverage_.hit_if(latched == 2, Group::pair, 5);
    latched = 0;
  }
}

}  // namespace capsoc::regress
