// The datapath's units against double precision: largest errors in units of the last place,
// corners, quadrants, the seam at half a turn.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <random>

#include "bench.h"
#include "coprocessor/calibrator.h"
#include "coprocessor/lms_demodulator.h"
#include "coprocessor/paper_units.h"
#include "coprocessor/polar_unit.h"
#include "coprocessor/reference_generator.h"

namespace capsoc::coprocessor::test {
namespace {

using fixed::int128;

constexpr int64_t one_q62 = int64_t{1} << 62;
constexpr uint32_t half_turn = uint32_t{1} << 31;

double to_turns(uint64_t phase) {
  return std::ldexp(static_cast<double>(phase), -48);
}

// Largest error of a rotation in units of 2^-31 over random phases.
template <typename Rotate>
double rotation_error(Rotate&& rotate_by, int shift) {
  std::mt19937_64 random(2);
  double worst = 0;
  for (int i = 0; i < 300000; ++i) {
    const uint64_t phase = (random() >> 16) >> shift << shift;
    const Rotation r = rotate_by(phase);
    const double angle = tau * to_turns(phase);
    worst = std::max(worst, std::fabs(r.sine - std::sin(angle) * 2147483647.0));
    worst = std::max(worst, std::fabs(r.cosine - std::cos(angle) * 2147483647.0));
  }
  return worst;
}

TEST(RotationCordic, IsAccurateToAFewUnits) {
  const double precise = rotation_error(rotate, 0);
  const double paper = rotation_error(rotate_paper, 16);
  std::printf("rotation, 300,000 random phases: precise %.2f LSB, paper %.2f LSB of 2^-31\n",
              precise, paper);
  // Residual angle 2^-30 rad = 2 LSB, 30 rounded shifts, the final rounding.
  EXPECT_LE(precise, 6);
  // Residual angle 2^-28 rad = 8 LSB, 28 truncations in each component, a 32-bit angle.
  EXPECT_LE(paper, 40);
}

TEST(RotationCordic, MeetsTheAxes) {
  const uint64_t quarter = uint64_t{1} << 46;
  const int expected_sine[] = {0, 1, 0, -1};
  const int expected_cosine[] = {1, 0, -1, 0};
  for (uint64_t q = 0; q < 4; ++q) {
    for (int64_t off : {-3000, -1, 0, 1, 3000}) {
      const Rotation r = rotate((q * quarter + static_cast<uint64_t>(off)) & phase_mask);
      EXPECT_NEAR(r.sine, expected_sine[q] * 2147483647.0, 6) << q << " " << off;
      EXPECT_NEAR(r.cosine, expected_cosine[q] * 2147483647.0, 6) << q << " " << off;
    }
  }
}

TEST(PhaseAccumulator, StepsWrapsAndSaturates) {
  bool saturated = false;
  ReferenceState s{phase_mask, 2};
  s = next_reference(s, ReferenceSource::numeric, 12345, 0, 0, saturated);
  EXPECT_EQ(s.phase, 1u);
  EXPECT_EQ(s.frequency, 2);
  s = next_reference({0, -1}, ReferenceSource::angle, 5, 0, 0, saturated);
  EXPECT_EQ(s.phase, phase_mask);
  s = next_reference({10, 100}, ReferenceSource::tracking, -1, 4, 10, saturated);
  EXPECT_EQ(s.phase, (10 + 100 + phase_mask + 1 - 4096) & phase_mask);
  EXPECT_EQ(s.frequency, 36);
  EXPECT_FALSE(saturated);
  const int64_t top = (int64_t{1} << 47) - 1;
  s = next_reference({0, top}, ReferenceSource::tracking, INT32_MAX, 31, 0, saturated);
  EXPECT_EQ(s.frequency, top);
  EXPECT_TRUE(saturated);
}

TEST(PolarUnit, IsAccurateToTwoUnitsOfTheAngle) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> turn(-tau / 2, tau / 2), exponent(-20, -0.01);
  double worst_angle = 0, worst_magnitude = 0;
  for (int i = 0; i < 300000; ++i) {
    const double angle = turn(random), amplitude = std::exp2(exponent(random));
    const auto y = static_cast<int64_t>(std::sin(angle) * amplitude * one_q62);
    const auto x = static_cast<int64_t>(std::cos(angle) * amplitude * one_q62);
    const Polar p = to_polar(y, x, 62);
    const double exact = std::atan2(static_cast<long double>(y), static_cast<long double>(x)) / tau;
    const double error =
        std::remainder(static_cast<double>(p.angle) / 4294967296.0 - exact, 1.0) * 4294967296.0;
    worst_angle = std::max(worst_angle, std::fabs(error));
    worst_magnitude = std::max(worst_magnitude, std::fabs(p.magnitude - amplitude * 2147483648.0));
    ASSERT_FALSE(p.zero);
  }
  std::printf(
      "polar unit, 300,000 random vectors of 1e-6 .. 1: angle %.2f LSB (2^-32 turn), "
      "magnitude %.2f LSB (2^-31)\n",
      worst_angle, worst_magnitude);
  EXPECT_LE(worst_angle, 2.5);
  EXPECT_LE(worst_magnitude, 1.5);
}

TEST(PolarUnit, TakesAnyScale) {
  // One unit in the last place up to the full width of the products.
  for (unsigned bit = 0; bit < 66; ++bit) {
    const int128 one = int128{1} << bit;
    const Polar p = to_polar(one, -one, 62);
    EXPECT_NEAR(static_cast<double>(p.angle), 3.0 * (1u << 29), 2.5) << bit;
    const double magnitude = std::sqrt(2.0) * std::ldexp(1.0, static_cast<int>(bit) - 31);
    EXPECT_EQ(p.saturated, magnitude >= 2147483647.5) << bit;
    EXPECT_NEAR(p.magnitude, std::min(magnitude, 2147483647.0), 1.0) << bit;
  }
}

TEST(PolarUnit, KnowsTheAxesTheSeamAndZero) {
  const int128 r = int128{1} << 61;
  EXPECT_NEAR(static_cast<int32_t>(to_polar(0, r, 62).angle), 0, 2);
  EXPECT_NEAR(to_polar(r, 0, 62).angle, 1u << 30, 2);
  EXPECT_NEAR(to_polar(0, -r, 62).angle, half_turn, 2);
  EXPECT_NEAR(to_polar(-r, 0, 62).angle, 3u << 30, 2);
  // Either side of half a turn, by far less than a unit: no jump.
  EXPECT_NEAR(to_polar(1, -r, 62).angle, half_turn, 2);
  EXPECT_NEAR(to_polar(-1, -r, 62).angle, half_turn, 2);
  const Polar zero = to_polar(0, 0, 62);
  EXPECT_TRUE(zero.zero);
  EXPECT_EQ(zero.angle, 0u);
  EXPECT_EQ(zero.magnitude, 0);
}

TEST(LmsDemodulator, MovesTheWeightsAlongTheError) {
  const Weights w{int64_t{1} << 44, -(int64_t{1} << 43), int64_t{1} << 42};  // .25 -.125 .0625
  const Rotation r{int32_t{1} << 30, -(int32_t{1} << 30)};                   // .5 -.5
  const Steps steps{1u << 30, 1u << 29, 1u << 28};                           // .5 .25 .125
  const int32_t data = int32_t{1} << 30;                                     // .5
  const Demodulation d = demodulate(w, steps, data, r);
  const double error = 0.5 - (0.125 + 0.0625 + 0.0625);
  EXPECT_EQ(d.error, static_cast<int32_t>(error * 2147483648.0));
  EXPECT_EQ(d.weights.sine - w.sine, std::llround(std::ldexp(error * .5 * .5, 46)));
  EXPECT_EQ(d.weights.cosine - w.cosine, std::llround(std::ldexp(error * .25 * -.5, 46)));
  EXPECT_EQ(d.weights.constant - w.constant, std::llround(std::ldexp(error * .125, 46)));
  EXPECT_FALSE(d.error_saturated || d.weights_saturated);
}

TEST(LmsDemodulator, SaturatesErrorAndWeights) {
  const int64_t top = (int64_t{1} << 47) - 1;
  const Rotation r{INT32_MAX, 0};
  const Steps steps{0x7FFFFFFF, 0x7FFFFFFF, 0x7FFFFFFF};
  const Demodulation low = demodulate({top, 0, 0}, steps, INT32_MIN, r);
  EXPECT_EQ(low.error, INT32_MIN);
  EXPECT_TRUE(low.error_saturated);
  const Demodulation high = demodulate({-top - 1, 0, top}, steps, INT32_MAX, {INT32_MAX, 0});
  EXPECT_EQ(high.weights.constant, top);
  EXPECT_TRUE(high.weights_saturated);
  const Demodulation paper =
      demodulate_paper({0, 0, int64_t{INT32_MAX} << 15}, steps, INT32_MAX, {INT32_MIN, 0}, 0);
  EXPECT_EQ(paper.error, 0);
  EXPECT_EQ(paper.weights.constant >> 15, INT32_MAX);
}

TEST(LmsDemodulator, LimitsTheErrorThatAnUpdateSees) {
  for (unsigned n = 0; n < 8; ++n) {
    const int64_t most = int64_t{1} << (31 - 2 * n);
    for (int64_t beside : {-2, -1, 0, 1}) {
      const int64_t up = std::min<int64_t>(most + beside, INT32_MAX);
      const int64_t down = std::max<int64_t>(-most + beside, INT32_MIN);
      EXPECT_EQ(limited_error(static_cast<int32_t>(up), n), std::min(up, most - 1)) << n;
      EXPECT_EQ(limited_error(static_cast<int32_t>(down), n), std::max(down, -most)) << n;
    }
    EXPECT_EQ(limited_error(0, n), 0);
  }
  // The error stays what it is; the weights see 1/64 of full scale.
  const Rotation r{1 << 30, 0};
  const Steps steps{1u << 30, 1u << 30, 1u << 30};
  for (const Demodulation& d : {demodulate({}, steps, -(1 << 30), r, 3),
                                demodulate_paper({}, steps, -(1 << 30), r, 0, 3)}) {
    EXPECT_EQ(d.error, -(1 << 30));
    EXPECT_FALSE(d.error_saturated);
    EXPECT_EQ(d.weights.sine, -(int64_t{1} << 38));
    EXPECT_EQ(d.weights.constant, -(int64_t{1} << 39));
  }
}

TEST(ErrorAverage, SettlesAtTheMagnitudeOfTheError) {
  uint64_t sum = 0;
  for (int i = 0; i < 5000; ++i) sum = next_error_sum(sum, INT32_MIN);
  EXPECT_NEAR(static_cast<double>(error_average(sum)), 2147483648.0, 1);
  EXPECT_LE(error_average(sum), 1u << 31);
  for (int i = 0; i < 5000; ++i) sum = next_error_sum(sum, -1000);
  EXPECT_NEAR(error_average(sum), 1000, 1);
}

TEST(Calibrator, InvertsTheSensorMatrix) {
  const Sensor s;
  for (double beta : {0.0629, -1.2, 2.9}) {
    const double a_u = s.a1 * std::cos(s.phi), b_u = s.a1 * std::sin(s.phi);
    const double a_v = -s.a2 * std::sin(s.phi + beta), b_v = s.a2 * std::cos(s.phi + beta);
    const auto q46 = [](double x) { return static_cast<int64_t>(std::ldexp(x, 46)); };
    const Coefficients w{{q46(a_u), q46(b_u), q46(s.b1)}, {q46(a_v), q46(b_v), q46(s.b2)}};
    for (double angle = -3.1; angle < 3.1; angle += 0.01) {
      const int32_t u = fixed::to_q31(s.a1 * std::sin(angle + s.phi) + s.b1);
      const int32_t v = fixed::to_q31(s.a2 * std::cos(angle + s.phi + beta) + s.b2);
      const Calibrated c = calibrate(u, v, w);
      const double found = turns_to_radians(to_polar(c.s, c.c, 62).angle);
      ASSERT_LE(distance_degrees(found, angle), 1e-6) << beta << " " << angle;
      ASSERT_EQ(c.mirror, std::cos(beta) < 0);
    }
  }
}

TEST(PaperUnits, LookUpIsCloseAndExactAtItsNodes) {
  for (uint32_t j = 0; j < 512; ++j)
    EXPECT_EQ(paper::look_up(j << 23).sine,
              static_cast<int32_t>(std::floor(std::sin(tau * j / 512) * 2147483647.0 + 0.5)));
  double worst = 0;
  std::mt19937 random(4);
  for (int i = 0; i < 100000; ++i) {
    const uint32_t angle = random();
    const double exact = std::sin(tau * angle / 4294967296.0);
    worst = std::max(worst, std::fabs(paper::look_up(angle).sine / 2147483647.0 - exact));
  }
  std::printf("look-up table with interpolation: %.3g (chord of 1/512 turn: 1.88e-5)\n", worst);
  EXPECT_LE(worst, 1.9e-5);
}

TEST(PaperUnits, SquareRootServesTheMiddleOfItsRange) {
  for (double a : {0.05, 0.1, 0.2, 0.3, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95}) {
    const double found = fixed::from_q31(paper::square_root(fixed::to_q31(a * a)));
    std::printf("square root by Eq (10), %.2f: relative error %.2e\n", a, found / a - 1);
    if (a >= 0.3 && a <= 0.7) {
      EXPECT_NEAR(found / a, 1, 1e-8);
    }
    if (a >= 0.2 && a <= 0.8) {
      EXPECT_NEAR(found / a, 1, 1e-6);
    }
  }
  // Below 0.2 the iteration is too slow for 30 steps, above 0.8 it oscillates.
  EXPECT_NEAR(fixed::from_q31(paper::square_root(fixed::to_q31(0.0025))) / 0.05, 1 - 0.087, 0.002);
  EXPECT_EQ(paper::square_root(0), 0);
  EXPECT_GE(paper::square_root(INT32_MAX), 0);
  bool saturated = false;
  paper::amplitude(INT32_MIN, INT32_MIN, saturated);
  EXPECT_TRUE(saturated);
}

double arctangent_error(double amplitude, int operand_bits) {
  double worst = 0;
  for (double angle = -3.1; angle <= 3.1; angle += 0.001) {
    const uint32_t found =
        paper::arctangent(fixed::to_q31(amplitude * std::sin(angle)),
                          fixed::to_q31(amplitude * std::cos(angle)), operand_bits);
    worst = std::max(worst, std::fabs(std::remainder(turns_to_radians(found) - angle, tau)));
  }
  return worst;
}

TEST(PaperUnits, ArctangentReachesThePapersFigure) {
  const double wide = arctangent_error(0.6, 32), narrow = arctangent_error(0.6, 16);
  std::printf(
      "PI arctangent, amplitude 0.6: %.3g rad with 32-bit, %.3g rad with 16-bit operands "
      "(Fig 14: 1e-4)\n",
      wide, narrow);
  EXPECT_LE(wide, 1e-6);
  EXPECT_LE(narrow, 2e-4);
  EXPECT_GE(narrow, 3e-5);
  EXPECT_EQ(paper::arctangent(0, -(1 << 30), 32), 0u) << "stuck at half a turn, as the paper's";
  EXPECT_GT(arctangent_error(0.1, 32), 0.1) << "the loop is too slow for small amplitudes";
}

// Shifted and folded, the loop converges for every vector; the magnitude is the one along the
// angle.
TEST(PaperPolar, ConvergesAtEveryAmplitude) {
  std::mt19937_64 random(5);
  const auto uniform = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  double worst = 0, worst_magnitude = 0;
  const auto check = [&](int32_t y, int32_t x) {
    const paper::Polar p = paper::to_polar(y, x, 32, false);
    EXPECT_TRUE(p.settled) << y << " " << x;
    const double error = std::remainder(p.angle * 0x1p-32 * tau - std::atan2(y, x), tau);
    worst = std::max(worst, std::fabs(error) / tau * 360);
    const double length = std::hypot(y, x);
    if (length < INT32_MAX && length > 1e6)
      worst_magnitude = std::max(worst_magnitude, std::fabs(p.magnitude / length - 1));
    EXPECT_GE(p.magnitude, 0);
  };
  for (int i = 0; i < 20000; ++i) {
    const double angle = tau * uniform(), length = std::exp2(31 * uniform());
    check(static_cast<int32_t>(length * std::sin(angle)),
          static_cast<int32_t>(length * std::cos(angle)));
  }
  for (int32_t y : {INT32_MIN, INT32_MIN + 1, -1, 0, 1, INT32_MAX})
    for (int32_t x : {INT32_MIN, INT32_MIN + 1, -1, 0, 1, INT32_MAX}) check(y, x);
  std::printf("PI arctangent, prepared: %.3g degrees, magnitude %.3g\n", worst, worst_magnitude);
  EXPECT_LT(worst, 1.2e-3) << "half of the table's own error";
  EXPECT_LT(worst_magnitude, 4e-5);
}

// As printed it fails for most amplitudes, and says so.
TEST(PaperPolar, PlainVectorsAreSettledOrSaid) {
  std::mt19937_64 random(6);
  int unsettled = 0;
  for (int i = 0; i < 20000; ++i) {
    const auto y = static_cast<int32_t>(random()), x = static_cast<int32_t>(random() >> 32);
    const int shift = static_cast<int>(random() % 16);
    const paper::Polar p = paper::to_polar(y >> shift, x >> shift, 32, true);
    const double error =
        std::remainder(p.angle * 0x1p-32 * tau - std::atan2(y >> shift, x >> shift), tau);
    if (p.settled) {
      EXPECT_LT(std::fabs(error) / tau * 360, 0.06) << y << " " << x;
    }
    unsettled += !p.settled;
  }
  EXPECT_GT(unsettled, 5000);
  EXPECT_FALSE(paper::to_polar(0, -(1 << 30), 32, true).settled) << "stuck at half a turn";
  EXPECT_TRUE(paper::to_polar(0, 0, 32, true).settled) << "there is no angle";
}

}  // namespace
}  // namespace capsoc::coprocessor::test
