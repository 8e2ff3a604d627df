// Register accesses of the coprocessor. docs/coprocessor.md, "Registers".
#include "coprocessor/coprocessor.h"
#include "coprocessor/lms_demodulator.h"
#include "fixed/fixed.h"

namespace capsoc::coprocessor {
namespace {

static_assert(latency_cycles == description::LATENCY_reset);

// The 48-bit registers: an even word LO, an odd word HI.
constexpr unsigned freq_pair = 0;
constexpr unsigned phase_pair = 1;
constexpr unsigned first_coefficient_pair = 2;

std::optional<unsigned> pair_of(uint32_t offset) {
  if (offset >= reg_freq_lo && offset <= reg_phase_hi) return (offset - reg_freq_lo) / 8;
  if (offset >= reg_au_lo && offset <= reg_cv_hi)
    return first_coefficient_pair + (offset - reg_au_lo) / 8;
  return std::nullopt;
}

bool is_high(uint32_t offset) {
  return offset < reg_au_lo ? (offset & 4) != (reg_freq_lo & 4) : (offset & 4) != 0;
}

// Member `index` (sine, cosine, constant) of the channel pair, u before v.
template <typename Channel>
auto& member(Channel& u, Channel& v, unsigned index) {
  Channel& channel = index < 3 ? u : v;
  switch (index % 3) {
    case 0:
      return channel.sine;
    case 1:
      return channel.cosine;
    default:
      return channel.constant;
  }
}

// HI: rounded to Q1.31 and saturated; LO: what is then missing, in 2^-46.
PairWords coefficient_words(int64_t weight) {
  bool clamped = false;
  const int32_t high = fixed::saturate32(weight_q31(weight), clamped);
  const int32_t low = fixed::saturate32(weight - fixed::scale_up(int64_t{high}, 15), clamped);
  return {static_cast<uint32_t>(high), static_cast<uint32_t>(low)};
}

PairWords phase_words(uint64_t value) {
  return {static_cast<uint32_t>(value >> 16), static_cast<uint32_t>(value & 0xFFFF)};
}

PairWords words(unsigned pair, int64_t value) {
  return pair < first_coefficient_pair ? phase_words(static_cast<uint64_t>(value))
                                       : coefficient_words(value);
}

bool is_read_only(uint32_t offset) {
  switch (offset) {
    case reg_id:
    case reg_version:
    case reg_status:
    case reg_error_average:
    case reg_raw_u:
    case reg_raw_v:
    case reg_cal_s:
    case reg_cal_c:
    case reg_angle:
    case reg_err_u:
    case reg_err_v:
    case reg_residue:
    case reg_samples:
    case reg_early_count:
    case reg_ref_phase:
    case reg_amplitude:
    case reg_latency:
    case reg_turn_flags:
    case reg_radius_max:
    case reg_residue_max:
    case reg_winding:
    case reg_turn_samples:
    case reg_turn_det:
      return true;
    default:
      return false;
  }
}

bool is_write_only(uint32_t offset) {
  return offset == reg_cmd || offset == reg_soft_v || offset == reg_correction;
}

bool is_setting(uint32_t offset) {
  switch (offset) {
    case reg_ctrl:
    case reg_flags:
    case reg_loop:
    case reg_lock_threshold:
    case reg_diverge_threshold:
    case reg_judge:
    case reg_turn_limit:
    case reg_soft_u:
      return true;
    default:
      return (offset >= reg_step_au && offset <= reg_step_cv) ||
             (offset >= reg_a1 && offset <= reg_phi);
  }
}

uint32_t source_field(uint32_t ctrl) {
  return field(ctrl, ctrl_ref_mask);
}

}  // namespace

bool is_register(uint32_t offset) {
  return offset % 4 == 0 && (is_read_only(offset) || is_write_only(offset) || is_setting(offset) ||
                             pair_of(offset).has_value());
}

std::string_view write_complaint(uint32_t offset, uint32_t value) {
  if (is_read_only(offset)) return "write to a read-only register is ignored";
  if (offset >= reg_step_au && offset <= reg_step_cv)
    return value >> 31 ? "a step of 1.0 or more is ignored: write less than 2^31" : "";
  switch (offset) {
    case reg_ctrl:
      if (value & ctrl_srst) return "";
      if (source_field(value) == 3)
        return "CTRL.REF 3 is reserved: the reference source stays as it was";
      return value & ~ctrl_writable ? "reserved bits of CTRL are ignored" : "";
    case reg_cmd:
      return value & ~(cmd_load | cmd_clear | cmd_phase0) ? "reserved bits of CMD are ignored" : "";
    case reg_correction:
      return value & ~(correction_node_mask | correction_value_mask)
                 ? "reserved bits of CORRECTION are ignored"
                 : "";
    case reg_loop:
      return value & ~0x1F1Fu ? "reserved bits of LOOP are ignored" : "";
    case reg_judge:
      return value & ~judge_writable ? "reserved bits of JUDGE are ignored" : "";
    case reg_a1:
    case reg_a2:
      return value >> 31 ? "a negative amplitude is ignored: write less than 2^31" : "";
    default:
      return "";
  }
}

bool is_pair(uint32_t offset) {
  return offset % 4 == 0 && pair_of(offset).has_value();
}

bool is_pair_high(uint32_t offset) {
  return is_pair(offset) && is_high(offset);
}

PairWords pair_words(uint32_t offset, int64_t value) {
  return words(pair_of(offset).value_or(freq_pair), value);
}

uint32_t Coprocessor::status() const {
  return (sequencer_.busy() ? status_busy : 0) | (results_.lock ? status_lock : 0) |
         (results_.diverged ? status_diverged : 0) | (results_.mirror ? status_mirror : 0) |
         (results_.valid ? status_valid : 0) | (judge_.alarm ? status_alarm : 0) |
         (frozen() ? status_frozen : 0) | (datapath_.paper() ? status_arith : 0) |
         (judge_.good_turns << status_good_turns_shift);
}

uint32_t Coprocessor::turn_flags() const {
  return judge_.last.flags | uint32_t{judge_.turn_count} << turn_count_shift;
}

int64_t Coprocessor::pair_value(unsigned pair) const {
  if (pair == freq_pair) return state_.reference.frequency;
  if (pair == phase_pair) return static_cast<int64_t>(state_.reference.phase);
  return member(state_.coefficients.u, state_.coefficients.v, pair - first_coefficient_pair);
}

void Coprocessor::set_pair(unsigned pair, int32_t high, uint32_t low) {
  if (pair == freq_pair) {
    state_.reference.frequency = fixed::scale_up(int64_t{high}, 16) + (low & 0xFFFF);
    return;
  }
  if (pair == phase_pair) {
    state_.reference.phase = (uint64_t{static_cast<uint32_t>(high)} << 16) | (low & 0xFFFF);
    return;
  }
  bool clamped = false;
  int64_t weight = fixed::scale_up(int64_t{high}, 15) + static_cast<int32_t>(low);
  if (datapath_.paper())
    weight = fixed::scale_up(fixed::saturate<32>(weight_q31(weight), clamped), 15);
  member(state_.coefficients.u, state_.coefficients.v, pair - first_coefficient_pair) = weight;
}

std::optional<uint32_t> Coprocessor::peek(uint32_t offset) const {
  const Parameters& p = state_.parameters;
  if (offset >= reg_step_au && offset <= reg_step_cv)
    return member(settings_.steps_u, settings_.steps_v, (offset - reg_step_au) / 4);
  switch (offset) {
    case reg_id:
      return id_value;
    case reg_version:
      return version_value;
    case reg_ctrl:
      return ctrl_;
    case reg_status:
      return status();
    case reg_flags:
      return flags_;
    case reg_cmd:
      return 0;
    case reg_loop:
      return settings_.kp | (settings_.ki << description::LOOP_KI_shift);
    case reg_lock_threshold:
      return lock_threshold_;
    case reg_diverge_threshold:
      return diverge_threshold_;
    case reg_error_average:
      return results_.error_average;
    case reg_a1:
      return static_cast<uint32_t>(p.a1);
    case reg_a2:
      return static_cast<uint32_t>(p.a2);
    case reg_b1:
      return static_cast<uint32_t>(p.b1);
    case reg_b2:
      return static_cast<uint32_t>(p.b2);
    case reg_beta:
      return p.beta;
    case reg_phi:
      return p.phi;
    case reg_soft_u:
      return soft_u_;
    case reg_soft_v:
    case reg_correction:
      return 0;
    case reg_raw_u:
      return results_.raw_u;
    case reg_raw_v:
      return results_.raw_v;
    case reg_cal_s:
      return results_.cal_s;
    case reg_cal_c:
      return results_.cal_c;
    case reg_angle:
      return results_.angle;
    case reg_err_u:
      return results_.error_u;
    case reg_err_v:
      return results_.error_v;
    case reg_residue:
      return results_.residue;
    case reg_samples:
      return samples_;
    case reg_early_count:
      return early_count_;
    case reg_ref_phase:
      return results_.reference_phase;
    case reg_amplitude:
      return results_.amplitude;
    case reg_latency:
      return latency_cycles;
    case reg_judge:
      return judge_settings_.radius_limit | judge_settings_.alarm_limit << judge_alarm_limit_shift |
             judge_settings_.turns << judge_turns_shift |
             (judge_settings_.count ? judge_count : 0) | settings_.slew << judge_slew_shift;
    case reg_turn_limit:
      return judge_settings_.turn_limit;
    case reg_turn_flags:
      return turn_flags();
    case reg_radius_max:
      return judge_.last.radius_max;
    case reg_residue_max:
      return judge_.last.residue_max;
    case reg_winding:
      return static_cast<uint32_t>(judge_.last.winding);
    case reg_turn_samples:
      return judge_.last.samples;
    case reg_turn_det:
      return static_cast<uint32_t>(judge_.last.det);
    default:
      return std::nullopt;
  }
}

RegisterAccess Coprocessor::read(uint64_t cycle, uint32_t offset, bool debug) {
  advance(cycle);
  if (offset % 4 != 0) return {};
  if (const auto pair = pair_of(offset)) {
    const PairWords value = words(*pair, pair_value(*pair));
    if (is_high(offset)) {
      if (!debug) latched_low_[*pair] = value.low;
      return {true, value.high};
    }
    return {true, debug ? value.low : latched_low_[*pair]};
  }
  const auto value = peek(offset);
  return {value.has_value(), value.value_or(0)};
}

bool Coprocessor::write(uint64_t cycle, uint32_t offset, uint32_t value) {
  advance(cycle);
  guest_error_ = {};
  if (offset % 4 != 0) return false;
  guest_error_ = write_complaint(offset, value);
  return is_read_only(offset) || write_control(cycle, offset, value) ||
         write_setting(offset, value) || write_parameter(offset, value) ||
         write_pair(offset, value);
}

bool Coprocessor::write_control(uint64_t cycle, uint32_t offset, uint32_t value) {
  switch (offset) {
    case reg_ctrl:
      write_ctrl(value);
      return true;
    case reg_flags:
      flags_ &= ~value;
      return true;
    case reg_cmd:
      write_command(cycle, value);
      return true;
    case reg_soft_u:
      soft_u_ = value;
      return true;
    case reg_correction:
      write_correction(value);
      return true;
    case reg_soft_v:
      latch(cycle, static_cast<int32_t>(soft_u_), static_cast<int32_t>(value), false);
      return true;
    default:
      return false;
  }
}

void Coprocessor::write_ctrl(uint32_t value) {
  if (value & ctrl_srst) {
    soft_reset();
    return;
  }
  uint32_t source = source_field(value);
  if (source == 3) {
    flags_ |= flag_config;
    source = static_cast<uint32_t>(settings_.source);
  }
  if ((value & ctrl_block) != 0 && !options_.block_learning) flags_ |= flag_config;
  if (!options_.block_learning) value &= ~(ctrl_block | ctrl_guard);
  if ((value & ctrl_correct) != 0 && !options_.harmonic_correction) flags_ |= flag_config;
  if (!options_.harmonic_correction) value &= ~ctrl_correct;
  ctrl_ = (value & ctrl_writable & ~ctrl_ref_mask) | (source << ctrl_ref_shift);
  settings_.block = (ctrl_ & ctrl_block) != 0;
  settings_.guard = (ctrl_ & ctrl_guard) != 0;
  settings_.correct = (ctrl_ & ctrl_correct) != 0;
  settings_.demodulate = (ctrl_ & ctrl_demod) != 0;
  settings_.source = static_cast<ReferenceSource>(source);
}

void Coprocessor::write_correction(uint32_t value) {
  if (sequencer_.busy() || !options_.harmonic_correction) {
    flags_ |= flag_config;
    return;
  }
  const uint32_t word = field(value, correction_value_mask);
  corrections_[field(value, correction_node_mask)] =
      static_cast<int32_t>(fixed::sign_extend<20>(word));
}

void Coprocessor::write_command(uint64_t cycle, uint32_t value) {
  if (value & cmd_load) sequencer_.request_load(cycle);
  if (value & cmd_clear) samples_ = early_count_ = 0;
  if (value & cmd_phase0) state_.reference.phase = 0;
}

bool Coprocessor::write_setting(uint32_t offset, uint32_t value) {
  if (offset >= reg_step_au && offset <= reg_step_cv) {
    if (value >> 31)
      flags_ |= flag_config;
    else
      member(settings_.steps_u, settings_.steps_v, (offset - reg_step_au) / 4) = value;
    return true;
  }
  switch (offset) {
    case reg_loop:
      settings_.kp = field(value, description::LOOP_KP_mask);
      settings_.ki = field(value, description::LOOP_KI_mask);
      return true;
    case reg_lock_threshold:
      lock_threshold_ = value;
      return true;
    case reg_diverge_threshold:
      diverge_threshold_ = value;
      return true;
    case reg_judge:
      judge_settings_.radius_limit = field(value, description::JUDGE_RADIUS_LIMIT_mask);
      judge_settings_.alarm_limit = field(value, description::JUDGE_ALARM_LIMIT_mask);
      judge_settings_.turns = field(value, description::JUDGE_TURNS_mask);
      judge_settings_.count = (value & judge_count) != 0;
      settings_.slew = field(value, description::JUDGE_SLEW_mask);
      return true;
    case reg_turn_limit:
      judge_settings_.turn_limit = value;
      return true;
    default:
      return false;
  }
}

bool Coprocessor::write_parameter(uint32_t offset, uint32_t value) {
  Parameters& p = state_.parameters;
  if ((offset == reg_a1 || offset == reg_a2) && (value >> 31)) {
    flags_ |= flag_config;
    return true;
  }
  switch (offset) {
    case reg_a1:
      p.a1 = static_cast<int32_t>(value);
      return true;
    case reg_a2:
      p.a2 = static_cast<int32_t>(value);
      return true;
    case reg_b1:
      p.b1 = static_cast<int32_t>(value);
      return true;
    case reg_b2:
      p.b2 = static_cast<int32_t>(value);
      return true;
    case reg_beta:
      p.beta = value;
      return true;
    case reg_phi:
      p.phi = value;
      return true;
    default:
      return false;
  }
}

bool Coprocessor::write_pair(uint32_t offset, uint32_t value) {
  const auto pair = pair_of(offset);
  if (!pair) return false;
  if (!is_high(offset)) {
    staged_low_[*pair] = value;
    return true;
  }
  set_pair(*pair, static_cast<int32_t>(value), staged_low_[*pair]);
  staged_low_[*pair] = 0;
  return true;
}

}  // namespace capsoc::coprocessor
