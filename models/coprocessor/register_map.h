// Register map of the coprocessor, as far as the model needs names (docs/coprocessor.md). Offsets,
// fields and reset values are those of models/registers/capsoc.svd.
#pragma once

#include <cstdint>
#include <string_view>

#include "capsoc_registers.h"

namespace capsoc::coprocessor {

namespace description = registers::coprocessor;

enum Offset : uint32_t {
  reg_id = description::ID_offset,
  reg_version = description::VERSION_offset,
  reg_ctrl = description::CTRL_offset,
  reg_status = description::STATUS_offset,
  reg_flags = description::FLAGS_offset,
  reg_cmd = description::CMD_offset,
  reg_freq_lo = description::FREQ_LO_offset,
  reg_freq_hi = description::FREQ_HI_offset,
  reg_phase_lo = description::PHASE_LO_offset,
  reg_phase_hi = description::PHASE_HI_offset,
  reg_step_au = description::STEP_AU_offset,  // then BU, CU, AV, BV
  reg_step_cv = description::STEP_CV_offset,
  reg_loop = description::LOOP_offset,
  reg_lock_threshold = description::LOCK_THRESHOLD_offset,
  reg_diverge_threshold = description::DIVERGE_THRESHOLD_offset,
  reg_error_average = description::ERROR_AVERAGE_offset,
  reg_au_lo = description::AU_LO_offset,  // then AU_HI, BU_LO ...
  reg_cv_hi = description::CV_HI_offset,
  reg_a1 = description::A1_offset,
  reg_a2 = description::A2_offset,
  reg_b1 = description::B1_offset,
  reg_b2 = description::B2_offset,
  reg_beta = description::BETA_offset,
  reg_phi = description::PHI_offset,
  reg_judge = description::JUDGE_offset,
  reg_turn_limit = description::TURN_LIMIT_offset,
  reg_soft_u = description::SOFT_U_offset,
  reg_soft_v = description::SOFT_V_offset,
  reg_correction = description::CORRECTION_offset,
  reg_raw_u = description::RAW_U_offset,
  reg_raw_v = description::RAW_V_offset,
  reg_cal_s = description::CAL_S_offset,
  reg_cal_c = description::CAL_C_offset,
  reg_angle = description::ANGLE_offset,
  reg_err_u = description::ERR_U_offset,
  reg_err_v = description::ERR_V_offset,
  reg_residue = description::RESIDUE_offset,
  reg_samples = description::SAMPLES_offset,
  reg_early_count = description::EARLY_COUNT_offset,
  reg_ref_phase = description::REF_PHASE_offset,
  reg_amplitude = description::AMPLITUDE_offset,
  reg_latency = description::LATENCY_offset,
  reg_turn_flags = description::TURN_FLAGS_offset,
  reg_radius_max = description::RADIUS_MAX_offset,
  reg_residue_max = description::RESIDUE_MAX_offset,
  reg_winding = description::WINDING_offset,
  reg_turn_samples = description::TURN_SAMPLES_offset,
  reg_turn_det = description::TURN_DET_offset,
  reg_last = reg_turn_det,
};

inline constexpr uint32_t id_value = description::ID_reset;
inline constexpr uint32_t version_value = description::VERSION_reset;

// CTRL
inline constexpr uint32_t ctrl_demod = description::CTRL_DEMOD_mask;
inline constexpr uint32_t ctrl_calib = description::CTRL_CALIB_mask;
inline constexpr unsigned ctrl_ref_shift = description::CTRL_REF_shift;
inline constexpr uint32_t ctrl_ref_mask = description::CTRL_REF_mask;
inline constexpr uint32_t ctrl_adc = description::CTRL_ADC_mask;
inline constexpr uint32_t ctrl_freeze = description::CTRL_FREEZE_mask;
inline constexpr uint32_t ctrl_block = description::CTRL_BLOCK_mask;
inline constexpr uint32_t ctrl_guard = description::CTRL_GUARD_mask;
inline constexpr uint32_t ctrl_ie_result = description::CTRL_IE_RESULT_mask;
inline constexpr uint32_t ctrl_ie_lock = description::CTRL_IE_LOCK_mask;
inline constexpr uint32_t ctrl_ie_error = description::CTRL_IE_ERROR_mask;
inline constexpr uint32_t ctrl_ie_turn = description::CTRL_IE_TURN_mask;
inline constexpr uint32_t ctrl_ie_alarm = description::CTRL_IE_ALARM_mask;
inline constexpr uint32_t ctrl_correct = description::CTRL_CORRECT_mask;
inline constexpr uint32_t ctrl_srst = description::CTRL_SRST_mask;
inline constexpr uint32_t ctrl_writable =
    ctrl_demod | ctrl_calib | ctrl_ref_mask | ctrl_adc | ctrl_freeze | ctrl_block | ctrl_guard |
    ctrl_ie_result | ctrl_ie_lock | ctrl_ie_error | ctrl_ie_turn | ctrl_ie_alarm | ctrl_correct;

// STATUS
inline constexpr uint32_t status_busy = description::STATUS_BUSY_mask;
inline constexpr uint32_t status_lock = description::STATUS_LOCK_mask;
inline constexpr uint32_t status_diverged = description::STATUS_DIVERGED_mask;
inline constexpr uint32_t status_mirror = description::STATUS_MIRROR_mask;
inline constexpr uint32_t status_valid = description::STATUS_VALID_mask;
inline constexpr uint32_t status_alarm = description::STATUS_ALARM_mask;
inline constexpr uint32_t status_frozen = description::STATUS_FROZEN_mask;
inline constexpr unsigned status_good_turns_shift = description::STATUS_GOOD_TURNS_shift;
inline constexpr uint32_t status_arith = description::STATUS_ARITH_mask;

// FLAGS
inline constexpr uint32_t flag_result = description::FLAGS_RESULT_mask;
inline constexpr uint32_t flag_clip = description::FLAGS_CLIP_mask;
inline constexpr uint32_t flag_sat = description::FLAGS_SAT_mask;
inline constexpr uint32_t flag_zero = description::FLAGS_ZERO_mask;
inline constexpr uint32_t flag_early = description::FLAGS_EARLY_mask;
inline constexpr uint32_t flag_lockchg = description::FLAGS_LOCKCHG_mask;
inline constexpr uint32_t flag_diverged = description::FLAGS_DIVERGED_mask;
inline constexpr uint32_t flag_mirrorchg = description::FLAGS_MIRRORCHG_mask;
inline constexpr uint32_t flag_config = description::FLAGS_CONFIG_mask;
inline constexpr uint32_t flag_turn = description::FLAGS_TURN_mask;
inline constexpr uint32_t flag_alarm = description::FLAGS_ALARM_mask;
inline constexpr uint32_t flag_unsettled = description::FLAGS_UNSETTLED_mask;
inline constexpr unsigned flag_count = 12;
inline constexpr uint32_t flags_all = (1u << flag_count) - 1;
inline constexpr uint32_t flags_error =
    flag_clip | flag_sat | flag_zero | flag_early | flag_diverged | flag_config | flag_unsettled;

// TURN_FLAGS
inline constexpr uint32_t turn_octants_mask = description::TURN_FLAGS_OCTANTS_mask;
inline constexpr unsigned turn_clipped_shift = description::TURN_FLAGS_CLIPPED_shift;
inline constexpr uint32_t turn_clipped_mask = description::TURN_FLAGS_CLIPPED_mask;
inline constexpr uint32_t turn_timeout = description::TURN_FLAGS_TIMEOUT_mask;
inline constexpr uint32_t turn_radius = description::TURN_FLAGS_RADIUS_mask;
inline constexpr uint32_t turn_winding = description::TURN_FLAGS_WINDING_mask;
inline constexpr uint32_t turn_mirror = description::TURN_FLAGS_MIRROR_mask;
inline constexpr uint32_t turn_noangle = description::TURN_FLAGS_NOANGLE_mask;
inline constexpr uint32_t turn_sat = description::TURN_FLAGS_SAT_mask;
inline constexpr uint32_t turn_residue = description::TURN_FLAGS_RESIDUE_mask;
inline constexpr uint32_t turn_good = description::TURN_FLAGS_GOOD_mask;
inline constexpr unsigned turn_count_shift = description::TURN_FLAGS_TURN_COUNT_shift;

// JUDGE
inline constexpr unsigned judge_alarm_limit_shift = description::JUDGE_ALARM_LIMIT_shift;
inline constexpr unsigned judge_turns_shift = description::JUDGE_TURNS_shift;
inline constexpr uint32_t judge_count = description::JUDGE_COUNT_mask;
inline constexpr unsigned judge_slew_shift = description::JUDGE_SLEW_shift;
inline constexpr uint32_t judge_writable =
    description::JUDGE_RADIUS_LIMIT_mask | description::JUDGE_ALARM_LIMIT_mask |
    description::JUDGE_TURNS_mask | description::JUDGE_COUNT_mask | description::JUDGE_SLEW_mask;

// CMD
inline constexpr uint32_t cmd_load = description::CMD_LOAD_mask;
inline constexpr uint32_t cmd_clear = description::CMD_CLEAR_mask;
inline constexpr uint32_t cmd_phase0 = description::CMD_PHASE0_mask;

// CORRECTION
inline constexpr uint32_t correction_value_mask = description::CORRECTION_VALUE_mask;
inline constexpr uint32_t correction_node_mask = description::CORRECTION_NODE_mask;

// What a word has in the field at a mask.
constexpr uint32_t field(uint32_t word, uint32_t mask) {
  return (word & mask) / (mask & (0 - mask));
}

// Whether a register stands at a byte offset, for reads and writes alike.
bool is_register(uint32_t offset);

// Why a write has no effect, or not all of it; empty if nothing is wrong. It depends on the write
// alone.
std::string_view write_complaint(uint32_t offset, uint32_t value);

// The 48-bit registers: pairs of an even word LO, an odd word HI. `frequency` or `phase` or the
// weight, sign-extended, as both words.
bool is_pair(uint32_t offset);
bool is_pair_high(uint32_t offset);
struct PairWords {
  uint32_t high, low;
};
PairWords pair_words(uint32_t offset, int64_t value);

}  // namespace capsoc::coprocessor
