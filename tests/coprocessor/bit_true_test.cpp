// Every unit a second time in SystemC's fixed-point types, where rounding and saturation are part
// of the type, compared bit by bit on random and corner operands. The constants are computed here
// from their definitions, so that a wrong ROM word shows.
#define SC_INCLUDE_FX
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <random>
#include <systemc>
#include <vector>

#include "coprocessor/calibrator.h"
#include "coprocessor/lms_demodulator.h"
#include "coprocessor/paper_units.h"
#include "coprocessor/polar_unit.h"
#include "coprocessor/reference_generator.h"

namespace capsoc::coprocessor {
namespace {

using fixed::int128;
using sc_dt::sc_fixed;
using sc_dt::sc_fxval;
using sc_dt::sc_ufixed;
constexpr auto rounded = sc_dt::SC_RND;  // half up
constexpr auto truncated = sc_dt::SC_TRN;
constexpr auto saturated = sc_dt::SC_SAT;
constexpr auto wrapped = sc_dt::SC_WRAP;

using Q31 = sc_fixed<32, 1, rounded, saturated>;
using Q31Floor = sc_fixed<32, 1, truncated, saturated>;
using Turn32 = sc_ufixed<32, 0, rounded, wrapped>;
constexpr double tau = 6.283185307179586476925;

sc_fxval real(int64_t word, int fraction_bits) {
  return sc_fxval(sc_dt::int64{word}) >> fraction_bits;
}
sc_fxval real_unsigned(uint64_t word, int fraction_bits) {
  return sc_fxval(sc_dt::uint64{word}) >> fraction_bits;
}
sc_fxval real_wide(int128 word, int fraction_bits) {
  return real(static_cast<int64_t>(word >> 64), fraction_bits - 64) +
         real_unsigned(static_cast<uint64_t>(word), fraction_bits);
}
// By way of double, exact for the 48 bits that occur: sc_fxval::to_int64() of SystemC 2.3.4 returns
// 0 for negative powers of two from -2^32 on.
template <typename Number>
int64_t word(const Number& number, int fraction_bits) {
  return static_cast<int64_t>(sc_fxval(sc_fxval(number) << fraction_bits).to_double());
}

double gain(int stages) {
  double k = 1;
  for (int i = 0; i < stages; ++i) k /= std::sqrt(1 + std::ldexp(1.0, -2 * i));
  return k;
}

// The operands every random test mixes in.
const std::vector<int32_t> corners = {
    0,       1,          -1,         INT32_MAX,  INT32_MIN, INT32_MAX - 1, INT32_MIN + 1,
    1 << 30, -(1 << 30), 0x4DCF95EF, -0x4FB7E90F};

class Operands {
 public:
  explicit Operands(uint64_t seed) : random_(seed) {}
  uint64_t bits(unsigned count) { return random_() >> (64 - count); }
  int32_t sample() {
    return bits(2) == 0 ? corners[random_() % corners.size()] : static_cast<int32_t>(random_());
  }
  // Q2.46, of random size and sign; one in eight at an end.
  int64_t weight() {
    const auto size = static_cast<unsigned>(bits(6)) % 48;
    const auto value = static_cast<int64_t>(random_()) >> (16 + size);
    if (bits(3) != 0) return value;
    return bits(1) ? fixed::max_signed<48> : fixed::min_signed<48>;
  }
  Weights weights() { return {weight(), weight(), weight()}; }
  uint32_t step() { return static_cast<uint32_t>(bits(31) >> (bits(4) + bits(3))); }

 private:
  std::mt19937_64 random_;
};

// ---- rotation

template <typename Coordinate, typename Angle, typename Out>
Rotation rotate_reference(Angle z, int stages, int angle_bits, const Coordinate& start) {
  Coordinate x = start, y = 0;
  if (z >= 0.25 || z < -0.25) {
    z = z + 0.5;
    x = -start;
  }
  for (int i = 0; i < stages; ++i) {
    const Coordinate dx = y >> i, dy = x >> i;
    const double a = std::floor(std::ldexp(std::atan(std::ldexp(1.0, -i)) / tau, angle_bits) + 0.5);
    const sc_fxval da = sc_fxval(a) >> angle_bits;
    if (z >= 0) {
      x = x - dx;
      y = y + dy;
      z = z - da;
    } else {
      x = x + dx;
      y = y - dy;
      z = z + da;
    }
  }
  return {static_cast<int32_t>(word(Out(y), 31)), static_cast<int32_t>(word(Out(x), 31))};
}

Rotation rotate_sc(uint64_t phase) {
  const sc_ufixed<37, 0, rounded, wrapped> turns = real_unsigned(phase, 48);
  const sc_fixed<37, 0, truncated, wrapped> z = turns;
  const sc_fixed<38, 2, rounded> start = gain(30) * (2147483647.0 / 2147483648.0);
  return rotate_reference<sc_fixed<38, 2, rounded>, sc_fixed<37, 0, truncated, wrapped>, Q31>(
      z, 30, 37, start);
}

Rotation rotate_paper_sc(uint64_t phase) {
  const sc_fixed<32, 0, truncated, wrapped> z = real_unsigned(phase >> 16, 32);
  const sc_fixed<33, 2, rounded> rounded_start = gain(28) * (2147483647.0 / 2147483648.0);
  const sc_fixed<33, 2, truncated> start = rounded_start;
  return rotate_reference<sc_fixed<33, 2, truncated>, sc_fixed<32, 0, truncated, wrapped>,
                          Q31Floor>(z, 28, 32, start);
}

std::vector<uint64_t> phases(int count) {
  std::vector<uint64_t> result;
  Operands operands(11);
  for (uint64_t q = 0; q < 8; ++q)
    for (int64_t off : {-1025, -1024, -1023, -1, 0, 1, 1023, 1024, 1025, 65536})
      result.push_back(((q << 45) + static_cast<uint64_t>(off)) & phase_mask);
  for (int i = 0; i < count; ++i) result.push_back(operands.bits(48));
  return result;
}

TEST(RotationCordic, IsBitTrue) {
  const auto operands = phases(3000);
  for (uint64_t phase : operands) {
    const Rotation a = rotate(phase), b = rotate_sc(phase);
    ASSERT_EQ(a.sine, b.sine) << phase;
    ASSERT_EQ(a.cosine, b.cosine) << phase;
    const Rotation c = rotate_paper(phase), d = rotate_paper_sc(phase);
    ASSERT_EQ(c.sine, d.sine) << phase;
    ASSERT_EQ(c.cosine, d.cosine) << phase;
  }
  std::printf("rotation: %zu phases, both arithmetics, bit-true\n", operands.size());
}

// ---- polar unit

Polar to_polar_sc(const sc_fxval& y_in, const sc_fxval& x_in, int fraction_bits) {
  Polar result;
  if (x_in == 0 && y_in == 0) {
    result.zero = true;
    return result;
  }
  // The largest k that leaves both components in [-1, 1).
  const auto fits = [&](int k) {
    const sc_fxval y = y_in << k, x = x_in << k;
    return y < 1 && y >= -1 && x < 1 && x >= -1;
  };
  int k = fraction_bits - 35 - 40;
  while (fits(k + 1) && k < fraction_bits + 35) ++k;
  using Coordinate = sc_fixed<39, 4, rounded>;
  Coordinate x = x_in << k, y = y_in << k;
  sc_fixed<37, 0, truncated, wrapped> z = 0;
  if (x < 0) {
    x = -x;
    y = -y;
    z = -0.5;
  }
  for (int i = 0; i < 30; ++i) {
    const Coordinate dx = y >> i, dy = x >> i;
    const sc_ufixed<37, 0, rounded> a = std::atan(std::ldexp(1.0, -i)) / tau;
    if (y >= 0) {
      x = x + dx;
      y = y - dy;
      z = z + a;
    } else {
      x = x - dx;
      y = y + dy;
      z = z - a;
    }
  }
  const sc_ufixed<37, 0, truncated, wrapped> turns = z;
  const Turn32 angle = turns;
  const sc_ufixed<32, 0, rounded> k30 = gain(30);
  const sc_fxval magnitude = (x * k30) >> k;
  result.angle = static_cast<uint32_t>(word(angle, 32));
  const Q31 out = magnitude;
  result.magnitude = static_cast<int32_t>(word(out, 31));
  const sc_fixed<80, 49, rounded> whole = magnitude;
  result.saturated = whole >= 1;
  return result;
}

void expect_same_polar(int128 y, int128 x, unsigned fraction_bits) {
  const Polar a = to_polar(y, x, fraction_bits);
  const int f = static_cast<int>(fraction_bits);
  const Polar b = to_polar_sc(real_wide(y, f), real_wide(x, f), f);
  ASSERT_EQ(a.angle, b.angle);
  ASSERT_EQ(a.magnitude, b.magnitude);
  ASSERT_EQ(a.zero, b.zero);
  ASSERT_EQ(a.saturated, b.saturated);
}

TEST(PolarUnit, IsBitTrue) {
  Operands operands(12);
  int count = 0;
  const auto component = [&](unsigned width) {
    const auto wide = (static_cast<int128>(static_cast<int64_t>(operands.bits(64))) << 3) |
                      static_cast<int128>(operands.bits(3));
    return wide >> (67 - width + operands.bits(6) % width);
  };
  for (int i = 0; i < 2000; ++i, count += 2) {
    expect_same_polar(component(67), component(67), 62);
    expect_same_polar(operands.weight(), operands.weight(), 46);
    if (HasFatalFailure()) return;
  }
  for (int power = 0; power <= 65; ++power)
    for (int128 y : {int128{-1}, int128{0}, int128{1}})
      for (int128 x : {int128{-1}, int128{0}, int128{1}})
        for (int128 off : {int128{-1}, int128{0}, int128{1}}) {
          expect_same_polar(y * (int128{1} << power) + off, x * (int128{1} << power), 62);
          if (HasFatalFailure()) return;
          ++count;
        }
  std::printf("polar unit: %d vectors, bit-true\n", count);
}

// ---- LMS demodulator

using W46 = sc_fixed<48, 2, rounded, saturated>;
using W31 = sc_fixed<34, 3, rounded>;

sc_fxval limited_value(const sc_fxval& error, unsigned slew) {
  const sc_fxval most = real(int64_t{1} << (31 - 2 * slew), 31);
  if (error < -most) return -most;
  const sc_fxval last = most - real(1, 31);
  return error > last ? last : error;
}

TEST(LmsDemodulator, IsBitTrue) {
  Operands operands(13);
  const int count = 20000;
  for (int i = 0; i < count; ++i) {
    const Weights w = operands.weights();
    const Steps steps{operands.step(), operands.step(), operands.step()};
    const Rotation r{operands.sample(), operands.sample()};
    const int32_t data = operands.sample();
    const auto slew = static_cast<unsigned>(operands.bits(3));
    const Demodulation a = demodulate(w, steps, data, r, slew);

    const W46 weights[3] = {real(w.sine, 46), real(w.cosine, 46), real(w.constant, 46)};
    const W31 w0 = weights[0], w1 = weights[1], w2 = weights[2];
    const sc_fxval references[3] = {real(r.sine, 31), real(r.cosine, 31), sc_fxval(1)};
    const sc_fxval mu[3] = {real(steps.sine, 31), real(steps.cosine, 31), real(steps.constant, 31)};
    const sc_fixed<40, 9, rounded> products = w0 * references[0] + w1 * references[1];
    const Q31 error = real(data, 31) - (products + w2);
    ASSERT_EQ(a.error, word(error, 31));
    const sc_fxval limited = limited_value(error, slew);
    const int64_t results[3] = {a.weights.sine, a.weights.cosine, a.weights.constant};
    for (int n = 0; n < 3; ++n) {
      const sc_fixed<48, 2, rounded> gained = limited * mu[n];
      const sc_fixed<48, 2, rounded> delta = gained * references[n];
      const W46 next = weights[n] + delta;
      ASSERT_EQ(results[n], word(next, 46)) << "weight " << n << " of sample " << i;
    }
  }
  std::printf("LMS, precise: %d updates, bit-true\n", count);
}

TEST(PaperLms, IsBitTrue) {
  Operands operands(14);
  const int count = 20000;
  for (int i = 0; i < count; ++i) {
    const int32_t w[3] = {operands.sample(), operands.sample(), operands.sample()};
    const Weights weights{int64_t{w[0]} * 32768, int64_t{w[1]} * 32768, int64_t{w[2]} * 32768};
    const Steps steps{operands.step(), operands.step(), operands.step()};
    const Rotation r{operands.sample(), operands.sample()};
    const int32_t data = operands.sample();
    const int shift = static_cast<int>(operands.bits(3));
    const auto slew = static_cast<unsigned>(operands.bits(3));
    const Demodulation a = demodulate_paper(weights, steps, data, r, shift, slew);

    const sc_fxval references[2] = {real(r.sine, 31), real(r.cosine, 31)};
    using Wide = sc_fixed<36, 5, truncated>;
    const Wide p0 = real(w[0], 31) * references[0], p1 = real(w[1], 31) * references[1];
    const Q31Floor error = real(data, 31) - (p0 + p1 + real(w[2], 31));
    ASSERT_EQ(a.error, word(error, 31));
    const sc_fxval limited = limited_value(error, slew);
    const uint32_t words[3] = {steps.sine, steps.cosine, steps.constant};
    const int64_t results[3] = {a.weights.sine, a.weights.cosine, a.weights.constant};
    for (int n = 0; n < 3; ++n) {
      const sc_ufixed<31, 0, truncated> mu = real(words[n], 31) >> shift;
      const Wide gained = limited * mu;
      Wide delta = gained;
      if (n < 2) delta = gained * references[n];
      const Q31Floor next = real(w[n], 31) + delta;
      ASSERT_EQ(results[n], word(next, 31) * 32768);
    }
  }
  std::printf("LMS, paper: %d updates, bit-true\n", count);
}

// ---- calibrator

TEST(Calibrator, IsBitTrue) {
  Operands operands(15);
  const int count = 20000;
  for (int i = 0; i < count; ++i) {
    const Coefficients k{operands.weights(), operands.weights()};
    const int32_t u = operands.sample(), v = operands.sample();
    const Calibrated a = calibrate(u, v, k);
    const W31 a_u = real(k.u.sine, 46), b_u = real(k.u.cosine, 46), c_u = real(k.u.constant, 46);
    const W31 a_v = real(k.v.sine, 46), b_v = real(k.v.cosine, 46), c_v = real(k.v.constant, 46);
    const sc_fixed<34, 3> du = real(u, 31) - c_u, dv = real(v, 31) - c_v;
    sc_fixed<67, 5> s = b_v * du - b_u * dv, c = a_u * dv - a_v * du;
    const sc_fixed<67, 5> det = a_u * b_v - a_v * b_u;
    if (det < 0) {
      s = -s;
      c = -c;
    }
    ASSERT_TRUE(s == real_wide(a.s, 62)) << i;
    ASSERT_TRUE(c == real_wide(a.c, 62)) << i;
    ASSERT_EQ(a.mirror, det < 0);
  }
  std::printf("calibrator, precise: %d samples, bit-true\n", count);
}

// ---- the paper's units

paper::Table look_up_sc(uint32_t angle) {
  const auto sine = [](uint32_t turn) {
    const auto node = [](uint32_t j) {
      const Q31 value = sc_fxval(std::sin(tau * j / 512) * (2147483647.0 / 2147483648.0));
      return value;
    };
    const Q31 low = node(turn >> 23), high = node((turn >> 23) + 1);
    const sc_fxval fraction = real(turn & 0x7FFFFF, 23);
    const sc_fixed<34, 3, truncated> rise = (high - low) * fraction;
    const Q31Floor out = low + rise;
    return static_cast<int32_t>(word(out, 31));
  };
  return {sine(angle), sine(angle + (1u << 30))};
}

int32_t square_root_sc(int32_t square) {
  Q31Floor y = 0;
  for (int i = 0; i < 30; ++i) {
    const sc_fixed<34, 3, truncated> squared = y * y;
    y = squared - real(square, 31) + y;
  }
  const Q31Floor out = -y;
  return static_cast<int32_t>(word(out, 31));
}

template <int bits>
uint32_t arctangent_sc(int32_t y, int32_t x) {
  using Operand = sc_fixed<bits, 1, truncated>;
  const Operand u = real(y, 31), v = real(x, 31);
  const sc_ufixed<31, 0, rounded> integral = 1.9 / tau;
  sc_ufixed<32, 0, truncated, wrapped> angle = 0;
  for (int i = 0; i < 30; ++i) {
    const paper::Table reference = look_up_sc(static_cast<uint32_t>(word(angle, 32)));
    const Operand sine = real(reference.sine, 31), cosine = real(reference.cosine, 31);
    const sc_fixed<35, 4, truncated> error = u * cosine - v * sine;
    angle = angle + error * integral;
  }
  return static_cast<uint32_t>(word(angle, 32));
}

TEST(PaperUnits, AreBitTrue) {
  Operands operands(16);
  const int count = 300;
  for (int i = 0; i < count; ++i) {
    const auto angle = static_cast<uint32_t>(operands.bits(32));
    ASSERT_EQ(paper::look_up(angle).sine, look_up_sc(angle).sine) << angle;
    ASSERT_EQ(paper::look_up(angle).cosine, look_up_sc(angle).cosine) << angle;
    const int32_t square = static_cast<int32_t>(operands.bits(31));
    ASSERT_EQ(paper::square_root(square), square_root_sc(square)) << square;
    const int32_t y = operands.sample(), x = operands.sample();
    ASSERT_EQ(paper::arctangent(y, x, 32), arctangent_sc<32>(y, x)) << y << " " << x;
    ASSERT_EQ(paper::arctangent(y, x, 16), arctangent_sc<16>(y, x)) << y << " " << x;
  }
  std::printf("paper's look-up, square root and arctangent: %d operands, bit-true\n", count);
}

TEST(PaperCalibrator, IsBitTrue) {
  Operands operands(17);
  const int count = 5000;
  for (int i = 0; i < count; ++i) {
    Parameters p;
    p.a1 = static_cast<int32_t>(operands.bits(31));
    p.a2 = static_cast<int32_t>(operands.bits(31));
    p.b1 = operands.sample();
    p.b2 = operands.sample();
    p.beta = static_cast<uint32_t>(operands.bits(32));
    const int32_t u = operands.sample(), v = operands.sample();
    const Calibrated a = calibrate_paper(u, v, p);
    const paper::Table beta = look_up_sc(p.beta);
    const Q31Floor du = real(u, 31) - real(p.b1, 31), dv = real(v, 31) - real(p.b2, 31);
    const Q31Floor u1 = real(p.a2, 31) * du, v1 = real(p.a1, 31) * dv;
    const Q31Floor u2 = u1 * real(beta.cosine, 31);
    const Q31Floor v2 = v1 + u1 * real(beta.sine, 31);
    ASSERT_EQ(static_cast<int64_t>(a.s), word(u2, 31));
    ASSERT_EQ(static_cast<int64_t>(a.c), word(v2, 31));
  }
  std::printf("Eq (12): %d samples, bit-true\n", count);
}

}  // namespace
}  // namespace capsoc::coprocessor

int sc_main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
