// Each unit of the paper arithmetic, tick by tick, bit for bit against the C++ functions.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <memory>
#include <random>

#include "Vpaper_bench.h"
#include "base/fixed.h"
#include "coprocessor/calibrator.h"
#include "coprocessor/datapath.h"
#include "coprocessor/lms_demodulator.h"
#include "coprocessor/paper_units.h"

namespace capsoc::coprocessor::test {
namespace {

constexpr uint64_t seed = 1;

int64_t q46(int32_t word) {
  return fixed::scale_up(int64_t{word}, 15);
}

class PaperUnits : public ::testing::Test {
 protected:
  PaperUnits() {
    top.rst_ni = 0;
    top.clk_i = 0;
    top.eval();
    top.rst_ni = 1;
    top.run_i = 1;
    RecordProperty("seed", static_cast<int>(seed));
  }
  ~PaperUnits() override { top.final(); }

  // One tick, of 64 clocks; leaves the units in its last one, where their outputs count. Those with
  // one clock an iteration are done, and hold theirs, since the 31st.
  void tick() {
    for (unsigned clock = 0; clock < 64; ++clock) {
      top.clk_i = 1;
      top.eval();
      top.clk_i = 0;
      top.clock_i = static_cast<uint8_t>(clock);
      top.eval();
    }
  }

  // A word as tests need it: the corners, small numbers and everything between.
  int32_t word() {
    constexpr std::array<int32_t, 9> corners = {
        0, 1, -1, INT32_MAX, INT32_MIN, INT32_MIN + 1, 1 << 30, -(1 << 30), (1 << 30) - 1};
    const uint64_t bits = random();
    if ((bits & 7) == 0) return corners[(bits >> 3) % corners.size()];
    const auto value = static_cast<int32_t>(bits >> 32);
    return (bits & 24) == 0 ? value >> ((bits >> 5) & 31) : value;
  }
  uint32_t step() { return static_cast<uint32_t>(word()) & 0x7fffffffu; }

  std::mt19937_64 random{seed};
  VerilatedContext context;
  Vpaper_bench top{&context};
};

int32_t as_signed(uint32_t value) {
  return static_cast<int32_t>(value);
}

TEST_F(PaperUnits, LookUpAgreesAtEveryEntryAndBetween) {
  const auto check = [&](uint32_t angle) {
    top.beta_i = angle;
    top.eval();
    const paper::Table expected = paper::look_up(angle);
    ASSERT_EQ(as_signed(top.lookup_sine_o), expected.sine) << angle;
    ASSERT_EQ(as_signed(top.lookup_cosine_o), expected.cosine) << angle;
  };
  for (uint32_t index = 0; index < 512; ++index) {
    const uint32_t angle = index << 23;
    check(angle);
    check(angle + 1);
    check(angle - 1);
    check(angle + (random() & 0x7fffff));
  }
  for (int i = 0; i < 3000; ++i) check(static_cast<uint32_t>(random()));
}

TEST_F(PaperUnits, CalibratorAgrees) {
  for (int i = 0; i < 20000; ++i) {
    const int32_t u = word();
    const int32_t v = word();
    const Parameters p = {word(), word(), word(), word(), static_cast<uint32_t>(word()), 0};
    top.u_i = static_cast<uint32_t>(u);
    top.v_i = static_cast<uint32_t>(v);
    top.a1_i = static_cast<uint32_t>(p.a1);
    top.a2_i = static_cast<uint32_t>(p.a2);
    top.b1_i = static_cast<uint32_t>(p.b1);
    top.b2_i = static_cast<uint32_t>(p.b2);
    top.beta_i = p.beta;
    tick();
    const Calibrated expected = calibrate_paper(u, v, p);
    ASSERT_EQ(as_signed(top.cal_s_o), static_cast<int32_t>(expected.s)) << i;
    ASSERT_EQ(as_signed(top.cal_c_o), static_cast<int32_t>(expected.c)) << i;
    ASSERT_EQ(as_signed(top.det_o), expected.det) << i;
    ASSERT_EQ(top.mirror_o, expected.mirror) << i;
    ASSERT_EQ(top.calibrator_saturated_o, expected.saturated) << i;
    ASSERT_EQ(as_signed(top.two_cal_s_o), static_cast<int32_t>(expected.s)) << i;
    ASSERT_EQ(as_signed(top.two_cal_c_o), static_cast<int32_t>(expected.c)) << i;
    ASSERT_EQ(as_signed(top.two_det_o), expected.det) << i;
    ASSERT_EQ(top.two_mirror_o, expected.mirror) << i;
    ASSERT_EQ(top.two_calibrator_saturated_o, expected.saturated) << i;
  }
}

TEST_F(PaperUnits, LmsAgrees) {
  unsigned saturated_errors = 0;
  unsigned saturated_weights = 0;
  for (int i = 0; i < 20000; ++i) {
    const int32_t u = word();
    const int32_t v = word();
    Rotation reference;
    reference.sine = word();
    reference.cosine = word();
    const Coefficients w = {{q46(word()), q46(word()), q46(word())},
                            {q46(word()), q46(word()), q46(word())}};
    const Steps su = {step(), step(), step()};
    const Steps sv = {step(), step(), step()};
    top.u_i = static_cast<uint32_t>(u);
    top.v_i = static_cast<uint32_t>(v);
    top.sine_i = static_cast<uint32_t>(reference.sine);
    top.cosine_i = static_cast<uint32_t>(reference.cosine);
    constexpr uint64_t mask = (uint64_t{1} << 48) - 1;
    const auto port = [](int64_t weight) { return static_cast<uint64_t>(weight) & mask; };
    top.au_i = port(w.u.sine);
    top.bu_i = port(w.u.cosine);
    top.cu_i = port(w.u.constant);
    top.av_i = port(w.v.sine);
    top.bv_i = port(w.v.cosine);
    top.cv_i = port(w.v.constant);
    top.step_au_i = su.sine;
    top.step_bu_i = su.cosine;
    top.step_cu_i = su.constant;
    top.step_av_i = sv.sine;
    top.step_bv_i = sv.cosine;
    top.step_cv_i = sv.constant;
    const auto slew = static_cast<unsigned>(random() % 8);
    top.slew_i = static_cast<uint8_t>(slew);
    tick();
    const Demodulation eu = demodulate_paper(w.u, su, u, reference, 0, slew);
    const Demodulation ev = demodulate_paper(w.v, sv, v, reference, 0, slew);
    ASSERT_EQ(as_signed(top.error_u_o), eu.error) << i;
    ASSERT_EQ(as_signed(top.error_v_o), ev.error) << i;
    ASSERT_EQ(top.au_o, port(eu.weights.sine)) << i;
    ASSERT_EQ(top.bu_o, port(eu.weights.cosine)) << i;
    ASSERT_EQ(top.cu_o, port(eu.weights.constant)) << i;
    ASSERT_EQ(top.av_o, port(ev.weights.sine)) << i;
    ASSERT_EQ(top.bv_o, port(ev.weights.cosine)) << i;
    ASSERT_EQ(top.cv_o, port(ev.weights.constant)) << i;
    ASSERT_EQ(top.error_saturated_o, eu.error_saturated || ev.error_saturated) << i;
    ASSERT_EQ(top.weights_saturated_o, eu.weights_saturated || ev.weights_saturated) << i;
    ASSERT_EQ(top.shifted_au_o,
              port(demodulate_paper(w.u, su, u, reference, 7, slew).weights.sine));
    ASSERT_EQ(top.shifted_cv_o,
              port(demodulate_paper(w.v, sv, v, reference, 7, slew).weights.constant));
    saturated_errors += top.error_saturated_o;
    saturated_weights += top.weights_saturated_o;
  }
  EXPECT_GT(saturated_errors, 100u);
  EXPECT_GT(saturated_weights, 100u);
}

// Amplitudes, angles and both kinds of saturation, as stage T4 composes them.
TEST_F(PaperUnits, ParametersAgree) {
  const Datapath datapath{{Arithmetic::paper}};
  const auto check = [&](int32_t au, int32_t bu, int32_t av, int32_t bv) {
    constexpr uint64_t mask = (uint64_t{1} << 48) - 1;
    State state;
    state.coefficients = {{q46(au), q46(bu), 0}, {q46(av), q46(bv), 0}};
    top.au_i = static_cast<uint64_t>(state.coefficients.u.sine) & mask;
    top.bu_i = static_cast<uint64_t>(state.coefficients.u.cosine) & mask;
    top.av_i = static_cast<uint64_t>(state.coefficients.v.sine) & mask;
    top.bv_i = static_cast<uint64_t>(state.coefficients.v.cosine) & mask;
    tick();
    Packet packet;
    Settings settings;
    settings.demodulate = true;
    const Parameters expected = datapath.parameters(packet, settings, state).parameters;
    SCOPED_TRACE(::testing::Message() << au << " " << bu << " " << av << " " << bv);
    ASSERT_EQ(as_signed(top.a1_o), expected.a1);
    ASSERT_EQ(as_signed(top.a2_o), expected.a2);
    ASSERT_EQ(top.phi_o, expected.phi);
    ASSERT_EQ(top.beta_o, expected.beta);
    ASSERT_EQ(top.parameters_settled_o, !packet.unsettled);
    ASSERT_EQ(top.parameters_saturated_o, packet.saturated);
    ASSERT_EQ(as_signed(top.two_a1_o), expected.a1);
    ASSERT_EQ(as_signed(top.two_a2_o), expected.a2);
    ASSERT_EQ(top.two_phi_o, expected.phi);
    ASSERT_EQ(top.two_beta_o, expected.beta);
    ASSERT_EQ(top.two_parameters_settled_o, !packet.unsettled);
    ASSERT_EQ(top.two_parameters_saturated_o, packet.saturated);
  };
  constexpr std::array<int32_t, 6> corners = {0, INT32_MIN, INT32_MAX, 1, -1, 1 << 30};
  for (const int32_t a : corners)
    for (const int32_t b : corners) check(a, b, b, a);
  for (int i = 0; i < 10000; ++i) check(word(), word(), word(), word());
  // Where the units are meant to work: amplitudes up to 0.7.
  const auto moderate = [&] { return static_cast<int32_t>(random() >> 32) >> 1; };
  for (int i = 0; i < 5000; ++i) check(moderate(), moderate(), moderate(), moderate());
}

// Plain, the loop settles for some vectors alone.
TEST_F(PaperUnits, NarrowArctangentsAgree) {
  unsigned settled = 0;
  const auto agree = [](uint32_t angle, uint32_t magnitude, bool is_settled,
                        const paper::Polar& expected) {
    ASSERT_EQ(angle, expected.angle);
    ASSERT_EQ(as_signed(magnitude), expected.magnitude);
    ASSERT_EQ(is_settled, expected.settled);
  };
  for (int i = 0; i < 10000; ++i) {
    const int32_t y = word();
    const int32_t x = word();
    top.u_i = static_cast<uint32_t>(y);
    top.v_i = static_cast<uint32_t>(x);
    tick();
    SCOPED_TRACE(::testing::Message() << y << " " << x);
    agree(top.angle_2_o, top.magnitude_2_o, top.settled_2_o, paper::to_polar(y, x, 2, true));
    agree(top.angle_16_o, top.magnitude_16_o, top.settled_16_o, paper::to_polar(y, x, 16, true));
    agree(top.angle_18_o, top.magnitude_18_o, top.settled_18_o, paper::to_polar(y, x, 18, false));
    agree(top.angle_19_o, top.magnitude_19_o, top.settled_19_o, paper::to_polar(y, x, 19, false));
    agree(top.two_angle_16_o, top.two_magnitude_16_o, top.two_settled_16_o,
          paper::to_polar(y, x, 16, true));
    agree(top.two_angle_19_o, top.two_magnitude_19_o, top.two_settled_19_o,
          paper::to_polar(y, x, 19, false));
    if (HasFatalFailure()) return;
    settled += top.settled_16_o;
  }
  EXPECT_GT(settled, 100u);
  EXPECT_LT(settled, 9900u);
}

// What the skipping of idle clock cycles relies on.
TEST_F(PaperUnits, NothingMovesWithoutRun) {
  top.u_i = 1 << 29;
  top.v_i = 1 << 28;
  top.a1_i = top.a2_i = 1 << 30;
  top.au_i = top.bv_i = uint64_t{1} << 45;
  tick();
  const uint32_t a1 = top.a1_o;
  const uint32_t phi = top.phi_o;
  const uint32_t angle = top.angle_16_o;
  const uint32_t error = top.error_u_o;
  const uint32_t cal_s = top.cal_s_o;
  const uint64_t au = top.au_o;
  const uint32_t two_a1 = top.two_a1_o;
  const uint32_t two_phi = top.two_phi_o;
  const uint32_t two_angle = top.two_angle_16_o;
  const uint32_t two_cal_s = top.two_cal_s_o;
  EXPECT_NE(error, 0u);
  EXPECT_NE(cal_s, 0u);
  EXPECT_NE(angle, 0u);
  top.run_i = 0;
  for (int i = 0; i < 3; ++i) {
    top.u_i = static_cast<uint32_t>(word());
    top.v_i = static_cast<uint32_t>(word());
    top.au_i = static_cast<uint64_t>(step()) << 15;
    tick();
    EXPECT_EQ(top.a1_o, a1);
    EXPECT_EQ(top.phi_o, phi);
    EXPECT_EQ(top.angle_16_o, angle);
    EXPECT_EQ(top.error_u_o, error);
    EXPECT_EQ(top.cal_s_o, cal_s);
    EXPECT_EQ(top.au_o, au);
    EXPECT_EQ(top.two_a1_o, two_a1);
    EXPECT_EQ(top.two_phi_o, two_phi);
    EXPECT_EQ(top.two_angle_16_o, two_angle);
    EXPECT_EQ(top.two_cal_s_o, two_cal_s);
  }
}

}  // namespace
}  // namespace capsoc::coprocessor::test
