// The safety mechanisms (docs/reference/coprocessor.md): what each finds and what it does not, and
// that a coprocessor without them is the same except for their registers.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <random>

#include "bench.h"
#include "coprocessor/register_map.h"

namespace capsoc::coprocessor::test {
namespace {

constexpr double turn_a_sample = 0.002;
constexpr uint32_t calibrating = ctrl_calib | ctrl_adc | 2u << ctrl_ref_shift;

uint32_t limits(unsigned error, unsigned step) {
  return error << safety_error_limit_shift | step << safety_step_limit_shift;
}

class Safety : public testing::TestWithParam<Arithmetic> {
 protected:
  static Options options() {
    Options options;
    options.arithmetic = GetParam();
    return options;
  }

  // A sensor whose parameters are known, as after a calibration.
  void calibrate(uint32_t safety) {
    const auto word = [](double value) { return static_cast<uint32_t>(fixed::to_q31(value)); };
    const auto turns = [](double angle) {
      return static_cast<uint32_t>(std::llround(std::ldexp(angle / tau, 32)));
    };
    bench_.write(reg_a1, word(sensor_.a1));
    bench_.write(reg_a2, word(sensor_.a2));
    bench_.write(reg_b1, word(sensor_.b1));
    bench_.write(reg_b2, word(sensor_.b2));
    bench_.write(reg_beta, turns(sensor_.beta));
    bench_.write(reg_phi, turns(sensor_.phi));
    bench_.write(reg_cmd, cmd_load);
    bench_.cycle += 200;
    bench_.write(reg_ctrl, calibrating);
    bench_.write(reg_safety, safety);
  }

  // The next sample of a steady shaft; its flags, which are taken.
  uint32_t next(double jump = 0) {
    angle_ += tau * turn_a_sample + jump;
    bench_.sample(sensor_, angle_);
    bench_.cycle += 200;
    const uint32_t flags = bench_.read(reg_flags);
    bench_.write(reg_flags, flags_all);
    return flags & flags_safety;
  }

  bool valid() { return (bench_.read(reg_status) & status_valid) != 0; }

  Sensor sensor_;
  Bench bench_{options()};
  double angle_ = 0;
};

constexpr uint32_t all_on = safety_parity | safety_misfit | safety_jump | safety_missed;

TEST_P(Safety, FindsNothingInAGoodSensor) {
  // 2^-9 of full scale; 1/256 turn.
  calibrate(all_on | limits(9, 7));
  for (int i = 0; i < 1500; ++i) {
    ASSERT_EQ(next(), 0u) << "sample " << i;
    ASSERT_TRUE(valid());
  }
}

// With the angle as reference the error says how far the sample is off its ellipse.
TEST_P(Safety, AWrongCoefficientIsAMisfit) {
  calibrate(all_on | limits(9, 7));
  next();
  const auto high = static_cast<int32_t>(bench_.read(reg_cv_hi));
  // 2 % of full scale.
  bench_.write(reg_cv_lo, 0);
  bench_.write(reg_cv_hi, static_cast<uint32_t>(high + (1 << 25)));
  int found = 0;
  for (int i = 0; i < 500; ++i) {
    const uint32_t flags = next();
    ASSERT_TRUE(flags == 0 || flags == flag_misfit);
    if (flags != 0) ++found;
  }
  // Precise: the wrong coefficient moves the angle, too, and in some places along the ellipse.
  // Paper takes the angle from the parameters, so the demodulator alone is wrong.
  EXPECT_GT(found, 300);
  EXPECT_EQ(found == 500, GetParam() == Arithmetic::paper);
}

TEST_P(Safety, AJumpIsOneInBothDirectionsAndNotForTheFirstSample) {
  for (const double jump : {0.02, -0.02}) {
    calibrate(all_on | limits(0, 7));
    EXPECT_EQ(next(), 0u);
    EXPECT_EQ(next(), 0u);
    EXPECT_EQ(next(jump * tau), flag_jump);
    EXPECT_FALSE(valid());
    EXPECT_EQ(next(), 0u);
    EXPECT_TRUE(valid());
    bench_.write(reg_ctrl, ctrl_srst);
  }
}

TEST_P(Safety, AResultThatNobodyTakesIsMissed) {
  calibrate(safety_missed);
  angle_ += 0.1;
  bench_.sample(sensor_, angle_);
  EXPECT_EQ(bench_.read(reg_flags) & flags_safety, 0u);
  EXPECT_TRUE(valid());
  bench_.sample(sensor_, angle_ + 0.1);
  EXPECT_EQ(bench_.read(reg_flags) & flags_safety, flag_missed);
  EXPECT_FALSE(valid());
}

TEST_P(Safety, KeepsTheAngleUntilTheFlagIsCleared) {
  calibrate(safety_jump | limits(0, 7));
  next();
  next();
  const uint32_t good = bench_.read(reg_angle);
  for (int i = 0; i < 3; ++i) {
    bench_.sample(sensor_, angle_ + 1 + i * 0.001);
    EXPECT_FALSE(valid());
    EXPECT_EQ(bench_.read(reg_angle), good);
    EXPECT_EQ(bench_.read(reg_raw_u), static_cast<uint32_t>(bench_.dut.nodes().u));
  }
  bench_.write(reg_flags, flag_jump);
  bench_.sample(sensor_, angle_ + 1.01);
  EXPECT_TRUE(valid());
  EXPECT_NE(bench_.read(reg_angle), good);
}

// What the documentation tells software to do at its start: the bit of every register is wrong
// once, and each time the next sample says so.
TEST_P(Safety, SoftwareTestsTheParityBitOfEachRegister) {
  calibrate(safety_parity);
  for (const uint32_t offset : parity_registers) {
    const uint32_t high = is_pair(offset) ? offset + 4 : offset;
    const uint32_t upper = bench_.read(high), lower = is_pair(offset) ? bench_.read(offset) : 0;
    const auto rewrite = [&] {
      if (is_pair(offset)) bench_.write(offset, lower);
      bench_.write(high, upper);
    };
    const auto set_safety = [&](uint32_t value) {
      // Twice: the first write of SAFETY after BAD_PARITY gets the wrong bit.
      bench_.write(reg_safety, value);
      bench_.write(reg_safety, value);
    };
    bench_.write(reg_safety, safety_parity | safety_bad_parity);
    if (offset != reg_safety) {
      rewrite();
      set_safety(safety_parity);
    } else {
      bench_.write(reg_safety, safety_parity);
    }
    EXPECT_EQ(next(), flag_parity) << find_rule(offset)->about->name;
    if (offset == reg_safety)
      set_safety(safety_parity);
    else
      rewrite();
    EXPECT_EQ(next(), 0u) << find_rule(offset)->about->name;
    EXPECT_TRUE(valid());
  }
}

// The bits of coefficients on their way, which are wrong only if T3 updates them.
TEST_P(Safety, SoftwareTestsTheParityBitsOfCoefficientsOnTheirWay) {
  calibrate(safety_parity);
  bench_.write(reg_safety, safety_parity | safety_bad_parity);
  EXPECT_EQ(next(), 0u);
  bench_.write(reg_safety, safety_parity);
  bench_.write(reg_safety, safety_parity);
  bench_.write(reg_ctrl, calibrating | ctrl_demod);
  EXPECT_EQ(next(), 0u);
  bench_.write(reg_safety, safety_parity | safety_bad_parity);
  EXPECT_EQ(next(), flag_parity);
  EXPECT_FALSE(valid());
  bench_.write(reg_safety, safety_parity);
  bench_.write(reg_safety, safety_parity);
  EXPECT_EQ(next(), 0u);
  EXPECT_TRUE(valid());
}

TEST_P(Safety, RaisesItsOwnInterrupt) {
  calibrate(safety_jump | limits(0, 7));
  bench_.write(reg_ctrl, calibrating | ctrl_ie_safety);
  bench_.sample(sensor_, 0);
  EXPECT_FALSE(bench_.dut.interrupt());
  bench_.sample(sensor_, 1);
  EXPECT_TRUE(bench_.dut.interrupt());
  bench_.write(reg_flags, flag_jump);
  EXPECT_FALSE(bench_.dut.interrupt());
}

TEST_P(Safety, LeftOutItReadsZeroAndRefusesAWrite) {
  Options without = options();
  without.safety = false;
  Coprocessor dut(without);
  EXPECT_TRUE(dut.write(1, reg_safety, all_on));
  EXPECT_EQ(dut.read(3, reg_safety, false).value, 0u);
  EXPECT_EQ(dut.read(5, reg_flags, false).value, flag_config);
}

// Random traffic that leaves SAFETY alone.
TEST_P(Safety, SwitchedOffItChangesNothing) {
  Options without = options();
  without.safety = false;
  Coprocessor with(options()), other(without);
  std::mt19937_64 random(7);
  uint64_t cycle = 0;
  for (int i = 0; i < 20000; ++i) {
    cycle += 2 + random() % 60;
    const auto word = static_cast<uint32_t>(random()), second = static_cast<uint32_t>(random());
    const auto offset = static_cast<uint32_t>(random() % 64 * 4);
    for (Coprocessor* dut : {&with, &other}) {
      if (word % 4 != 0)
        dut->submit(cycle, static_cast<int32_t>(word), static_cast<int32_t>(second), false);
      else if (offset != reg_safety)
        dut->write(cycle, offset, offset == reg_ctrl ? second & ~ctrl_srst : second);
    }
    for (const uint32_t each : {reg_flags, reg_status, reg_angle, reg_cv_hi})
      ASSERT_EQ(with.read(cycle, each, true).value, other.read(cycle, each, true).value) << i;
    ASSERT_EQ(with.interrupt(), other.interrupt());
  }
}

INSTANTIATE_TEST_SUITE_P(Both, Safety, testing::Values(Arithmetic::precise, Arithmetic::paper),
                         [](const auto& test) {
                           return test.param == Arithmetic::paper ? "paper" : "precise";
                         });

}  // namespace
}  // namespace capsoc::coprocessor::test
