// Register map of the coprocessor, as far as the model needs names (docs/coprocessor.md).
#pragma once

#include <cstdint>
#include <string_view>

namespace capsoc::coprocessor {

enum Offset : uint32_t {
  reg_id = 0x000,
  reg_version = 0x004,
  reg_ctrl = 0x008,
  reg_status = 0x00C,
  reg_flags = 0x010,
  reg_cmd = 0x014,
  reg_freq_lo = 0x018,
  reg_freq_hi = 0x01C,
  reg_phase_lo = 0x020,
  reg_phase_hi = 0x024,
  reg_step_au = 0x028,  // then BU, CU, AV, BV
  reg_step_cv = 0x03C,
  reg_loop = 0x040,
  reg_lock_threshold = 0x044,
  reg_diverge_threshold = 0x048,
  reg_error_average = 0x04C,
  reg_au_lo = 0x050,  // then AU_HI, BU_LO ...
  reg_cv_hi = 0x07C,
  reg_a1 = 0x080,
  reg_a2 = 0x084,
  reg_b1 = 0x088,
  reg_b2 = 0x08C,
  reg_beta = 0x090,
  reg_phi = 0x094,
  reg_judge = 0x098,
  reg_turn_limit = 0x09C,
  reg_soft_u = 0x0A0,
  reg_soft_v = 0x0A4,
  reg_raw_u = 0x0B0,
  reg_raw_v = 0x0B4,
  reg_cal_s = 0x0B8,
  reg_cal_c = 0x0BC,
  reg_angle = 0x0C0,
  reg_err_u = 0x0C4,
  reg_err_v = 0x0C8,
  reg_residue = 0x0CC,
  reg_samples = 0x0D0,
  reg_early_count = 0x0D4,
  reg_ref_phase = 0x0D8,
  reg_amplitude = 0x0DC,
  reg_latency = 0x0E0,
  reg_turn_flags = 0x0E4,
  reg_radius_max = 0x0EC,
  reg_residue_max = 0x0F0,
  reg_winding = 0x0F4,
  reg_turn_samples = 0x0F8,
  reg_turn_det = 0x0FC,
  reg_last = reg_turn_det,
};

inline constexpr uint32_t id_value = 0x43415053;
inline constexpr uint32_t version_value = 0x00010001;

// CTRL
inline constexpr uint32_t ctrl_demod = 1u << 0;
inline constexpr uint32_t ctrl_calib = 1u << 1;
inline constexpr unsigned ctrl_ref_shift = 2;
inline constexpr uint32_t ctrl_ref_mask = 3u << ctrl_ref_shift;
inline constexpr uint32_t ctrl_adc = 1u << 4;
inline constexpr uint32_t ctrl_freeze = 1u << 5;
inline constexpr uint32_t ctrl_ie_result = 1u << 8;
inline constexpr uint32_t ctrl_ie_lock = 1u << 9;
inline constexpr uint32_t ctrl_ie_error = 1u << 10;
inline constexpr uint32_t ctrl_ie_turn = 1u << 11;
inline constexpr uint32_t ctrl_ie_alarm = 1u << 12;
inline constexpr uint32_t ctrl_srst = 1u << 31;
inline constexpr uint32_t ctrl_writable = ctrl_demod | ctrl_calib | ctrl_ref_mask | ctrl_adc |
                                          ctrl_freeze | ctrl_ie_result | ctrl_ie_lock |
                                          ctrl_ie_error | ctrl_ie_turn | ctrl_ie_alarm;

// STATUS
inline constexpr uint32_t status_busy = 1u << 0;
inline constexpr uint32_t status_lock = 1u << 1;
inline constexpr uint32_t status_diverged = 1u << 2;
inline constexpr uint32_t status_mirror = 1u << 3;
inline constexpr uint32_t status_valid = 1u << 4;
inline constexpr uint32_t status_alarm = 1u << 5;
inline constexpr uint32_t status_frozen = 1u << 6;
inline constexpr unsigned status_good_turns_shift = 12;
inline constexpr uint32_t status_arith = 1u << 8;

// FLAGS
inline constexpr uint32_t flag_result = 1u << 0;
inline constexpr uint32_t flag_clip = 1u << 1;
inline constexpr uint32_t flag_sat = 1u << 2;
inline constexpr uint32_t flag_zero = 1u << 3;
inline constexpr uint32_t flag_early = 1u << 4;
inline constexpr uint32_t flag_lockchg = 1u << 5;
inline constexpr uint32_t flag_diverged = 1u << 6;
inline constexpr uint32_t flag_mirrorchg = 1u << 7;
inline constexpr uint32_t flag_config = 1u << 8;
inline constexpr uint32_t flag_turn = 1u << 9;
inline constexpr uint32_t flag_alarm = 1u << 10;
inline constexpr uint32_t flag_unsettled = 1u << 11;
inline constexpr unsigned flag_count = 12;
inline constexpr uint32_t flags_all = (1u << flag_count) - 1;
inline constexpr uint32_t flags_error =
    flag_clip | flag_sat | flag_zero | flag_early | flag_diverged | flag_config | flag_unsettled;

// TURN_FLAGS
inline constexpr uint32_t turn_octants_mask = 0xFF;
inline constexpr unsigned turn_clipped_shift = 8;
inline constexpr uint32_t turn_clipped_mask = 0xFFu << turn_clipped_shift;
inline constexpr uint32_t turn_timeout = 1u << 16;
inline constexpr uint32_t turn_radius = 1u << 17;
inline constexpr uint32_t turn_winding = 1u << 18;
inline constexpr uint32_t turn_mirror = 1u << 19;
inline constexpr uint32_t turn_noangle = 1u << 20;
inline constexpr uint32_t turn_sat = 1u << 21;
inline constexpr uint32_t turn_good = 1u << 22;
inline constexpr unsigned turn_count_shift = 24;

// JUDGE
inline constexpr unsigned judge_alarm_limit_shift = 8;
inline constexpr unsigned judge_turns_shift = 16;
inline constexpr uint32_t judge_count = 1u << 18;
inline constexpr unsigned judge_slew_shift = 19;
inline constexpr uint32_t judge_writable = (1u << 22) - 1;

// CMD
inline constexpr uint32_t cmd_load = 1u << 0;
inline constexpr uint32_t cmd_clear = 1u << 1;
inline constexpr uint32_t cmd_phase0 = 1u << 2;

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
