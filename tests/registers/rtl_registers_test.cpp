// Verilated sequencer and register bank against the C++ model, cycle by cycle under random bus
// traffic and samples. The test plays the datapath: what the model's pipeline is about to write at
// an edge is what the bank is given there.
#include <gtest/gtest.h>
#include <verilated.h>

#include <array>
#include <memory>
#include <random>

#include "Vregister_bench_paper.h"
#include "Vregister_bench_precise.h"
#include "capsoc_registers.h"
#include "coprocessor/coprocessor.h"
#include "likely_word.h"

// Verilator's library asks for it.
double sc_time_stamp() {
  return 0;
}

namespace {

using capsoc::coprocessor::Arithmetic;
using capsoc::coprocessor::Coprocessor;
using capsoc::coprocessor::likely_word;
using capsoc::coprocessor::Options;
namespace table = capsoc::registers::coprocessor;

// Results by result_select_o.
constexpr std::array<uint32_t, 16> result_offsets = {
    table::RAW_U_offset,       table::RAW_V_offset,         table::CAL_S_offset,
    table::CAL_C_offset,       table::ANGLE_offset,         table::ERR_U_offset,
    table::ERR_V_offset,       table::RESIDUE_offset,       table::REF_PHASE_offset,
    table::AMPLITUDE_offset,   table::ERROR_AVERAGE_offset, table::RADIUS_MAX_offset,
    table::RESIDUE_MAX_offset, table::WINDING_offset,       table::TURN_SAMPLES_offset,
    table::TURN_DET_offset};

constexpr uint64_t mask48 = (uint64_t{1} << 48) - 1;

struct Stimulus {
  bool select = false, enable = false, write = false;
  uint32_t address = 0, data = 0, strobe = 0xF;
  bool sample = false, clip = false;
  uint32_t u = 0, v = 0;
};

template <typename Rtl>
class Bench {
 public:
  explicit Bench(Arithmetic arithmetic) : model_(options(arithmetic)) {
    context_ = std::make_unique<VerilatedContext>();
    rtl_ = std::make_unique<Rtl>(context_.get());
    rtl_->rst_ni = 1;
    rtl_->eval();
    rtl_->rst_ni = 0;
    clock();
    rtl_->rst_ni = 1;
    rtl_->eval();
  }
  ~Bench() { rtl_->final(); }

  // Interval `cycle` with these inputs and the edge that ends it; false after a difference.
  bool step(const Stimulus& s) {
    model_.advance(cycle_);
    drive(s);
    give_updates();
    give_result();
    compare_state();
    const bool access = s.select && s.enable;
    const bool bad_strobe = s.write && s.strobe != 0xF;
    bool mapped = true;
    if (access && !s.write) {
      const auto read = model_.read(cycle_, s.address, false);
      mapped = read.ok;
      expect("prdata", rtl_->prdata_o, read.value);
      seen_ = rtl_->prdata_o;
    }
    const bool ready = rtl_->sample_ready_o;
    const bool error = rtl_->pslverr_o;
    ++cycle_;
    bool latched = false;
    const bool adc = (model_ctrl_ & capsoc::coprocessor::ctrl_adc) != 0;
    if (s.sample)
      latched = model_.submit(cycle_, static_cast<int32_t>(s.u), static_cast<int32_t>(s.v), s.clip);
    else
      model_.advance(cycle_);
    if (s.sample) expect("sample_ready", ready, latched);
    if (!adc) expect("sample_ready without CTRL.ADC", ready, false);
    if (access && s.write && !bad_strobe) mapped = model_.write(cycle_, s.address, s.data);
    if (access && bad_strobe)
      expect("pslverr", error, true);
    else
      expect("pslverr", error, access && !mapped);
    clock();
    return !::testing::Test::HasFailure();
  }

  uint64_t cycle() const { return cycle_; }

  void write(uint32_t offset, uint32_t value) { step(access(offset, true, value)); }
  // What the RTL shows.
  uint32_t read(uint32_t offset) {
    step(access(offset, false, 0));
    return seen_;
  }

 private:
  static Stimulus access(uint32_t offset, bool write, uint32_t value) {
    Stimulus s;
    s.select = s.enable = true;
    s.write = write;
    s.address = offset;
    s.data = value;
    return s;
  }

  static Options options(Arithmetic arithmetic) {
    Options made;
    made.arithmetic = arithmetic;
    return made;
  }

  void expect(const char* what, uint64_t actual, uint64_t expected) {
    EXPECT_EQ(actual, expected) << what << " in interval " << cycle_ << std::hex << ", address "
                                << static_cast<unsigned>(rtl_->paddr_i);
  }

  void clock() {
    rtl_->clk_i = 1;
    rtl_->eval();
    rtl_->clk_i = 0;
    rtl_->eval();
  }

  void drive(const Stimulus& s) {
    rtl_->psel_i = s.select;
    rtl_->penable_i = s.enable;
    rtl_->pwrite_i = s.write;
    rtl_->paddr_i = static_cast<uint16_t>(s.address);
    rtl_->pwdata_i = s.data;
    rtl_->pstrb_i = static_cast<uint8_t>(s.strobe);
    rtl_->sample_valid_i = s.sample;
    rtl_->sample_u_i = s.u;
    rtl_->sample_v_i = s.v;
    rtl_->sample_clip_i = s.clip;
  }

  static uint32_t peek(Coprocessor& model, uint64_t cycle, uint32_t offset) {
    return model.read(cycle, offset, true).value;
  }

  static uint64_t pair(Coprocessor& model, uint64_t cycle, uint32_t low) {
    const uint32_t lower = peek(model, cycle, low);
    const uint32_t upper = peek(model, cycle, low + 4);
    if (low < table::AU_LO_offset) return uint64_t{upper} << 16 | lower;
    return static_cast<uint64_t>(static_cast<int64_t>(static_cast<int32_t>(upper)) * 32768 +
                                 static_cast<int32_t>(lower)) &
           mask48;
  }

  // The datapath's outputs: at a boundary what the model has after it, otherwise noise.
  void give_updates() {
    rtl_->eval();
    const uint32_t status = peek(model_, cycle_, table::STATUS_offset);
    rtl_->status_i = static_cast<uint8_t>((status >> 1 & 0x1F) | (status >> 12 & 3) << 5);
    rtl_->turn_flags_i = peek(model_, cycle_, table::TURN_FLAGS_offset);
    if (!rtl_->boundary_o) {
      rtl_->write_all_i = noise_() & 1;
      rtl_->flags_i = noise_() & 0x1FFF;
      rtl_->phase_i = rtl_->freq_i = rtl_->au_i = rtl_->cv_i = noise_() & mask48;
      rtl_->a1_i = rtl_->phi_i = static_cast<uint32_t>(noise_());
      return;
    }
    Coprocessor next = model_;
    const uint64_t edge = cycle_ + 1;
    next.advance(edge);
    rtl_->write_all_i = 1;
    rtl_->freq_i = pair(next, edge, table::FREQ_LO_offset);
    rtl_->phase_i = pair(next, edge, table::PHASE_LO_offset);
    rtl_->au_i = pair(next, edge, table::AU_LO_offset);
    rtl_->bu_i = pair(next, edge, table::BU_LO_offset);
    rtl_->cu_i = pair(next, edge, table::CU_LO_offset);
    rtl_->av_i = pair(next, edge, table::AV_LO_offset);
    rtl_->bv_i = pair(next, edge, table::BV_LO_offset);
    rtl_->cv_i = pair(next, edge, table::CV_LO_offset);
    rtl_->a1_i = peek(next, edge, table::A1_offset);
    rtl_->a2_i = peek(next, edge, table::A2_offset);
    rtl_->b1_i = peek(next, edge, table::B1_offset);
    rtl_->b2_i = peek(next, edge, table::B2_offset);
    rtl_->beta_i = peek(next, edge, table::BETA_offset);
    rtl_->phi_i = peek(next, edge, table::PHI_offset);
    const uint32_t flags = peek(next, edge, table::FLAGS_offset);
    const auto bit = [&](uint32_t mask, unsigned position) {
      return (flags & mask) != 0 ? 1u << position : 0u;
    };
    rtl_->flags_i = static_cast<uint16_t>(
        bit(table::FLAGS_CLIP_mask, 0) | bit(table::FLAGS_SAT_mask, 1) |
        bit(table::FLAGS_ZERO_mask, 2) | bit(table::FLAGS_DIVERGED_mask, 3) |
        bit(table::FLAGS_LOCKCHG_mask, 4) | bit(table::FLAGS_MIRRORCHG_mask, 5) |
        bit(table::FLAGS_TURN_mask, 6) | bit(table::FLAGS_ALARM_mask, 7) |
        bit(table::FLAGS_UNSETTLED_mask, 8) | bit(table::FLAGS_PARITY_mask, 9) |
        bit(table::FLAGS_MISFIT_mask, 10) | bit(table::FLAGS_JUMP_mask, 11) |
        bit(table::FLAGS_MISSED_mask, 12));
  }

  void give_result() {
    rtl_->eval();
    const unsigned select = rtl_->result_select_o;
    rtl_->result_i =
        select < result_offsets.size() ? peek(model_, cycle_, result_offsets[select]) : 0;
    rtl_->eval();
  }

  void compare_state() {
    model_ctrl_ = peek(model_, cycle_, table::CTRL_offset);
    expect("pready", rtl_->pready_o, true);
    expect("irq", rtl_->irq_o, model_.interrupt());
    expect("busy", rtl_->busy_o, !model_.idle());
    expect("control", rtl_->control_o, model_ctrl_ & 0x1F);
    expect("judge", rtl_->judge_o, peek(model_, cycle_, table::JUDGE_offset));
    expect("turn limit", rtl_->turn_limit_o, peek(model_, cycle_, table::TURN_LIMIT_offset));
    if (!rtl_->boundary_o)
      expect("frozen", rtl_->frozen_o,
             (peek(model_, cycle_, table::STATUS_offset) & table::STATUS_FROZEN_mask) != 0);
    const uint32_t loop = peek(model_, cycle_, table::LOOP_offset);
    expect("loop", rtl_->loop_o, (loop & 31) | (loop >> 8 & 31) << 5);
    expect("step_au", rtl_->step_au_o, peek(model_, cycle_, table::STEP_AU_offset));
    expect("step_bu", rtl_->step_bu_o, peek(model_, cycle_, table::STEP_BU_offset));
    expect("step_cu", rtl_->step_cu_o, peek(model_, cycle_, table::STEP_CU_offset));
    expect("step_av", rtl_->step_av_o, peek(model_, cycle_, table::STEP_AV_offset));
    expect("step_bv", rtl_->step_bv_o, peek(model_, cycle_, table::STEP_BV_offset));
    expect("step_cv", rtl_->step_cv_o, peek(model_, cycle_, table::STEP_CV_offset));
    expect("lock", rtl_->lock_threshold_o, peek(model_, cycle_, table::LOCK_THRESHOLD_offset));
    expect("diverge", rtl_->diverge_threshold_o,
           peek(model_, cycle_, table::DIVERGE_THRESHOLD_offset));
    // A commit is announced for the edge that the model names.
    const auto event = model_.next_event();
    if (rtl_->boundary_o && (rtl_->stage_o & 0x10) != 0)
      expect("commit", event.value_or(0), cycle_ + 1);
  }

  Coprocessor model_;
  std::unique_ptr<VerilatedContext> context_;
  std::unique_ptr<Rtl> rtl_;
  uint32_t seen_ = 0;  // of the last read
  uint64_t cycle_ = 0;
  uint32_t model_ctrl_ = 0;
  std::mt19937_64 noise_{7};
};

Stimulus any(std::mt19937_64& random, unsigned busyness) {
  Stimulus s;
  s.select = random() % 4 != 0;
  s.enable = s.select ? random() % 4 != 0 : random() % 8 == 0;
  s.write = random() % 2 != 0;
  s.data = likely_word(random);
  s.address = static_cast<uint32_t>(random() % 0x3C) * 4;
  if (random() % 32 == 0) s.address = static_cast<uint32_t>(random() % 0x1000);
  if (random() % 16 == 0) s.strobe = static_cast<uint32_t>(random() % 16);
  const bool reset = s.write && s.address == table::CTRL_offset;
  if (reset) {
    // Now and then a soft reset; otherwise let samples in most of the time.
    s.data = random() % 64 == 0 ? s.data | 0x80000000 : s.data & 0x7FFFFFFF;
    if (random() % 4 != 0) s.data |= 0x13;
  }
  if (s.write && s.address == table::CMD_offset && random() % 4 != 0) s.data &= ~1u;
  s.sample = random() % 100 < busyness;
  s.clip = random() % 8 == 0;
  s.u = likely_word(random);
  s.v = likely_word(random);
  return s;
}

template <typename Rtl>
void random_traffic(Arithmetic arithmetic, uint64_t seed, unsigned cycles) {
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937_64 random(seed);
  Bench<Rtl> bench(arithmetic);
  unsigned busyness = 0;
  while (bench.cycle() < cycles) {
    // Stretches without samples, with rare ones, and with more than fit.
    if (bench.cycle() % 500 == 0) busyness = std::array<unsigned, 4>{0, 1, 4, 50}[random() % 4];
    Stimulus s = any(random, busyness);
    // Some stretches are quiet on the bus, so that ticks and loads end by themselves.
    if (bench.cycle() / 200 % 3 == 0 && random() % 16 != 0) s.select = s.enable = false;
    if (!bench.step(s)) return;
  }
}

// What the description says of an access, of the RTL's bank alone: a register whose access, mask or
// reset value differs is named.
template <typename Rtl>
void follow_the_description(Arithmetic arithmetic) {
  using capsoc::registers::Access;
  for (const auto& entry : table::table) {
    const auto& rule = capsoc::coprocessor::rules[entry.offset / 4];
    const bool pair = rule.pair != capsoc::registers::no_pair;
    // Below every range's end; CTRL.REF must not be 3.
    for (const uint32_t pattern : {0x55555555u, 0x2AAAAAAAu, 0u}) {
      Bench<Rtl> bench(arithmetic);
      const uint32_t reset = arithmetic == Arithmetic::paper && entry.offset == table::STATUS_offset
                                 ? table::STATUS_ARITH_mask
                                 : entry.reset;
      EXPECT_EQ(bench.read(entry.offset), reset) << entry.name;
      bench.write(entry.offset, pattern);
      uint32_t kept = reset;
      if (entry.access == Access::write_only || entry.one_to_clear_mask != 0)
        kept = 0;
      else if (entry.access == Access::read_write && !pair)
        kept = pattern & entry.writable_mask & entry.readable_mask;
      // Units that paper lacks.
      if (arithmetic == Arithmetic::paper && entry.offset == table::CTRL_offset)
        kept &= ~(table::CTRL_BLOCK_mask | table::CTRL_GUARD_mask | table::CTRL_CORRECT_mask);
      if (rule.high) kept = pattern;
      if (pair && !rule.high) bench.read(entry.offset + 4);  // LO alone changes nothing
      EXPECT_EQ(bench.read(entry.offset) & entry.readable_mask, kept)
          << entry.name << " after a write of " << std::hex << pattern;
      if (::testing::Test::HasFailure()) return;
    }
  }
}

TEST(RtlRegisters, FollowTheDescriptionPrecise) {
  follow_the_description<Vregister_bench_precise>(Arithmetic::precise);
}

TEST(RtlRegisters, FollowTheDescriptionPaper) {
  follow_the_description<Vregister_bench_paper>(Arithmetic::paper);
}

TEST(RtlRegisters, RandomTrafficPrecise) {
  for (const uint64_t seed : {1, 2, 3})
    random_traffic<Vregister_bench_precise>(Arithmetic::precise, seed, 200000);
}

TEST(RtlRegisters, RandomTrafficPaper) {
  for (const uint64_t seed : {4, 5})
    random_traffic<Vregister_bench_paper>(Arithmetic::paper, seed, 100000);
}

}  // namespace
