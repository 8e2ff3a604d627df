// Every stage of the Verilated datapath against the C++ model's stage functions, one vector for
// each stage and tick. All registers change at every boundary and hold noise in between, so that a
// stage that reads late or early is wrong at once.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <random>

#include "base/fixed.h"
#include "bench.h"
#include "coprocessor/calibrator.h"
#include "coprocessor/lms_demodulator.h"
#include "coprocessor/sequencer.h"

namespace capsoc::rtl_test {
namespace {

using coprocessor::Datapath;
using coprocessor::Learning;
using coprocessor::Options;
using coprocessor::Packet;
using coprocessor::PolarResult;
using coprocessor::ReferenceSource;
using coprocessor::Rotation;
using coprocessor::State;
using coprocessor::Weights;

#ifndef CAPSOC_PAPER
#define CAPSOC_PAPER 0
#define CAPSOC_OPERAND_BITS 32
#define CAPSOC_REFERENCE_LEAD 0
#define CAPSOC_STEP_SHIFT 0
#define CAPSOC_PLAIN_ARCTANGENT 0
#define CAPSOC_ITERATION_CLOCKS 1
#endif

Options options() {
  Options out;
  out.arithmetic = CAPSOC_PAPER ? coprocessor::Arithmetic::paper : coprocessor::Arithmetic::precise;
  out.paper_operand_bits = CAPSOC_OPERAND_BITS;
  out.paper_reference_lead = CAPSOC_REFERENCE_LEAD;
  out.paper_step_shift = CAPSOC_STEP_SHIFT;
  out.paper_plain_arctangent = CAPSOC_PLAIN_ARCTANGENT != 0;
  out.paper_iteration_clocks = CAPSOC_ITERATION_CLOCKS;
  return out;
}

constexpr unsigned tick_clocks = coprocessor::tick_cycles * CAPSOC_ITERATION_CLOCKS;

// A clock of a tick as the sequencer says it.
Timing timing(unsigned clock) {
  const bool last = clock == tick_clocks - 1;
  Timing t;
  t.clock = clock;
  t.cycle = last ? 31 : std::min(clock, 30u);
  t.rest = clock > 30 && !last;
  return t;
}

// Words with a liking for the places where rounding, clamping and normalising change.
class Words {
 public:
  explicit Words(uint64_t seed) : engine_(seed) {}

  uint64_t bits() { return engine_(); }
  unsigned below(unsigned limit) { return static_cast<unsigned>(engine_() % limit); }
  bool one_in(unsigned n) { return below(n) == 0; }

  int64_t signed_word(unsigned width) {
    const int64_t largest = static_cast<int64_t>((uint64_t{1} << (width - 1)) - 1);
    switch (below(12)) {
      case 0:
        return 0;
      case 1:
        return largest;
      case 2:
        return -largest - 1;
      case 3:
        return static_cast<int64_t>(below(5)) - 2;
      case 4:
        return largest - below(3);
      case 5:
      case 6: {  // a power of two and its neighbours
        const int64_t power = int64_t{1} << below(width - 1);
        const int64_t word = power + static_cast<int64_t>(below(3)) - 1;
        return std::min(one_in(2) ? word : -word, largest);
      }
      case 7:
      case 8: {  // a random magnitude of random length: also ties of every rounding
        const unsigned length = 1 + below(width);
        const int64_t word = static_cast<int64_t>(bits()) >> (64 - length);
        return (word >> below(length)) << below(2);
      }
      default:
        return static_cast<int64_t>(bits()) >> (64 - width);
    }
  }
  int32_t word32() { return static_cast<int32_t>(signed_word(32)); }
  int64_t word48() {
    const int64_t largest = static_cast<int64_t>(mask48 >> 1);
    return std::clamp(signed_word(48), -largest - 1, largest);
  }
  uint32_t step() {
    if (one_in(8)) return 0x7FFFFFFF;
    if (one_in(8)) return 0;
    return static_cast<uint32_t>(bits() >> 33) >> below(31);
  }
  // The seams of an angle: quarters of a turn and one next to them.
  uint64_t angle48() {
    if (one_in(3)) return ((uint64_t{below(8)} << 45) + below(5) - 2) & mask48;
    return bits() & mask48;
  }

 private:
  std::mt19937_64 engine_;
};

Weights weights(Words& w) {
  Weights out{w.word48(), w.word48(), w.word48()};
  if (CAPSOC_PAPER) {
    for (int64_t* word : {&out.sine, &out.cosine, &out.constant}) *word = (*word >> 16) << 15;
  }
  return out;
}

Registers random_registers(Words& w) {
  Registers r;
  r.settings.demodulate = !w.one_in(4);
  r.settings.source = static_cast<ReferenceSource>(w.below(3));
  // The RTL has a separate order for shifts by 0.
  r.settings.kp = w.one_in(4) ? 0 : w.below(32);
  r.settings.ki = w.one_in(4) ? 0 : w.below(32);
  r.settings.steps_u = {w.step(), w.step(), w.step()};
  r.settings.steps_v = {w.step(), w.step(), w.step()};
  r.settings.slew = w.one_in(4) ? 0 : w.below(8);
  r.settings.block = w.one_in(2);
  r.settings.guard = w.one_in(2);
  r.settings.correct = w.one_in(2);
  r.calibrate = !w.one_in(4);
  r.lock_threshold = static_cast<uint32_t>(w.bits() >> 32);
  r.diverge_threshold = static_cast<uint32_t>(w.bits() >> 32);
  // Judges from none to all that pass; windows from one sample to none that ends.
  r.judge.radius_limit = w.one_in(4) ? 0 : w.one_in(3) ? 255 : w.below(256);
  r.judge.alarm_limit = w.one_in(3) ? 255 : w.below(256);
  r.judge.turns = w.below(4);
  r.judge.count = w.one_in(2);
  r.judge.turn_limit = w.one_in(4) ? static_cast<uint32_t>(w.bits()) : w.below(24);
  r.frozen = w.one_in(4);
  r.reference.phase = w.angle48();
  r.reference.frequency = w.word48();
  if (w.one_in(32)) {
    r.coefficients = {};
  } else {
    r.coefficients = {weights(w), weights(w)};
  }
  r.parameters.a1 = w.word32() & 0x7FFFFFFF;
  r.parameters.a2 = w.word32() & 0x7FFFFFFF;
  r.parameters.b1 = w.word32();
  r.parameters.b2 = w.word32();
  r.parameters.beta = static_cast<uint32_t>(w.angle48() >> 16);
  r.parameters.phi = static_cast<uint32_t>(w.angle48() >> 16);
  return r;
}

// The pipeline of the model, one tick at a time, as coprocessor.cpp has it.
class Pipeline {
 public:
  explicit Pipeline(uint64_t seed) : words_(seed), datapath_(options()) {}

  // One tick; `enter`: a new sample comes in at the boundary that ends it.
  void tick(bool enter, unsigned load_start = 0) {
    for (unsigned clock = 0; clock < tick_clocks - 1; ++clock) {
      // Noise in the registers: nothing may depend on them in mid-tick.
      if (clock % 7 == 0) {
        bench_.drive(random_registers(words_));
      }
      Timing t = timing(clock);
      t.stage = stage_;
      t.load = load_;
      bench_.drive(t);
      bench_.settle();
      bench_.edge();
    }
    boundary(enter, load_start);
  }

  // The interval that ends a tick, or the pipeline's idle time.
  void boundary(bool enter, unsigned load_start = 0) {
    Registers r = random_registers(words_);
    // Blocks last for some windows.
    if (words_.one_in(64)) blocks_ = !blocks_;
    r.settings.block = blocks_;
    // Calibrations that make sense now and then: residues are small, errors do not saturate.
    const int32_t u = words_.word32();
    const int32_t v = words_.word32();
    const bool clip = words_.one_in(2);
    bench_.drive(r);
    bench_.hold(u, v, clip);
    const bool write = words_.one_in(2);
    const unsigned node = words_.below(coprocessor::correction_nodes);
    const int32_t value = words_.word32() >> 12;
    bench_.correct(write, node, value);
    if (write) corrections_[node] = value;
    Timing t = timing(tick_clocks - 1);
    t.boundary = true;
    t.enter = enter;
    t.stage = stage_;
    t.load = load_;
    t.load_start = load_start;
    bench_.drive(t);
    bench_.settle();
    check_ends();
    apply_ends(r);
    start(r, enter, u, v, clip, load_start);
    bench_.edge();
    bench_.correct(false, 0, 0);
    check_results();
  }

  // Soft reset in clock `clock` of the running tick: nothing of the past may show.
  void clear(unsigned clock) {
    for (unsigned c = 0; c <= clock; ++c) {
      bench_.drive(random_registers(words_));
      Timing t = timing(c);
      t.stage = stage_;
      t.load = load_;
      t.boundary = c == tick_clocks - 1;
      bench_.drive(t);
      bench_.top().clear_i = c == clock;
      bench_.settle();
      bench_.edge();
    }
    bench_.top().clear_i = 0;
    stage_ = load_ = 0;
    judge_ = next_judge_ = {};
    block_ = {};
    block_.window_ended = true;
    any_ = status_valid_ = status_lock_ = status_diverged_ = status_mirror_ = false;
    angle_ = result_average_ = 0;
    sum_u_ = sum_v_ = settled_ = 0;
    const Timing idle = timing(clock);
    for (unsigned i = 0; i < 3; ++i) {
      bench_.drive(idle);
      bench_.settle();
      check_results();
      bench_.edge();
    }
  }

  unsigned stage() const { return stage_; }
  uint64_t vectors() const { return vectors_; }
  uint64_t blocks_committed() const { return blocks_committed_; }

 private:
  bool occupied(unsigned stage) const { return (stage_ >> stage) & 1; }

  void check_ends() {
    Vdatapath& top = bench_.top();
    EXPECT_EQ(top.phase_we_o, occupied(2));
    if (occupied(2)) {
      EXPECT_EQ(top.phase_o, reference_.phase);
      EXPECT_EQ(top.freq_we_o, tracking_);
      if (tracking_) {
        EXPECT_EQ(sign48(top.freq_o), reference_.frequency);
      }
    } else {
      EXPECT_EQ(top.freq_we_o, 0);
    }
    const bool learns = occupied(3) && learning_.update;
    EXPECT_EQ(top.weights_u_we_o, learns || (load_ & 2) != 0);
    EXPECT_EQ(top.weights_v_we_o, learns || (load_ & 4) != 0);
    const Coefficients got = bench_.weights();
    if (learns || (load_ & 2)) {
      EXPECT_EQ(got.u.sine, learning_.coefficients.u.sine);
      EXPECT_EQ(got.u.cosine, learning_.coefficients.u.cosine);
      EXPECT_EQ(got.u.constant, learning_.coefficients.u.constant);
    }
    if (learns || (load_ & 4)) {
      EXPECT_EQ(got.v.sine, learning_.coefficients.v.sine);
      EXPECT_EQ(got.v.cosine, learning_.coefficients.v.cosine);
      EXPECT_EQ(got.v.constant, learning_.coefficients.v.constant);
    }
    EXPECT_EQ(top.commit_o, occupied(4));
    EXPECT_EQ(top.parameters_we_o, occupied(4) && keep_parameters_);
    if (!occupied(4)) return;
    const Packet& p = pipe_[4];
    EXPECT_EQ(top.flag_clip_o, p.clip);
    EXPECT_EQ(top.flag_sat_o, p.saturated);
    EXPECT_EQ(top.flag_zero_o, p.zero);
    EXPECT_EQ(top.flag_diverged_o, diverged_);
    EXPECT_EQ(top.flag_unsettled_o, p.unsettled);
    EXPECT_EQ(top.flag_turn_o, next_judge_.ended);
    EXPECT_EQ(top.flag_alarm_o, next_judge_.alarm);
    EXPECT_EQ(top.flag_lockchg_o, lock_ != status_lock_);
    EXPECT_EQ(top.flag_mirrorchg_o, p.mirror != status_mirror_);
    const Parameters a = bench_.parameters();
    const Parameters& b = polar_.parameters;
    EXPECT_EQ(a.a1, b.a1);
    EXPECT_EQ(a.a2, b.a2);
    EXPECT_EQ(a.b1, b.b1);
    EXPECT_EQ(a.b2, b.b2);
    EXPECT_EQ(a.beta, b.beta) << "a_v " << weights_.v.sine << " b_v " << weights_.v.cosine;
    EXPECT_EQ(a.phi, b.phi);
  }

  // What the stages write counts for the stages that start now.
  void apply_ends(Registers& r) {
    if (occupied(2)) {
      r.reference.phase = reference_.phase;
      if (tracking_) r.reference.frequency = reference_.frequency;
    }
    if (occupied(3)) {
      if (learning_.update) r.coefficients = learning_.coefficients;
      if (learning_.sum) block_.sums = learning_.coefficients;
      sum_u_ = learning_.error_sum_u;
      sum_v_ = learning_.error_sum_v;
    }
    if (load_ & 2) r.coefficients.u = learning_.coefficients.u;
    if (load_ & 4) r.coefficients.v = learning_.coefficients.v;
    if (load_ & 3) load_rotation_ = pending_rotation_;
    if (!occupied(4)) return;
    if (keep_parameters_) r.parameters = polar_.parameters;
    committed_ = pipe_[4];
    any_ = true;
    status_valid_ = calibrate_ && !committed_.zero && !committed_.unsettled;
    judge_ = next_judge_;
    block_.window_ended = judge_.ended;
    if (status_valid_) angle_ = polar_.angle;
    status_lock_ = lock_;
    status_diverged_ = diverged_;
    status_mirror_ = committed_.mirror;
    result_average_ = average_;
    ++settled_;
  }

  void start(const Registers& r, bool enter, int32_t u, int32_t v, bool clip, unsigned load_start) {
    State state;
    state.coefficients = r.coefficients;
    state.parameters = r.parameters;
    state.reference = r.reference;
    state.error_sum_u = sum_u_;
    state.error_sum_v = sum_v_;
    for (unsigned s = 4; s > 0; --s)
      if (occupied(s - 1)) pipe_[s] = pipe_[s - 1];
    stage_ = ((stage_ << 1) & 31) | (enter ? 1u : 0u);
    load_ = load_start;
    if (enter) {
      pipe_[0] = {};
      pipe_[0].u = u;
      pipe_[0].v = v;
      pipe_[0].clip = clip;
      datapath_.products(pipe_[0], state);
      ++vectors_;
    }
    if (occupied(1)) {
      Packet& p = pipe_[1];
      datapath_.relative_angle(p);
      if (r.settings.correct && !CAPSOC_PAPER)
        p.relative = coprocessor::corrected_angle(corrections_, p.relative, state.parameters.phi);
      ++vectors_;
    }
    if (occupied(2)) {
      datapath_.reference(pipe_[2], r.settings, state, reference_);
      tracking_ = r.settings.source == ReferenceSource::tracking;
      ++vectors_;
    }
    if (occupied(3)) {
      Settings settings = r.settings;
      if (CAPSOC_PAPER) settings.block = false;
      const coprocessor::LearningPlan plan = coprocessor::plan_learning(
          block_, settings, settings.demodulate && !r.frozen && !pipe_[3].hold_weights,
          judge_.last.flags);
      state.block = block_;
      datapath_.demodulation(pipe_[3], settings, state, plan, learning_);
      if (settings.block && plan.update) ++blocks_committed_;
      ++vectors_;
    }
    if (occupied(4)) {
      polar_ = datapath_.parameters(pipe_[4], r.settings, state);
      weights_ = state.coefficients;
      keep_parameters_ = r.settings.demodulate;
      calibrate_ = r.calibrate;
      average_ = coprocessor::error_average(std::max(sum_u_, sum_v_));
      const Packet& p = pipe_[4];
      next_judge_ = coprocessor::judge(judge_,
                                       {p.amplitude, p.det, p.residue, polar_.angle, p.clip,
                                        p.saturated, p.zero || p.unsettled, p.mirror, p.turn},
                                       r.judge, r.settings.source != ReferenceSource::numeric);
      lock_ =
          settled_ >= 63 && average_ < r.lock_threshold && next_judge_.permits_lock(r.judge.turns);
      diverged_ = settled_ >= 63 && average_ > r.diverge_threshold;
      ++vectors_;
    }
    start_load(r.parameters);
  }

  void start_load(const Parameters& p) {
    const Rotation& rotation = load_rotation_;
    const auto stored = [](Weights weights) {
      if (!CAPSOC_PAPER) return weights;
      bool clamped = false;
      for (int64_t* w : {&weights.sine, &weights.cosine, &weights.constant})
        *w = fixed::saturate<32>(coprocessor::weight_q31(*w), clamped) * 32768;
      return weights;
    };
    if (load_ & 1) pending_rotation_ = datapath_.rotation(coprocessor::to_phase48(p.phi));
    if (load_ & 2) {
      learning_.coefficients.u =
          stored(coprocessor::coefficients_u(p, rotation.sine, rotation.cosine));
      pending_rotation_ = datapath_.rotation(coprocessor::to_phase48(p.phi + p.beta));
    }
    if (load_ & 4)
      learning_.coefficients.v =
          stored(coprocessor::coefficients_v(p, rotation.sine, rotation.cosine));
    if (load_) ++vectors_;
  }

  void check_results() {
    const Packet p = any_ ? committed_ : Packet{};
    const coprocessor::TurnRecord& last = judge_.last;
    const std::array<uint32_t, 16> expected = {static_cast<uint32_t>(p.u),
                                               static_cast<uint32_t>(p.v),
                                               static_cast<uint32_t>(p.cal_s),
                                               static_cast<uint32_t>(p.cal_c),
                                               angle_,
                                               static_cast<uint32_t>(p.error_u),
                                               static_cast<uint32_t>(p.error_v),
                                               static_cast<uint32_t>(p.residue),
                                               p.reference_phase,
                                               static_cast<uint32_t>(p.amplitude),
                                               result_average_,
                                               last.radius_max,
                                               last.residue_max,
                                               static_cast<uint32_t>(last.winding),
                                               last.samples,
                                               static_cast<uint32_t>(last.det)};
    for (unsigned i = 0; i < expected.size(); ++i)
      EXPECT_EQ(bench_.result(i), expected[i]) << "result " << i;
    Vdatapath& top = bench_.top();
    EXPECT_EQ(top.status_lock_o, status_lock_);
    EXPECT_EQ(top.status_diverged_o, status_diverged_);
    EXPECT_EQ(top.status_mirror_o, status_mirror_);
    EXPECT_EQ(top.status_valid_o, status_valid_);
    EXPECT_EQ(top.status_alarm_o, judge_.alarm);
    EXPECT_EQ(top.status_good_turns_o, judge_.good_turns);
    EXPECT_EQ(top.turn_flags_o, last.flags | uint32_t{judge_.turn_count} << 24);
  }

  Words words_;
  Datapath datapath_;
  Bench bench_;
  unsigned stage_ = 0;
  unsigned load_ = 0;
  std::array<Packet, 5> pipe_;
  ReferenceState reference_;
  bool tracking_ = false;
  Learning learning_;
  PolarResult polar_;
  Coefficients weights_;  // what it comes from
  bool keep_parameters_ = false, calibrate_ = false, lock_ = false, diverged_ = false;
  uint32_t average_ = 0;
  uint64_t sum_u_ = 0, sum_v_ = 0;
  Rotation load_rotation_, pending_rotation_;
  uint64_t settled_ = 0;
  coprocessor::TurnJudge judge_, next_judge_;
  Packet committed_;
  bool any_ = false, status_valid_ = false, status_lock_ = false, status_diverged_ = false,
       status_mirror_ = false;
  uint32_t angle_ = 0, result_average_ = 0;
  uint64_t vectors_ = 0;
  coprocessor::BlockLearning block_ = {{}, false, false, true};
  bool blocks_ = false;
  coprocessor::CorrectionTable corrections_{};
  uint64_t blocks_committed_ = 0;
};

unsigned ticks() {
  const char* text = std::getenv("CAPSOC_RTL_TICKS");
  return text != nullptr ? static_cast<unsigned>(std::atoi(text)) : (CAPSOC_PAPER ? 30000 : 60000);
}

TEST(Datapath, SoftResetInAnyCycle) {
  Pipeline pipeline(7);
  for (unsigned i = 0; i < 320 && !testing::Test::HasFailure(); ++i) {
    const unsigned samples = i % 3 == 0 ? 80 : 1 + i % 7;  // with and without a settled average
    pipeline.boundary(true);
    for (unsigned n = 0; n < samples; ++n) pipeline.tick(n % 5 != 4);
    if (i % 4 == 0) {  // a reset amid a LOAD
      while (pipeline.stage() != 0) pipeline.tick(false, (pipeline.stage() & 15) == 0 ? 1 : 0);
      if (i % 8 == 0) pipeline.tick(false, 2);
    }
    pipeline.clear(i % tick_clocks);
  }
}

TEST(Datapath, StagesOnRandomRegisters) {
  const uint64_t seed = 20260101;
  RecordProperty("seed", std::to_string(seed));
  Pipeline pipeline(seed);
  Words words(seed + 1);
  pipeline.boundary(true);
  unsigned load = 0;
  for (unsigned i = 0; i < ticks() && !testing::Test::HasFailure(); ++i) {
    if (load != 0) {  // L1, L2, then a sample or nothing
      load = (load << 1) & 7;
      pipeline.tick(load == 0 && words.one_in(2), load);
      continue;
    }
    const bool drains = (pipeline.stage() & 15) == 0;
    load = drains && words.one_in(2) ? 1 : 0;
    // Now and then the pipeline runs empty.
    const bool enter = load == 0 && (i / 64 % 4 != 3 ? true : i % 64 < 40 && words.one_in(3));
    if (pipeline.stage() == 0)
      pipeline.boundary(enter, load);
    else
      pipeline.tick(enter, load);
  }
  std::printf("seed %llu: %llu vectors, %llu blocks\n", static_cast<unsigned long long>(seed),
              static_cast<unsigned long long>(pipeline.vectors()),
              static_cast<unsigned long long>(pipeline.blocks_committed()));
  if (!CAPSOC_PAPER) {
    EXPECT_GT(pipeline.blocks_committed(), ticks() / 200);
  }
}

}  // namespace
}  // namespace capsoc::rtl_test
