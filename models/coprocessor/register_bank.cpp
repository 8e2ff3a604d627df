// Register accesses of the coprocessor. docs/reference/coprocessor.md, "Registers".
#include <array>

#include "base/fixed.h"
#include "coprocessor/channel_register.h"
#include "coprocessor/coprocessor.h"
#include "coprocessor/lms_demodulator.h"
#include "coprocessor/reference_generator.h"

namespace capsoc::coprocessor {

static_assert(latency_cycles == description::LATENCY_reset);

// What the registers of registers.def do.
struct Coprocessor::Registers {
  // One word: value without the LO or HI of a pair; null writes of a register that takes none.
  struct Word {
    uint32_t (*read)(const Coprocessor&) = nullptr;
    void (*write)(Coprocessor&, uint64_t cycle, uint32_t value) = nullptr;
    int64_t (*number)(const Coprocessor&) = nullptr;  // of a pair
    void (*set_number)(Coprocessor&, int64_t) = nullptr;
  };
  using Words = std::array<Word, reg_last / 4 + 1>;

  static void put(int64_t& to, int64_t value) { to = value; }
  static void put(uint64_t& to, int64_t value) { to = static_cast<uint64_t>(value) & phase_mask; }

  static constexpr uint32_t writable(uint32_t offset) {
    return rules[offset / 4].about->writable_mask;
  }

  static constexpr Words make() {
    Words words{};
#define READS(value)                               \
  [](const Coprocessor& c) -> uint32_t {           \
    [[maybe_unused]] const IdleState& s = c.arch_; \
    return static_cast<uint32_t>(value);           \
  }
#define WRITES(statement)                                                                \
  [](Coprocessor& c, [[maybe_unused]] uint64_t cycle, [[maybe_unused]] uint32_t value) { \
    [[maybe_unused]] IdleState& s = c.arch_;                                             \
    statement;                                                                           \
  }
#define SHOWS(name, shown) words[description::name##_offset / 4].read = READS(shown);
#define HOLDS(name, member)                                   \
  words[description::name##_offset / 4].read = READS(member); \
  words[description::name##_offset / 4].write = WRITES(       \
      (member) = static_cast<decltype(member)>(value & writable(description::name##_offset)));
#define ACTS(name, shown, statement)                         \
  words[description::name##_offset / 4].read = READS(shown); \
  words[description::name##_offset / 4].write = WRITES(statement);
#define NUMBER(member)                   \
  [](const Coprocessor& c) {             \
    const IdleState& s = c.arch_;        \
    return static_cast<int64_t>(member); \
  }
#define SET_NUMBER(member)             \
  [](Coprocessor& c, int64_t number) { \
    IdleState& s = c.arch_;            \
    put(member, number);               \
  }
#define PAIR(name, member)                                                                \
  words[description::name##_LO_offset / 4] = words[description::name##_HI_offset / 4] = { \
      nullptr, nullptr, NUMBER(member), SET_NUMBER(member)};
#include "coprocessor/registers.def"
#undef READS
#undef WRITES
#undef NUMBER
#undef SET_NUMBER
    return words;
  }

  // Whether registers.def has what the description has: every register, and writes where it takes
  // them.
  static constexpr bool agrees(const Words& words) {
    for (std::size_t i = 0; i < words.size(); ++i) {
      const auto& rule = rules[i];
      const Word& word = words[i];
      const bool pair = word.number != nullptr;
      if ((rule.about != nullptr) != (word.read != nullptr || pair)) return false;
      if (rule.about == nullptr) continue;
      if (pair != (rule.pair != registers::no_pair)) return false;
      if (rule.read_only() == (word.write != nullptr || pair)) return false;
    }
    return true;
  }

  // Of the register at an offset.
  static const Word& at(uint32_t offset) {
    static constexpr Words words = make();
    // With UndefinedBehaviorSanitizer g++ compares no pointers in a constant (GCC bug 71962).
#ifndef __SANITIZE_ADDRESS__
    static_assert(agrees(words), "registers.def and the register description differ");
#endif
    return words[offset / 4];
  }
};

uint32_t Coprocessor::version() const {
  return description::VERSION_reset + (options_.channels > 1 ? 1u : 0u);
}

uint32_t Coprocessor::channel_word() const {
  const Selection& selection = sequencer_.selection();
  uint32_t pending = 0;
  for (unsigned each = 0; each < channels(); ++each)
    if (raises(context(each))) pending |= 1u << each;
  return selection.window | (selection.hold ? channel::hold : 0) |
         (sequencer_.ready() ? channel::ready : 0) | (arch_.refused ? channel::refused : 0) |
         (channels() - 1) << channel::last_shift | pending << channel::pending_shift;
}

void Coprocessor::write_channel(uint64_t cycle, uint32_t value) {
  const uint32_t window = field(value, channel::window_mask);
  if (window >= channels()) {
    arch_.refused = true;
    return;
  }
  if ((value & channel::refused) != 0) arch_.refused = false;
  sequencer_.select(cycle, window, (value & channel::hold) != 0);
}

bool Coprocessor::shows(uint32_t offset, bool is_ready, bool debug) {
  if (is_ready || is_shared(offset)) return true;
  if (!debug) arch_.refused = true;
  return false;
}

uint32_t Coprocessor::status() const {
  return (sequencer_.busy() ? status_busy : 0) | (arch_.results.lock ? status_lock : 0) |
         (arch_.results.diverged ? status_diverged : 0) |
         (arch_.results.mirror ? status_mirror : 0) | (arch_.results.valid ? status_valid : 0) |
         (arch_.judge.alarm ? status_alarm : 0) | (frozen() ? status_frozen : 0) |
         (datapath_.paper() ? status_arith : 0) |
         (arch_.judge.good_turns << status_good_turns_shift);
}

uint32_t Coprocessor::turn_flags() const {
  return arch_.judge.last.flags | uint32_t{arch_.judge.turn_count} << turn_turn_count_shift;
}

uint32_t Coprocessor::loop() const {
  return arch_.settings.kp | arch_.settings.ki << loop_ki_shift;
}

uint32_t Coprocessor::judge_word() const {
  const JudgeSettings& j = arch_.judge_settings;
  return j.radius_limit | j.alarm_limit << judge_alarm_limit_shift | j.turns << judge_turns_shift |
         (j.count ? judge_count : 0) | arch_.settings.slew << judge_slew_shift;
}

RegisterAccess Coprocessor::read(uint64_t cycle, uint32_t offset, bool debug) {
  advance(cycle);
  if (is_channel_register(offset, channels())) return {true, channel_word()};
  const auto* rule = find_rule(offset);
  if (rule == nullptr) return {};
  if (!shows(offset, sequencer_.ready(), debug)) return {true, 0};
  const Registers::Word& word = Registers::at(offset);
  if (rule->pair == registers::no_pair) return {true, word.read(*this)};
  const PairWords value = pair_words(rule->pair, word.number(*this));
  if (rule->high) {
    if (!debug) arch_.latched_low[rule->pair] = value.low;
    return {true, value.high};
  }
  return {true, debug ? value.low : arch_.latched_low[rule->pair]};
}

bool Coprocessor::write(uint64_t cycle, uint32_t offset, uint32_t value) {
  advance(cycle);
  if (is_channel_register(offset, channels())) {
    write_channel(cycle, value);
    return true;
  }
  const auto* rule = find_rule(offset);
  if (rule == nullptr) return false;
  if (is_shared(offset)) return true;  // and read-only
  if (!shows(offset, sequencer_.was_ready(cycle), false) || rule->read_only()) return true;
  const bool bad_parity = (arch_.safety & safety_bad_parity) != 0;
  uint64_t parity = parity_bit(offset) & parity_bits;
  if (!rule->in_range(value)) {
    arch_.flags |= flag_config;
    return true;
  }
  if (rule->pair != registers::no_pair) {
    write_pair(*rule, value);
    parity = rule->high ? parity_bit(offset - 4) : 0;
  } else {
    Registers::at(offset).write(*this, cycle, value);
    if (offset == reg_ctrl && (value & ctrl_srst) != 0) return true;
    if (offset == reg_cmd && (value & cmd_phase0) != 0) parity = parity_bit(reg_phase_lo);
  }
  arch_.unfit = bad_parity ? arch_.unfit | parity : arch_.unfit & ~parity;
  return true;
}

void Coprocessor::write_pair(const registers::RegisterRule& rule, uint32_t value) {
  uint32_t& staged_low = arch_.staged_low[rule.pair];
  if (!rule.high) {
    staged_low = value;
    return;
  }
  int64_t number = pair_value(rule.pair, {value, staged_low});
  staged_low = 0;
  if (datapath_.paper() && rule.pair >= pair_au) {
    bool clamped = false;
    number = fixed::scale_up(fixed::saturate<32>(weight_q31(number), clamped), 15);
  }
  Registers::at(rule.about->offset).set_number(*this, number);
}

void Coprocessor::write_ctrl(uint32_t value) {
  if (value & ctrl_srst) {
    soft_reset();
    return;
  }
  uint32_t source = field(value, ctrl_ref_mask);
  if (source == 3) {
    arch_.flags |= flag_config;
    source = static_cast<uint32_t>(arch_.settings.source);
  }
  if ((value & ctrl_block) != 0 && !options_.block_learning) arch_.flags |= flag_config;
  if (!options_.block_learning) value &= ~(ctrl_block | ctrl_guard);
  if ((value & ctrl_correct) != 0 && !options_.harmonic_correction) arch_.flags |= flag_config;
  if (!options_.harmonic_correction) value &= ~ctrl_correct;
  if (!options_.safety) value &= ~ctrl_ie_safety;
  arch_.ctrl = (value & ctrl_writable & ~ctrl_ref_mask) | (source << ctrl_ref_shift);
  arch_.settings.block = (arch_.ctrl & ctrl_block) != 0;
  arch_.settings.guard = (arch_.ctrl & ctrl_guard) != 0;
  arch_.settings.correct = (arch_.ctrl & ctrl_correct) != 0;
  arch_.settings.demodulate = (arch_.ctrl & ctrl_demod) != 0;
  arch_.settings.source = static_cast<ReferenceSource>(source);
}

void Coprocessor::write_correction(uint32_t value) {
  if (sequencer_.busy() || !options_.harmonic_correction) {
    arch_.flags |= flag_config;
    return;
  }
  const uint32_t node = field(value, correction_node_mask);
  const uint32_t word = field(value, correction_value_mask);
  arch_.corrections[node] = static_cast<int32_t>(fixed::sign_extend<20>(word));
  uint64_t& unfit = arch_.unfit_corrections[node / 64];
  const uint64_t bit = uint64_t{1} << node % 64;
  unfit = (arch_.safety & safety_bad_parity) != 0 ? unfit | bit : unfit & ~bit;
}

void Coprocessor::write_safety(uint32_t value) {
  if (options_.safety)
    arch_.safety = value & safety_writable;
  else
    arch_.flags |= flag_config;
}

void Coprocessor::write_command(uint64_t cycle, uint32_t value) {
  if (value & cmd_load) sequencer_.request_load(cycle);
  if (value & cmd_clear) arch_.samples = arch_.early_count = 0;
  if (value & cmd_phase0) arch_.state.reference.phase = 0;
}

void Coprocessor::write_loop(uint32_t value) {
  arch_.settings.kp = field(value, loop_kp_mask);
  arch_.settings.ki = field(value, loop_ki_mask);
}

void Coprocessor::write_judge(uint32_t value) {
  JudgeSettings& j = arch_.judge_settings;
  j.radius_limit = field(value, judge_radius_limit_mask);
  j.alarm_limit = field(value, judge_alarm_limit_mask);
  j.turns = field(value, judge_turns_mask);
  j.count = (value & judge_count) != 0;
  arch_.settings.slew = field(value, judge_slew_mask);
}

}  // namespace capsoc::coprocessor
