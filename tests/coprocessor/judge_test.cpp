// The turn judge: its words against an independent computation in long double, its windows and
// flags by example, and its LOCK on random sensors, good and broken.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "bench.h"

namespace capsoc::coprocessor::test {
namespace {

constexpr uint32_t running = ctrl_demod | ctrl_calib;
constexpr uint32_t tracking = running | 1u << ctrl_ref_shift;
constexpr int samples_a_turn = 5000;
constexpr long double one_q31 = 2147483648.0L;
constexpr uint32_t omega_half = 1349307;
constexpr uint32_t turns_alone = UINT32_MAX;  // LOCK_THRESHOLD that any average is below

class Judge : public testing::Test {
 protected:
  Judge() { bench.period = 200; }
  uint32_t read(uint32_t offset) { return bench.read(offset); }
  bool locked() { return (read(reg_status) & status_lock) != 0; }
  uint32_t turn_flags() { return read(reg_turn_flags); }
  uint32_t turn_count() { return turn_flags() >> turn_turn_count_shift; }

  // Weights that fit the sensor, as if learnt.
  void fit(const Sensor& s) {
    const auto word = [](double x) {
      return static_cast<uint32_t>(static_cast<int64_t>(std::llround(x)));
    };
    bench.write(reg_a1, static_cast<uint32_t>(fixed::to_q31(s.a1)));
    bench.write(reg_a2, static_cast<uint32_t>(fixed::to_q31(s.a2)));
    bench.write(reg_b1, static_cast<uint32_t>(fixed::to_q31(s.b1)));
    bench.write(reg_b2, static_cast<uint32_t>(fixed::to_q31(s.b2)));
    bench.write(reg_beta, word(s.beta / tau * 4294967296.0));
    bench.write(reg_phi, word(s.phi / tau * 4294967296.0));
    bench.write(reg_cmd, cmd_load);
    bench.cycle += 200;
  }

  // `n` samples of the sensor at constant speed from where the shaft stands.
  void turn(const Sensor& s, int n, double step = tau / samples_a_turn) {
    for (int i = 0; i < n; ++i) {
      bench.sample(s, shaft);
      shaft += step;
    }
  }

  void raw(double u, double v, bool clip = false) {
    bench.cycle += bench.period;
    bench.dut.submit(bench.cycle, fixed::to_q31(u), fixed::to_q31(v), clip);
    bench.dut.advance(bench.cycle + latency_cycles);
  }

  Bench bench;
  double shaft = 0;
};

TEST_F(Judge, FitsAnIndependentComputation) {
  const Sensor s;
  Sensor fitted = s;
  fitted.a1 *= 1.02;  // 2 % wrong, and b1: the circle is an ellipse
  fitted.b1 += 0.01;
  bench.start(ctrl_calib, 1.0 / samples_a_turn, 0);
  fit(fitted);
  // The document's formulas, in long double, with window bounds of the test's own.
  const long double beta = fitted.beta, phi = fitted.phi;
  const long double au = fitted.a1 * std::cos(phi), bu = fitted.a1 * std::sin(phi);
  const long double av = -fitted.a2 * std::sin(phi + beta), bv = fitted.a2 * std::cos(phi + beta);
  const long double det = au * bv - av * bu;
  long double radius = 0, residue = 0;
  for (int i = 0; i < samples_a_turn; ++i) {
    const double angle = tau * i / samples_a_turn;
    const long double du = s.a1 * std::sin(angle + s.phi) + s.b1 - fitted.b1;
    const long double dv = s.a2 * std::cos(angle + s.phi + s.beta) + s.b2 - fitted.b2;
    const long double sine = bv * du - bu * dv, cosine = au * dv - av * du;
    radius = std::max(radius, std::fabs(std::sqrt(sine * sine + cosine * cosine) - det));
    const long double error = std::remainder(
        std::atan2(sine, cosine) - static_cast<long double>(angle), static_cast<long double>(tau));
    residue = std::max(residue, std::fabs(error));
  }
  turn(s, samples_a_turn);
  EXPECT_EQ(turn_count(), 0u);
  EXPECT_EQ(read(reg_radius_max), 0u) << "nothing before the first window has ended";
  turn(s, 1);
  EXPECT_EQ(turn_count(), 1u);
  EXPECT_NEAR(read(reg_radius_max), static_cast<double>(radius * one_q31), 4);
  EXPECT_NEAR(read(reg_residue_max), static_cast<double>(residue / tau * 2 * one_q31), 40);
  EXPECT_NEAR(static_cast<int32_t>(read(reg_turn_det)), static_cast<double>(det * one_q31), 3);
  EXPECT_EQ(read(reg_turn_samples), samples_a_turn + 1u) << "1 / 5000 turn is rounded down";
  EXPECT_NEAR(static_cast<int32_t>(read(reg_winding)), 1073741824.0, 1 << 20);
  EXPECT_EQ(turn_flags(), 0xFFu | turn_good | 1u << turn_turn_count_shift);
}

TEST_F(Judge, CountsGoodTurnsAndLocksByThem) {
  const Sensor s;
  bench.start(ctrl_calib, 1.0 / 1000, 0);
  fit(s);
  bench.write(reg_judge, 2u << judge_turns_shift | 0x3333);
  turn(s, 1001, tau / 1000);
  EXPECT_FALSE(locked()) << "two turns are asked for";
  EXPECT_EQ(read(reg_status) >> status_good_turns_shift & 3, 1u);
  turn(s, 1000, tau / 1000);
  EXPECT_TRUE(locked());
  turn(s, 2000, tau / 1000);
  EXPECT_EQ(read(reg_status) >> status_good_turns_shift & 3, 3u);
  EXPECT_EQ(read(reg_flags) & flag_turn, flag_turn);
  // One clipped sample spoils its turn, and two must follow.
  bench.cycle += bench.period;
  bench.dut.submit(bench.cycle, fixed::to_q31(s.a1 * std::sin(shaft + s.phi) + s.b1),
                   fixed::to_q31(s.a2 * std::cos(shaft + s.phi + s.beta) + s.b2), true);
  bench.dut.advance(bench.cycle + latency_cycles);
  shaft += tau / 1000;
  EXPECT_FALSE(locked()) << "at once";
  EXPECT_EQ(read(reg_status) >> status_good_turns_shift & 3, 3u) << "its turn is not over";
  turn(s, 999, tau / 1000);
  EXPECT_FALSE(locked());
  EXPECT_EQ(turn_flags() & turn_clipped_mask, 1u << turn_clipped_shift);
  EXPECT_EQ(turn_flags() & turn_good, 0u);
  turn(s, 1000, tau / 1000);
  EXPECT_FALSE(locked());
  turn(s, 1000, tau / 1000);
  EXPECT_TRUE(locked());
}

TEST_F(Judge, AlarmsAfterSixteenGlitchesAndLockFallsWithIt) {
  const Sensor s;
  bench.start(ctrl_calib | ctrl_ie_alarm, 1.0 / 1000, 0);
  bench.write(reg_lock_threshold, turns_alone);
  fit(s);
  turn(s, 1001, tau / 1000);
  ASSERT_TRUE(locked());
  bench.write(reg_judge, read(reg_judge) & ~(3u << judge_turns_shift));  // the alarm alone
  for (int i = 1; i <= 16; ++i) {
    EXPECT_TRUE(locked()) << i;
    EXPECT_FALSE(bench.dut.interrupt()) << i;
    raw(s.b1, s.b2);  // the radius is 0
  }
  EXPECT_FALSE(locked());
  EXPECT_TRUE(bench.dut.interrupt());
  EXPECT_EQ(read(reg_status) & (status_alarm | 3u << status_good_turns_shift), status_alarm);
  // It ends when sixteen good ones have come.
  bench.write(reg_flags, flag_alarm);
  turn(s, 15, tau / 1000);
  EXPECT_EQ(read(reg_status) & status_alarm, status_alarm);
  EXPECT_EQ(read(reg_flags) & flag_alarm, flag_alarm) << "each sample raises it anew";
  bench.write(reg_flags, flag_alarm);
  turn(s, 1, tau / 1000);
  EXPECT_EQ(read(reg_status) & status_alarm, 0u);
  EXPECT_EQ(read(reg_flags) & flag_alarm, 0u);
}

TEST_F(Judge, LockFallsWithTheFirstSampleThatSpoilsItsTurn) {
  // Each way alone: beyond the radius, clipped, without an angle, 22.5 degrees off the reference.
  const Sensor s;
  for (int way = 0; way < 4; ++way) {
    SCOPED_TRACE(way);
    bench.write(reg_ctrl, ctrl_srst);
    bench.start(ctrl_calib, 1.0 / 1000, 0);
    bench.write(reg_lock_threshold, turns_alone);
    shaft = 0;
    fit(s);
    turn(s, 1001, tau / 1000);
    ASSERT_TRUE(locked());
    if (way == 0) raw(s.b1 + s.a1 * 1.5 * std::sin(s.phi), s.b2 + s.a2 * 1.5 * std::cos(s.beta));
    if (way == 1) raw(s.b1, s.b2 + s.a2, true);
    if (way == 2) raw(s.b1, s.b2);
    if (way == 3) shaft += tau / 16 + tau / 1000;
    if (way == 3) turn(s, 1, tau / 1000);
    EXPECT_FALSE(locked());
    EXPECT_EQ(read(reg_status) & status_alarm, 0u);
  }
}

TEST_F(Judge, AResidueOfASixteenthTurnIsNoGoodTurn) {
  const Sensor s;
  for (const double off : {0.0624, 0.0626, -0.0624, -0.0626}) {
    bench.write(reg_ctrl, ctrl_srst);
    bench.start(ctrl_calib, 1.0 / 1000, 0);
    shaft = tau * off;
    fit(s);
    turn(s, 1001, tau / 1000);
    const bool beyond = std::fabs(off) > 1.0 / 16;
    EXPECT_EQ((turn_flags() & turn_residue) != 0, beyond) << off;
    EXPECT_EQ((turn_flags() & turn_good) != 0, !beyond) << off;
  }
}

TEST_F(Judge, AlternatingGlitchesRaiseNoAlarm) {
  const Sensor s;
  bench.start(ctrl_calib, 1.0 / 1000, 0);
  fit(s);
  for (int i = 0; i < 100; ++i) {
    raw(s.b1, s.b2);
    turn(s, 1, tau / 1000);
    ASSERT_EQ(read(reg_status) & status_alarm, 0u);
  }
}

TEST_F(Judge, AlarmLimitScalesWithTheSignal) {
  for (double size : {0.9, 0.1, 0.01}) {
    const Sensor s{size, size, 0, 0, 0, 0};
    Sensor larger = s;
    larger.a1 = larger.a2 = size * 1.04;
    bench.write(reg_ctrl, ctrl_srst);
    bench.start(ctrl_calib, 1.0 / 1000, 0);
    fit(s);
    bench.write(reg_judge, 12u << judge_alarm_limit_shift | 51);  // 0.047
    turn(larger, 100, tau / 1000);
    EXPECT_EQ(read(reg_status) & status_alarm, 0u) << size;
    bench.write(reg_judge, 9u << judge_alarm_limit_shift | 51);  // 0.035
    turn(larger, 100, tau / 1000);
    EXPECT_EQ(read(reg_status) & status_alarm, status_alarm) << size;
  }
}

TEST_F(Judge, FreezesTheWeightsWhileTheFlagStands) {
  const Sensor s;
  bench.start(running | ctrl_freeze, 1.0 / samples_a_turn, omega_half);
  fit(s);
  turn(s, 100);
  for (int i = 0; i < 40; ++i) raw(0.9, -0.9);
  EXPECT_EQ(read(reg_status) & (status_alarm | status_frozen), status_alarm | status_frozen);
  const uint32_t frozen = read(reg_au_lo + 20);
  for (int i = 0; i < 40; ++i) raw(0.9, -0.9);
  EXPECT_EQ(read(reg_au_lo + 20), frozen);
  // Without the bit it learns, and a cleared flag lets it learn again.
  bench.write(reg_ctrl, running | ctrl_adc);
  EXPECT_EQ(read(reg_status) & status_frozen, 0u);
  raw(0.9, -0.9);
  EXPECT_NE(read(reg_au_lo + 20), frozen);
  bench.write(reg_ctrl, running | ctrl_adc | ctrl_freeze);
  EXPECT_EQ(read(reg_status) & status_frozen, status_frozen);
  for (int i = 0; i < 60; ++i) turn(s, 1);
  bench.write(reg_flags, flag_alarm);
  EXPECT_EQ(read(reg_status) & (status_alarm | status_frozen), 0u);
}

TEST_F(Judge, AStandingShaftTimesOut) {
  const Sensor s;
  bench.start(ctrl_calib | 1u << ctrl_ref_shift, 1.0 / samples_a_turn, 0);
  fit(s);
  turn(s, 2 * samples_a_turn + 2);
  EXPECT_TRUE(locked());
  bench.write(reg_turn_limit, 7500);
  turn(s, samples_a_turn);  // the turn under way, and into the next
  const uint32_t before = turn_count();
  turn(s, 7500, 0);
  EXPECT_EQ(turn_count(), before + 1);
  EXPECT_EQ(read(reg_turn_samples), 7500u);
  EXPECT_EQ(turn_flags() & (turn_timeout | turn_winding | turn_good), turn_timeout | turn_winding);
  EXPECT_FALSE(locked());
  EXPECT_EQ(read(reg_status) & status_alarm, 0u) << "nothing is wrong with the signal";
}

TEST_F(Judge, SwingingShaftNeverMakesATurn) {
  const Sensor s;
  bench.start(ctrl_calib | 2u << ctrl_ref_shift, 0, 0);
  fit(s);
  bench.write(reg_turn_limit, 3000);
  for (int i = 0; i < 9000; ++i) bench.sample(s, 2.9 * std::sin(tau * i / 3000));
  EXPECT_EQ(turn_count(), 3u);
  EXPECT_EQ(turn_flags() & (turn_octants_mask | turn_timeout | turn_winding),
            0xFF | turn_timeout | turn_winding);
  EXPECT_FALSE(locked());
}

TEST_F(Judge, CountedWindowsJudgeSamplesInAnyOrder) {
  const Sensor s;
  bench.start(ctrl_calib | 2u << ctrl_ref_shift, 0, 0);
  fit(s);
  bench.write(reg_judge, judge_count | 1u << judge_turns_shift | 0x3333);
  bench.write(reg_turn_limit, 200);
  std::mt19937 random(3);
  for (int i = 0; i < 199; ++i) bench.sample(s, tau * random() / 4294967296.0);
  EXPECT_EQ(turn_count(), 0u);
  bench.sample(s, 0);
  EXPECT_EQ(turn_count(), 1u);
  EXPECT_EQ(turn_flags() & (turn_octants_mask | turn_timeout | turn_good), 0xFF | turn_good);
  EXPECT_TRUE(locked());
}

TEST_F(Judge, BackwardTurnsAreTurns) {
  const Sensor s;
  bench.start(ctrl_calib, -1.0 / 1000, 0);
  fit(s);
  turn(s, 2002, -tau / 1000);
  EXPECT_NEAR(static_cast<int32_t>(read(reg_winding)), -1073741824.0, 1 << 21);
  EXPECT_EQ(turn_flags() & turn_good, turn_good);
  EXPECT_EQ(turn_count(), 3u) << "PHASE leaves 0 downwards with the first sample";
}

TEST_F(Judge, MirroredTurnsAreNotGood) {
  const Sensor s{0.5, 0.5, 0, 0, 3.0, 0};
  bench.start(ctrl_calib, -1.0 / 1000, 0);
  fit(s);
  turn(s, 3000, tau / 1000);
  EXPECT_EQ(turn_flags() & (turn_mirror | turn_good), turn_mirror);
}

TEST_F(Judge, TwoTurnsInOneWindowAreNotOne) {
  const Sensor s;
  bench.start(ctrl_calib, 1.0 / 1000, 0);
  fit(s);
  for (double turns : {0.0, 0.9, 1.1, 2.0, 3.0, 4.0, 5.0}) {
    turn(s, 2000, turns * tau / 1000);
    EXPECT_EQ(turn_flags() & (turn_winding | turn_good), turn_winding) << turns;
  }
}

// --- LOCK on random sensors
// -----------------------------------------------------------------------

struct Drawn {
  Sensor sensor;
  double noise = 0;         // of the smaller amplitude
  double u2 = 0, v3 = 0;    // harmonics
  double ripple = 0;        // of the speed
  double ripple_turns = 0;  // a sample
};

Drawn draw(std::mt19937_64& random) {
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
  };
  Drawn d;
  Sensor& s = d.sensor;
  s.a1 = 0.02 * std::exp(uniform(0, std::log(47.5)));
  s.a2 = std::clamp(s.a1 * std::exp(uniform(-std::log(2.0), std::log(2.0))), 0.02, 0.95);
  s.b1 = uniform(-0.5, 0.5) * std::min(1.0, 1.9 * (0.98 - s.a1));
  s.b2 = uniform(-0.5, 0.5) * std::min(1.0, 1.9 * (0.98 - s.a2));
  s.beta = uniform(-1.2, 1.2);
  s.phi = uniform(0, tau);
  d.noise = random() % 4 == 0 ? 0 : 1e-6 * std::exp(uniform(0, std::log(1e4)));
  if (random() % 10 < 7) {
    d.u2 = uniform(-0.01, 0.01);
    d.v3 = uniform(-0.01, 0.01);
  }
  if (random() % 2 == 0) d.ripple = 1e-4 * std::exp(uniform(0, std::log(200.0)));
  d.ripple_turns = 4e-5 * std::exp(uniform(0, std::log(20.0)));
  return d;
}

struct Pair {
  double u = 0, v = 0;
};
Pair ideal(const Drawn& d, double angle) {
  const Sensor& s = d.sensor;
  return {s.a1 * (std::sin(angle + s.phi) + d.u2 * std::sin(2 * angle)) + s.b1,
          s.a2 * (std::cos(angle + s.phi + s.beta) + d.v3 * std::cos(3 * angle)) + s.b2};
}

struct Verdict {
  bool locked = false;
  double bound = 0;  // degrees
  double error = 0;  // largest of the next turn, learning on, degrees
};

// 200 s of the samples that `source` makes at a shaft angle, then a turn against the truth.
Verdict run(const Drawn& d, uint32_t ctrl, const std::function<Pair(double, int, Pair)>& source,
            const std::function<double(int)>& speed, uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Bench bench;
  bench.period = 200;
  bench.start(ctrl, 1.0 / samples_a_turn, omega_half);
  bench.write(reg_lock_threshold, turns_alone);
  bench.write(reg_judge, 2u << judge_turns_shift | 0x3333);
  bench.write(reg_turn_limit, 7500);
  double shaft = 0;
  const double floor = std::min(d.sensor.a1, d.sensor.a2) * d.noise;
  const auto feed = [&](int i) {
    const Pair noise{floor * normal(random), floor * normal(random)};
    Pair p = source(shaft, i, {ideal(d, shaft).u + noise.u, ideal(d, shaft).v + noise.v});
    bench.cycle += bench.period;
    bench.dut.submit(bench.cycle, fixed::to_q31(p.u), fixed::to_q31(p.v),
                     std::fabs(p.u) >= 1 || std::fabs(p.v) >= 1);
    bench.dut.advance(bench.cycle + latency_cycles);
  };
  constexpr int learning = 50001;
  for (int i = 0; i < learning; ++i) {
    feed(i);
    shaft += tau / samples_a_turn * speed(i) * (1 + d.ripple * std::sin(tau * d.ripple_turns * i));
  }
  Verdict v;
  v.locked = (bench.read(reg_status) & status_lock) != 0;
  const double det = std::fabs(static_cast<double>(static_cast<int32_t>(bench.read(reg_turn_det))));
  const double rho = det > 0 ? bench.read(reg_radius_max) / det : 1e9;
  const bool by_angle = (ctrl & ctrl_ref_mask) != 0;
  const double eps = by_angle ? 0 : bench.read(reg_residue_max) * (tau / 4294967296.0);
  v.bound = 57.2958 * (by_angle ? 4 : 2) * std::max(rho, eps) + 360.0 / samples_a_turn;
  for (int i = learning; i < learning + samples_a_turn; ++i) {
    feed(i);
    v.error = std::max(v.error, distance_degrees(bench.angle(), shaft + d.sensor.phi));
    shaft += tau / samples_a_turn;
  }
  return v;
}

Pair as_it_is(double, int, Pair p) {
  return p;
}
double constant(int) {
  return 1;
}

TEST(JudgeOnDrawnSensors, GoodOnesLockWithinTheirBound) {
  std::mt19937_64 random(20260101);
  int refused = 0, beyond = 0;
  constexpr int sensors = 60;
  for (int i = 0; i < sensors; ++i) {
    const Drawn d = draw(random);
    const Verdict v = run(d, running, as_it_is, constant, random());
    refused += !v.locked;
    beyond += v.locked && v.error > v.bound;
  }
  std::printf("%d good sensors: %d refused, %d beyond their bound\n", sensors, refused, beyond);
  EXPECT_EQ(refused, 0);
  EXPECT_EQ(beyond, 0);
}

struct Broken {
  const char* name;
  std::function<Pair(double, int, Pair)> source;
  std::function<double(int)> speed = constant;
};

std::vector<Broken> broken(const Sensor& s, std::mt19937_64& random) {
  const auto normal = [&random] { return std::normal_distribution<double>()(random); };
  return {
      {"dead", [](double, int, Pair) { return Pair{}; }},
      {"noise",
       [=](double, int, Pair) {
         return Pair{1e-4 * normal(), 1e-4 * normal()};
       }},
      {"constant",
       [](double, int, Pair) {
         return Pair{0.3, -0.2};
       }},
      {"at rest", as_it_is, [](int) { return 0.0; }},
      {"U constant",
       [](double, int, Pair p) {
         return Pair{0.1, p.v};
       }},
      {"V constant",
       [](double, int, Pair p) {
         return Pair{p.u, 0.1};
       }},
      {"V = U",
       [](double, int, Pair p) {
         return Pair{p.u, p.u};
       }},
      {"V = -U",
       [](double, int, Pair p) {
         return Pair{p.u, -p.u};
       }},
      {"stops at 40 s", as_it_is, [](int i) { return i < 10000 ? 1.0 : 0.0; }},
      {"tiny",
       [=](double, int, Pair p) {
         return Pair{2e-4 * (p.u - s.b1) / s.a1 + 1e-4 * normal(),
                     2e-4 * (p.v - s.b2) / s.a2 + 1e-4 * normal()};
       }},
      {"clipped",
       [=](double, int, Pair p) {
         return Pair{1.2 * (p.u - s.b1) / s.a1, 1.2 * (p.v - s.b2) / s.a2};
       }},
      {"one channel lost at 150 s",
       [](double, int i, Pair p) {
         return Pair{p.u, i < 37500 ? p.v : 0.0};
       }},
      {"twice the speed", as_it_is, [](int) { return 2.0; }},
      {"backward at 180 s", as_it_is, [](int i) { return i < 45000 ? 1.0 : -1.0; }},
      {"swings", as_it_is, [](int i) { return 3 * std::cos(tau * i / 4000); }},
      {"a spike a turn",
       [](double, int i, Pair p) {
         return i % 4999 == 77 ? Pair{-p.u, 0.9} : p;
       }},
  };
}

TEST(JudgeOnDrawnSensors, BrokenOnesDoNotLock) {
  for (uint32_t ctrl : {running, tracking}) {
    std::mt19937_64 random(42), noise(43);
    for (int i = 0; i < 4; ++i) {
      Drawn d = draw(random);
      d.ripple = 0;
      // Both channels well above the noise floor of the converter: what is wrong is the kind alone.
      d.sensor.a1 = std::max(d.sensor.a1, 0.1);
      d.sensor.a2 = std::max(d.sensor.a2, 0.1);
      for (const Broken& kind : broken(d.sensor, noise)) {
        const std::string name = kind.name;
        if (ctrl == tracking && (name == "twice the speed" || name == "backward at 180 s"))
          continue;  // legal motions for it
        const Verdict v = run(d, ctrl, kind.source, kind.speed, random());
        EXPECT_FALSE(v.locked) << kind.name << ", sensor " << i
                               << (ctrl == tracking ? ", tracking" : ", numeric") << ": error "
                               << v.error << " bound " << v.bound;
      }
    }
  }
}

}  // namespace
}  // namespace capsoc::coprocessor::test
