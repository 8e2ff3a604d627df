#include "rtl/rtl_state.h"

#include <algorithm>
#include <array>
#include <iterator>

#include "coprocessor/coprocessor.h"
#include "coprocessor/register_map.h"

namespace capsoc::rtl {

using coprocessor::Coprocessor;
using coprocessor::IdleState;
using coprocessor::Nodes;
using coprocessor::Results;
using coprocessor::TurnJudge;
using coprocessor::TurnRecord;

namespace {

// rtl/register_bank.sv: of a pair the memory's even word is the stage, the odd one the read latch.
constexpr std::array<uint32_t, coprocessor::pair_count> pair_words = {
    coprocessor::word_freq_lo, coprocessor::word_phase_lo, coprocessor::word_au_lo,
    coprocessor::word_bu_lo,   coprocessor::word_cu_lo,    coprocessor::word_av_lo,
    coprocessor::word_bv_lo,   coprocessor::word_cv_lo};

// rtl/results_memory.sv: words of a slot; rtl/turn_judge.sv: words by slot, words of a bank.
constexpr uint64_t average_at = 8, det_at = 22, record_at = 24;

// Settings that the bus reads back from the memory: address there, offset, register.
struct Setting {
  uint32_t word, offset;
  uint64_t capsoc_rtl_state::*value;
};
constexpr Setting settings[] = {
#define WORD(name, bits, instance, variable)
#define WORDS(name, count, bits, instance, variable)
#define SETTING(name, bits) \
  {coprocessor::word_##name, coprocessor::reg_##name, &capsoc_rtl_state::name},
#include "rtl/rtl_state.def"
#undef WORD
#undef WORDS
};

struct Bit {
  uint32_t mask;
  uint64_t capsoc_rtl_state::*value;
};
constexpr std::array<Bit, 13> ctrl_bits = {
    {{coprocessor::ctrl_demod, &capsoc_rtl_state::demod},
     {coprocessor::ctrl_calib, &capsoc_rtl_state::calib},
     {coprocessor::ctrl_adc, &capsoc_rtl_state::adc},
     {coprocessor::ctrl_freeze, &capsoc_rtl_state::freeze},
     {coprocessor::ctrl_block, &capsoc_rtl_state::block},
     {coprocessor::ctrl_guard, &capsoc_rtl_state::guard},
     {coprocessor::ctrl_correct, &capsoc_rtl_state::correct},
     {coprocessor::ctrl_ie_result, &capsoc_rtl_state::ie_result},
     {coprocessor::ctrl_ie_lock, &capsoc_rtl_state::ie_lock},
     {coprocessor::ctrl_ie_error, &capsoc_rtl_state::ie_error},
     {coprocessor::ctrl_ie_turn, &capsoc_rtl_state::ie_turn},
     {coprocessor::ctrl_ie_alarm, &capsoc_rtl_state::ie_alarm},
     {coprocessor::ctrl_ie_safety, &capsoc_rtl_state::ie_safety}}};
constexpr std::array<Bit, 5> window_bits = {
    {{coprocessor::turn_radius, &capsoc_rtl_state::window_radius},
     {coprocessor::turn_mirror, &capsoc_rtl_state::window_mirror},
     {coprocessor::turn_noangle, &capsoc_rtl_state::window_no_angle},
     {coprocessor::turn_sat, &capsoc_rtl_state::window_saturated},
     {coprocessor::turn_residue, &capsoc_rtl_state::window_residue}}};

constexpr std::array<Bit, 4> safety_fields = {
    {{coprocessor::safety_parity | coprocessor::safety_misfit | coprocessor::safety_jump |
          coprocessor::safety_missed,
      &capsoc_rtl_state::mechanisms},
     {coprocessor::safety_bad_parity, &capsoc_rtl_state::bad_parity},
     {coprocessor::safety_error_limit_mask, &capsoc_rtl_state::error_limit},
     {coprocessor::safety_step_limit_mask, &capsoc_rtl_state::step_limit}}};

bool odd(uint64_t word) {
  return __builtin_parityll(word) != 0;
}

constexpr unsigned node_bits = 20, sum_bits = 48;

/// A word of a memory with its parity bit above: they have an even number of ones together, unless
/// the word is unfit.
template <unsigned bits>
uint64_t with_parity(uint64_t word, bool is_unfit) {
  word &= (uint64_t{1} << bits) - 1;
  return word | uint64_t{odd(word) != is_unfit} << bits;
}

uint64_t word48(uint64_t word) {
  return word & coprocessor::phase_mask;
}

int64_t extended(uint64_t word) {
  return static_cast<int64_t>(word << 16) >> 16;
}

uint32_t low32(uint64_t word) {
  return static_cast<uint32_t>(word);
}

int32_t signed32(uint64_t word) {
  return static_cast<int32_t>(low32(word));
}

uint64_t word(int32_t value) {
  return static_cast<uint32_t>(value);
}

// The shared registers and the model's, in the same order.
std::array<uint64_t*, 6> weights_of(capsoc_rtl_state& r) {
  return {&r.au, &r.bu, &r.cu, &r.av, &r.bv, &r.cv};
}

std::array<int64_t*, 6> weights_of(coprocessor::Coefficients& c) {
  return {&c.u.sine, &c.u.cosine, &c.u.constant, &c.v.sine, &c.v.cosine, &c.v.constant};
}

void set_record(uint64_t (&words)[32], uint64_t bank, const TurnRecord& record) {
  words[det_at + bank] = word(record.det);
  uint64_t* const place = &words[record_at + 4 * bank];
  place[0] = record.radius_max;
  place[1] = record.residue_max;
  place[2] = word(record.winding);
  place[3] = record.samples;
}

TurnRecord record_in(const uint64_t (&words)[32], uint64_t bank, uint32_t flags) {
  const uint64_t* const place = &words[record_at + 4 * bank];
  return {low32(place[0]),
          low32(place[1]),
          signed32(place[2]),
          low32(place[3]),
          signed32(words[det_at + bank]),
          flags};
}

void set_settings(capsoc_rtl_state& r, const IdleState& state) {
  Coprocessor model({});
  model.load_idle(state);
  const auto read = [&](uint32_t offset) -> uint64_t {
    return model.read(state.cycle, offset, true).value;
  };
  for (const Bit& bit : ctrl_bits) r.*bit.value = (state.ctrl & bit.mask) != 0 ? 1 : 0;
  r.ref = coprocessor::field(state.ctrl, coprocessor::ctrl_ref_mask);
  r.kp = state.settings.kp;
  r.ki = state.settings.ki;
  const auto put = [&](uint32_t address, uint64_t value) {
    r.bank_words[address] = value;
    r.bank_valid |= uint64_t{1} << address;
  };
  for (const Setting& setting : settings) {
    r.*setting.value = read(setting.offset);
    put(setting.word, r.*setting.value);
  }
  put(coprocessor::word_safety, state.safety);
  for (const Bit& part : safety_fields) r.*part.value = coprocessor::field(state.safety, part.mask);
  put(coprocessor::word_soft_u, state.soft_u);
  for (std::size_t pair = 0; pair < pair_words.size(); ++pair) {
    put(pair_words[pair], state.staged_low[pair]);
    put(pair_words[pair] + 1, state.latched_low[pair]);
  }
}

void get_settings(const capsoc_rtl_state& r, IdleState& state) {
  Coprocessor model({});
  uint32_t ctrl = low32(r.ref) << coprocessor::ctrl_ref_shift;
  for (const Bit& bit : ctrl_bits) ctrl |= r.*bit.value != 0 ? bit.mask : 0;
  model.write(0, coprocessor::reg_ctrl, ctrl);
  model.write(0, coprocessor::reg_loop,
              low32(r.kp | r.ki << coprocessor::description::LOOP_KI_shift));
  for (const Setting& setting : settings) model.write(0, setting.offset, low32(r.*setting.value));
  uint32_t safety = 0;
  for (const Bit& part : safety_fields)
    safety |= low32(r.*part.value) * (part.mask & (0 - part.mask));
  model.write(0, coprocessor::reg_safety, safety);
  model.save_idle(state);
  const auto at = [&](uint32_t address) {
    return (r.bank_valid >> address & 1) != 0 ? low32(r.bank_words[address]) : 0;
  };
  state.soft_u = at(coprocessor::word_soft_u);
  for (std::size_t pair = 0; pair < pair_words.size(); ++pair) {
    state.staged_low[pair] = at(pair_words[pair]);
    state.latched_low[pair] = at(pair_words[pair] + 1);
  }
}

void set_state(capsoc_rtl_state& r, coprocessor::State state) {
  r.freq = static_cast<uint64_t>(state.reference.frequency);
  r.phase = state.reference.phase;
  const auto weights = weights_of(state.coefficients);
  for (std::size_t i = 0; i < weights.size(); ++i)
    *weights_of(r)[i] = static_cast<uint64_t>(*weights[i]);
  r.a1 = word(state.parameters.a1);
  r.a2 = word(state.parameters.a2);
  r.b1 = word(state.parameters.b1);
  r.b2 = word(state.parameters.b2);
  r.beta = state.parameters.beta;
  r.phi = state.parameters.phi;
  r.error_sum_u = state.error_sum_u;
  r.error_sum_v = state.error_sum_v;
  const auto sums = weights_of(state.block.sums);
  for (std::size_t i = 0; i < sums.size(); ++i)
    r.block_sums[i] =
        with_parity<sum_bits>(static_cast<uint64_t>(*sums[i]), (state.block.unfit >> i & 1) != 0);
  r.block_open = state.block.open ? 1 : 0;
  r.block_begun = state.block.begun ? 1 : 0;
  r.block_within = state.block.window_ended ? 0 : 1;
}

void get_state(capsoc_rtl_state r, coprocessor::State& state) {
  state.reference = {r.phase, extended(r.freq)};
  const auto weights = weights_of(state.coefficients);
  for (std::size_t i = 0; i < weights.size(); ++i) *weights[i] = extended(*weights_of(r)[i]);
  state.parameters = {signed32(r.a1), signed32(r.a2), signed32(r.b1),
                      signed32(r.b2), low32(r.beta),  low32(r.phi)};
  // Until the first boundary after a reset the sums hold what they held.
  state.error_sum_u = r.error_empty != 0 ? 0 : r.error_sum_u;
  state.error_sum_v = r.error_empty != 0 ? 0 : r.error_sum_v;
  // A sum is nothing before its first sample.
  const auto sums = weights_of(state.block.sums);
  state.block.unfit = 0;
  for (std::size_t i = 0; r.block_begun != 0 && i < sums.size(); ++i) {
    *sums[i] = extended(r.block_sums[i]);
    state.block.unfit |= unsigned{odd(r.block_sums[i])} << i;
  }
  state.block.open = r.block_open != 0;
  state.block.begun = r.block_begun != 0;
  state.block.window_ended = r.block_within == 0;
}

void set_results(capsoc_rtl_state& r, const Results& results) {
  r.result_any = r.angle_any = 1;  // with words of 0 it makes no difference
  r.sample_words[0] = results.raw_u;
  r.sample_words[1] = results.raw_v;
  r.sample_words[2] = results.cal_s;
  r.sample_words[3] = results.cal_c;
  r.error_words[0] = results.reference_phase;
  r.error_words[1] = results.error_u;
  r.error_words[2] = results.error_v;
  r.error_words[3] = results.residue;
  r.quality_words[0] = results.amplitude;
  r.quality_words[average_at] = results.error_average;
  r.angle = results.angle;
  r.lock = results.lock ? 1 : 0;
  r.diverged = results.diverged ? 1 : 0;
  r.mirror = results.mirror ? 1 : 0;
  r.valid = results.valid ? 1 : 0;
}

Results results_in(const capsoc_rtl_state& r) {
  Results results;
  if (r.result_any != 0) {
    const uint64_t* const sample = &r.sample_words[4 * r.result_slot];
    const uint64_t* const error = &r.error_words[4 * r.result_slot];
    results.raw_u = low32(sample[0]);
    results.raw_v = low32(sample[1]);
    results.cal_s = low32(sample[2]);
    results.cal_c = low32(sample[3]);
    results.reference_phase = low32(error[0]);
    results.error_u = low32(error[1]);
    results.error_v = low32(error[2]);
    results.residue = low32(error[3]);
    results.amplitude = low32(r.quality_words[r.result_slot]);
    results.error_average = low32(r.quality_words[average_at + r.result_slot % 4]);
  }
  if (r.angle_any != 0) results.angle = low32(r.angle);
  results.lock = r.lock != 0;
  results.diverged = r.diverged != 0;
  results.mirror = r.mirror != 0;
  results.valid = r.valid != 0;
  return results;
}

// A register of rtl/state_registers.sv: its word, its parity bit.
struct SharedRegister {
  uint32_t offset;
  uint64_t capsoc_rtl_state::*value;
  uint64_t capsoc_rtl_state::*parity;
};
constexpr std::array<SharedRegister, 14> shared_registers = {
    {{coprocessor::reg_freq_lo, &capsoc_rtl_state::freq, &capsoc_rtl_state::freq_parity},
     {coprocessor::reg_phase_lo, &capsoc_rtl_state::phase, &capsoc_rtl_state::phase_parity},
     {coprocessor::reg_au_lo, &capsoc_rtl_state::au, &capsoc_rtl_state::au_parity},
     {coprocessor::reg_bu_lo, &capsoc_rtl_state::bu, &capsoc_rtl_state::bu_parity},
     {coprocessor::reg_cu_lo, &capsoc_rtl_state::cu, &capsoc_rtl_state::cu_parity},
     {coprocessor::reg_av_lo, &capsoc_rtl_state::av, &capsoc_rtl_state::av_parity},
     {coprocessor::reg_bv_lo, &capsoc_rtl_state::bv, &capsoc_rtl_state::bv_parity},
     {coprocessor::reg_cv_lo, &capsoc_rtl_state::cv, &capsoc_rtl_state::cv_parity},
     {coprocessor::reg_a1, &capsoc_rtl_state::a1, &capsoc_rtl_state::a1_parity},
     {coprocessor::reg_a2, &capsoc_rtl_state::a2, &capsoc_rtl_state::a2_parity},
     {coprocessor::reg_b1, &capsoc_rtl_state::b1, &capsoc_rtl_state::b1_parity},
     {coprocessor::reg_b2, &capsoc_rtl_state::b2, &capsoc_rtl_state::b2_parity},
     {coprocessor::reg_beta, &capsoc_rtl_state::beta, &capsoc_rtl_state::beta_parity},
     {coprocessor::reg_phi, &capsoc_rtl_state::phi, &capsoc_rtl_state::phi_parity}}};

// A register of rtl/setting_registers.sv, or one of the settings that it holds: what its parity bit
// should be, and where that bit is.
struct SettingParity {
  uint32_t offset;
  bool odd;
  uint64_t capsoc_rtl_state::*bits;
  unsigned place;
};
constexpr std::size_t special_count = 3;
std::array<SettingParity, special_count + std::size(settings)> setting_parities(
    const capsoc_rtl_state& r) {
  bool ctrl = odd(r.ref);
  for (const Bit& bit : ctrl_bits) ctrl ^= odd(r.*bit.value);
  bool safety = false;
  for (const Bit& part : safety_fields) safety ^= odd(r.*part.value);
  std::array<SettingParity, special_count + std::size(settings)> parities{
      {{coprocessor::reg_ctrl, ctrl, &capsoc_rtl_state::settings_parity, 0},
       {coprocessor::reg_loop, odd(r.kp) != odd(r.ki), &capsoc_rtl_state::settings_parity, 1},
       {coprocessor::reg_safety, safety, &capsoc_rtl_state::settings_parity, 2}}};
  for (unsigned i = 0; i < std::size(settings); ++i)
    parities[special_count + i] = {settings[i].offset, odd(r.*settings[i].value),
                                   &capsoc_rtl_state::registers_parity, i};
  return parities;
}

void set_parity(capsoc_rtl_state& r, uint64_t unfit) {
  const auto bad = [&](uint32_t offset) { return (unfit & coprocessor::parity_bit(offset)) != 0; };
  for (const SharedRegister& it : shared_registers)
    r.*it.parity = odd(word48(r.*it.value)) != bad(it.offset) ? 1 : 0;
  for (const SettingParity& it : setting_parities(r))
    r.*it.bits |= uint64_t{it.odd != bad(it.offset)} << it.place;
}

uint64_t unfit_in(const capsoc_rtl_state& r) {
  uint64_t unfit = 0;
  for (const SharedRegister& it : shared_registers)
    if (odd(word48(r.*it.value)) != odd(r.*it.parity)) unfit |= coprocessor::parity_bit(it.offset);
  for (const SettingParity& it : setting_parities(r))
    if (it.odd != odd(r.*it.bits >> it.place & 1)) unfit |= coprocessor::parity_bit(it.offset);
  return unfit;
}

// Every sample sets an octant, so a window without flags has none.
void set_judge(capsoc_rtl_state& r, const TurnJudge& judge) {
  const uint32_t flags = judge.window.flags;
  r.fresh = flags == 0 ? 1 : 0;
  r.bank = 0;
  r.any_window = 1;  // with words of 0 it makes no difference
  r.any_sample = judge.any ? 1 : 0;
  r.alarm = judge.alarm ? 1 : 0;
  r.glitches = judge.glitches;
  r.good_turns = judge.good_turns;
  r.turn_count = judge.turn_count;
  r.last_flags = judge.last.flags;
  r.last_angle = judge.last_angle >> 2;
  r.octants = flags & coprocessor::turn_octants_mask;
  r.clipped = coprocessor::field(flags, coprocessor::turn_clipped_mask);
  r.window_wild = judge.wild ? 1 : 0;
  for (const Bit& bit : window_bits) r.*bit.value = (flags & bit.mask) != 0 ? 1 : 0;
  for (auto* words : {&r.judge_words, &r.quality_words}) {
    set_record(*words, 0, judge.window);
    set_record(*words, 1, judge.last);
  }
}

TurnJudge judge_in(const capsoc_rtl_state& r, const Nodes& nodes) {
  TurnJudge judge;
  if (r.fresh == 0) {
    uint32_t flags = low32(r.octants | r.clipped << coprocessor::turn_clipped_shift);
    for (const Bit& bit : window_bits) flags |= r.*bit.value != 0 ? bit.mask : 0;
    judge.window = record_in(r.judge_words, r.bank, flags);
    judge.wild = r.window_wild != 0;
  }
  if (r.any_window != 0) judge.last = record_in(r.quality_words, 1 - r.bank, low32(r.last_flags));
  judge.turn_count = static_cast<uint8_t>(r.turn_count);
  judge.good_turns = static_cast<unsigned>(r.good_turns);
  judge.glitches = static_cast<unsigned>(r.glitches);
  judge.alarm = r.alarm != 0;
  judge.any = r.any_sample != 0;
  if (!judge.any) return judge;
  // The register has no use for the lowest two bits.
  judge.last_angle =
      low32(r.last_angle) << 2 | (low32(static_cast<uint64_t>(nodes.found_angle)) & 3);
  judge.deviation = low32(static_cast<uint64_t>(nodes.deviation));
  judge.travel = static_cast<int32_t>(nodes.travel);
  judge.ended = r.fresh != 0;
  return judge;
}

}  // namespace

capsoc_rtl_state to_rtl(const IdleState& state) {
  capsoc_rtl_state r{};
  set_settings(r, state);
  set_state(r, state.state);
  set_results(r, state.results);
  set_judge(r, state.judge);
  r.flags = state.flags;
  r.samples = state.samples;
  r.early = state.early_count;
  r.settled = std::min(state.settled, 63u);
  set_parity(r, state.unfit);
  for (std::size_t i = 0; i < state.corrections.size(); ++i)
    r.corrections[i] = with_parity<node_bits>(word(state.corrections[i]),
                                              (state.unfit_corrections[i / 64] >> i % 64 & 1) != 0);
  return r;
}

IdleState to_model(const capsoc_rtl_state& registers, const Nodes& nodes) {
  IdleState state;
  get_settings(registers, state);
  get_state(registers, state.state);
  state.results = results_in(registers);
  state.judge = judge_in(registers, nodes);
  state.flags = low32(registers.flags);
  state.samples = low32(registers.samples);
  state.early_count = low32(registers.early);
  // 63 stands for more, too.
  state.settled = static_cast<unsigned>(registers.settled) +
                  (registers.settled == 63 && nodes.commits > 63 ? 1 : 0);
  for (std::size_t i = 0; i < state.corrections.size(); ++i) {
    state.corrections[i] =
        static_cast<int32_t>(fixed::sign_extend<node_bits>(registers.corrections[i]));
    state.unfit_corrections[i / 64] |= uint64_t{odd(registers.corrections[i])} << i % 64;
  }
  state.unfit = unfit_in(registers);
  state.nodes = nodes;
  return state;
}

}  // namespace capsoc::rtl
