#include "sensor/described_source.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "base/constants.h"
#include "sensor/motion.h"

namespace capsoc::sensor {
namespace {

__extension__ typedef unsigned __int128 Wide;

SensorValue at(const SignalConfig& config, uint64_t k) {
  DescribedSource source(config);
  return *source.sample(k, static_cast<double>(k) / config.sample_rate_hz);
}

TEST(DescribedSource, IsEquation21ByDefault) {
  const SensorValue first = at({}, 0);
  EXPECT_NEAR(first.u, 0.6079 * std::sin(0.0876) + 0.1336, 1e-15);
  EXPECT_NEAR(first.v, 0.6228 * std::cos(0.0876 + 0.0629) + 0.1831, 1e-15);
  EXPECT_TRUE(first.has_truth);
  EXPECT_EQ(first.reference_turns, 0.0);
  EXPECT_NEAR(first.angle_turns, 0.0876 / two_pi, 1e-16);
  const SensorValue quarter = at({}, 1250);  // 5 s at 0.05 Hz
  EXPECT_NEAR(quarter.reference_turns, 0.25, 1e-16);
  EXPECT_NEAR(quarter.u, 0.6079 * std::cos(0.0876) + 0.1336, 1e-15);
  EXPECT_NEAR(quarter.v, -0.6228 * std::sin(0.0876 + 0.0629) + 0.1831, 1e-15);
}

TEST(DescribedSource, KeepsFullPrecisionAfterAHundredThousandSamples) {
  // 20 turns of 5000 samples: sample 100000 + k is sample k. The time k / 250 itself is rounded,
  // 400 s to 2.8e-14 s: 1.4e-15 turns, 9e-15 of the amplitude.
  DescribedSource source{SignalConfig()};
  for (uint64_t k = 0; k < 5000; k += 13) {
    const SensorValue early = *source.sample(k, k / 250.0);
    const SensorValue late = *source.sample(k + 100000, (k + 100000) / 250.0);
    EXPECT_NEAR(early.u, late.u, 1e-14);
    EXPECT_NEAR(early.v, late.v, 1e-14);
  }
}

TEST(Motion, TakesWholeTurnsOffAProductExactly) {
  EXPECT_EQ(product_modulo_turn(0.5, 3.0), 0.5);
  EXPECT_EQ(product_modulo_turn(-0.25, 1.0), 0.75);
  // 1.1 = 1 + 0.1 + 8.9e-17, times 2^53 - 1: the fused product keeps what the rounded one, a whole
  // number at this size, has lost. In integers: (2^53 - 1) * 4953959590107546 * 2^-52 modulo 1.
  const Wide product = static_cast<Wide>(9007199254740991u) * 4953959590107546u;
  const double fraction =
      static_cast<double>(static_cast<uint64_t>(product) & ((1ull << 52) - 1)) * 0x1p-52;
  EXPECT_EQ(product_modulo_turn(9007199254740991.0, 1.1), fraction);
  EXPECT_EQ(modulo_turn(-1e-20), 0.0);
  EXPECT_EQ(modulo_turn(1.75), 0.75);
}

TEST(DescribedSource, TurnsBackwardsWithANegativeSpeed) {
  SignalConfig config;
  config.motion.frequency_hz = -0.05;
  EXPECT_NEAR(at(config, 1250).reference_turns, 0.75, 1e-16);
  EXPECT_NEAR(at(config, 1250).angle_turns, 0.75 + 0.0876 / two_pi, 1e-15);
}

TEST(DescribedSource, RetracesItsWayAfterAReversal) {
  SignalConfig config;
  config.motion.reverse_at_s = 6.0;
  EXPECT_EQ(at(config, 1750).u, at(config, 1250).u);  // 7 s is like 5 s
  EXPECT_NEAR(at(config, 1500).reference_turns, 0.3, 1e-15);
  EXPECT_NEAR(at(config, 3000).reference_turns, 0.0, 1e-15);
}

TEST(DescribedSource, RipplesAroundTheMeanSpeed) {
  SignalConfig config;
  config.motion.kind = MotionKind::ripple;
  config.motion.ripple_amplitude = 0.01;
  config.motion.ripple_hz = 0.01;
  // A whole period of the ripple is 5 turns; half of it leads by f r / (pi fr).
  EXPECT_NEAR(at(config, 25000).reference_turns, 0.0, 1e-15);
  EXPECT_NEAR(at(config, 12500).reference_turns, 0.5 + 0.05 * 0.01 / (M_PI * 0.01), 1e-15);
}

TEST(DescribedSource, ShufflesAnglesIndependentlyOfTheOrderOfAsking) {
  SignalConfig config;
  config.motion.kind = MotionKind::shuffled;
  config.motion.seed = 5;
  DescribedSource source(config);
  const SensorValue third = *source.sample(3, 0.012);
  source.sample(0, 0.0);
  EXPECT_EQ(source.sample(3, 0.012)->u, third.u);
  EXPECT_EQ(third.reference_turns, RandomSequence(5, 0).uniform(3));
  config.motion.seed = 6;
  EXPECT_NE(at(config, 3).u, third.u);
}

TEST(DescribedSource, WalksTheSamePathAfterRewindingAndGoingBack) {
  SignalConfig config;
  config.motion.kind = MotionKind::walk;
  config.motion.step_turns = 0.01;
  config.motion.seed = 9;
  DescribedSource source(config);
  std::vector<double> path;
  for (uint64_t k = 0; k < 200; ++k) path.push_back(source.sample(k, 0.0)->angle_turns);
  EXPECT_EQ(source.sample(17, 0.0)->angle_turns, path[17]);
  source.rewind();
  EXPECT_EQ(source.sample(0, 0.0)->angle_turns, path[0]);
  EXPECT_EQ(source.sample(199, 0.0)->angle_turns, path[199]);
  EXPECT_NEAR(path[0], 0.0876 / two_pi, 1e-16);
  EXPECT_NEAR(std::remainder(path[1] - path[0], 1.0), 0.01 * RandomSequence(9, 0).gaussian(0),
              1e-15);
}

TEST(DescribedSource, SwingsOverAnArc) {
  SignalConfig config;
  config.phi = 0.0;
  config.motion.kind = MotionKind::swing;
  config.motion.swing_hz = 0.1;
  config.motion.centre_turns = 0.25;
  config.motion.amplitude_turns = 0.125;
  EXPECT_NEAR(at(config, 0).angle_turns, 0.25, 1e-16);
  EXPECT_NEAR(at(config, 625).angle_turns, 0.375, 1e-15);
  EXPECT_NEAR(at(config, 1875).angle_turns, 0.125, 1e-15);
}

SignalConfig on_profile(std::vector<SpeedPoint> speeds) {
  SignalConfig config;
  config.motion.kind = MotionKind::profile;
  config.motion.speeds = std::move(speeds);
  return config;
}

double turned(const SignalConfig& config, double t_seconds) {
  return DescribedSource(config).sample(0, t_seconds)->reference_turns;
}

TEST(DescribedSource, TurnsByTheAreaUnderItsSpeeds) {
  // Up to 100 turns/s in 5 s, two seconds of it, to -50 in 3 s, and that for ever.
  const SignalConfig config = on_profile({{0, 0}, {5, 100}, {7, 100}, {10, -50}});
  EXPECT_EQ(turned(config, 0), 0.0);
  EXPECT_NEAR(turned(config, 0.1), 10.0 * 0.1 * 0.1, 1e-15);   // 20 turns/s^2
  EXPECT_NEAR(turned(config, 5.001), 0.1, 1e-12);              // 250 whole turns
  EXPECT_NEAR(turned(config, 7.003), 0.3 - 25 * 9e-6, 1e-12);  // -50 turns/s^2
  // 450 turns, 75 more to the end of the slope, 50 back a second.
  EXPECT_NEAR(turned(config, 10.5), 0.0, 1e-11);
  EXPECT_NEAR(turned(config, 10.505), 0.75, 1e-11);
  EXPECT_EQ(turned(on_profile({{0, 0.25}}), 3), 0.75);
}

TEST(DescribedSource, AProfileIsTheSumOfItsSpeedsInSmallSteps) {
  const SignalConfig config = on_profile({{0, 1}, {1.5, -3}, {2, 0}, {4, 0}, {5, 7.5}});
  const auto speed = [](double t) {  // written out again
    if (t < 1.5) return 1 - 4 * t / 1.5;
    if (t < 2) return -3 + 6 * (t - 1.5);
    if (t < 4) return 0.0;
    return t < 5 ? 7.5 * (t - 4) : 7.5;
  };
  constexpr int steps = 60000;
  constexpr double dt = 6.0 / steps;
  double sum = 0;  // the midpoint rule is exact on straight lines; every bend is on a step
  for (int i = 0; i < steps; ++i) {
    sum += speed((i + 0.5) * dt) * dt;
    if (i % 777 != 0) continue;
    EXPECT_NEAR(std::remainder(turned(config, (i + 1) * dt) - sum, 1.0), 0.0, 1e-10) << i;
  }
}

TEST(DescribedSource, AProfileKeepsItsPrecisionAfterManyTurns) {
  // 1,024 s at 96 turns/s are whole turns; what follows is as at the beginning.
  const SignalConfig late = on_profile({{0, 96}, {1024, 96}, {1025, 0}});
  const SignalConfig early = on_profile({{0, 96}, {1, 0}});
  for (double t = 0; t < 1; t += 0.0625)
    EXPECT_NEAR(std::remainder(turned(late, 1024 + t) - turned(early, t), 1.0), 0.0, 1e-14) << t;
}

TEST(DescribedSource, DriftsInAStraightLineUntilItsEnd) {
  SignalConfig config;
  config.drift = {1e-3, -2e-3, 3e-3, -4e-3, 5e-3, 10.0, {}};
  DescribedSource source(config);
  for (const double t : {0.0, 2.5, 10.0, 400.0}) {
    const double moved = std::min(t, 10.0);
    const double theta = two_pi * 0.05 * t + 0.0876;
    const SensorValue value = *source.sample(0, t);
    EXPECT_NEAR(value.u,
                0.6079 * (1 + 1e-3 * moved) * std::sin(theta) + 0.1336 + 3e-3 * 0.6079 * moved,
                1e-13);
    EXPECT_NEAR(value.v,
                0.6228 * (1 - 2e-3 * moved) * std::cos(theta + 0.0629 + 5e-3 * moved) + 0.1831 -
                    4e-3 * 0.6228 * moved,
                1e-13);
    EXPECT_EQ(value.angle_turns, DescribedSource(SignalConfig()).sample(0, t)->angle_turns);
  }
}

TEST(DescribedSource, DriftsAsASineWithTheRateAsItsSteepestSlope) {
  SignalConfig config;
  config.motion.frequency_hz = 0;
  config.drift.b1 = 1e-3;
  config.drift.period_s = 60.0;
  DescribedSource source(config);
  const double at_rest = 0.6079 * std::sin(0.0876) + 0.1336;
  const auto offset = [&](double t) { return (source.sample(0, t)->u - at_rest) / 0.6079; };
  EXPECT_EQ(offset(0), 0.0);
  EXPECT_NEAR(offset(15), 1e-3 * 60 / two_pi, 1e-15);
  EXPECT_NEAR(offset(45), -1e-3 * 60 / two_pi, 1e-15);
  EXPECT_NEAR(offset(600.001) / 0.001, 1e-3, 1e-9);
}

TEST(DescribedSource, AParameterThatDriftsHasNoOneValue) {
  SignalConfig config;
  config.drift.b2 = 1e-3;
  config.drift.until_s = 5;
  EXPECT_FALSE(describe(config).b2);
  EXPECT_TRUE(describe(config).a1);
  EXPECT_TRUE(describe(config).beta);
  EXPECT_FALSE(describe(on_profile({{0, 1}})).frequency_hz);
}

TEST(DescribedSource, AddsHarmonicsRelativeToTheChannel) {
  SignalConfig config;
  config.phi = 0.0;
  config.harmonics = {{Channel::u, 3, 0.01, 0.2}, {Channel::v, 2, 0.02, -0.3}};
  const double theta = two_pi * 0.05 * 2.0;
  const SensorValue value = at(config, 500);
  EXPECT_NEAR(value.u, 0.6079 * (std::sin(theta) + 0.01 * std::sin(3 * theta + 0.2)) + 0.1336,
              1e-15);
  EXPECT_NEAR(value.v,
              0.6228 * (std::cos(theta + 0.0629) + 0.02 * std::cos(2 * theta - 0.3)) + 0.1831,
              1e-15);
}

TEST(DescribedSource, NormalisesThePapersNoiseToItsPeak) {
  SignalConfig config;
  config.noise.peak = 1e-2;
  config.noise.record_samples = 5000;
  config.noise.seed = 4;
  DescribedSource noisy(config);
  DescribedSource clean{SignalConfig()};
  double peak_u = 0.0, peak_v = 0.0;
  for (uint64_t k = 0; k < 5000; ++k) {
    peak_u =
        std::max(peak_u, std::abs(noisy.sample(k, k / 250.0)->u - clean.sample(k, k / 250.0)->u));
    peak_v =
        std::max(peak_v, std::abs(noisy.sample(k, k / 250.0)->v - clean.sample(k, k / 250.0)->v));
  }
  EXPECT_NEAR(peak_u, 1e-2 * 0.6079, 1e-15);
  EXPECT_NEAR(peak_v, 1e-2 * 0.6228, 1e-15);
}

TEST(DescribedSource, ScalesGaussianNoiseBySigma) {
  SignalConfig config;
  config.noise.sigma = 1e-3;
  config.noise.seed = 4;
  EXPECT_NEAR(at(config, 77).u - at({}, 77).u, 1e-3 * RandomSequence(4, 1).gaussian(77), 1e-15);
  EXPECT_NEAR(at(config, 77).v - at({}, 77).v, 1e-3 * RandomSequence(4, 2).gaussian(77), 1e-15);
}

TEST(DescribedSource, DisturbsTheSpeedAsInEquation22) {
  SignalConfig config;
  config.speed_disturbance = {1e-2, 1000, 8};
  const RandomSequence mu(8, 3), nu(8, 4);
  const double t = 400 / 250.0;
  const double base = two_pi * 0.05 * t;
  const double theta_u = base * (1 + 1e-2 * mu.gaussian(400) / mu.gaussian_peak(1000)) + 0.0876;
  const double theta_v = base * (1 + 1e-2 * nu.gaussian(400) / nu.gaussian_peak(1000)) + 0.0876;
  const SensorValue value = at(config, 400);
  EXPECT_NEAR(value.u, 0.6079 * std::sin(theta_u) + 0.1336, 1e-15);
  EXPECT_NEAR(value.v, 0.6228 * std::cos(theta_v + 0.0629) + 0.1831, 1e-15);
  EXPECT_EQ(value.reference_turns, at({}, 400).reference_turns);
}

TEST(DescribedSource, EndsAfterItsSamples) {
  SignalConfig config;
  config.samples = 10;
  DescribedSource source(config);
  EXPECT_TRUE(source.sample(9, 0.036));
  EXPECT_FALSE(source.sample(10, 0.04));
  EXPECT_EQ(source.description().samples, 10u);
}

uint32_t word_of(double x) {
  return static_cast<uint32_t>(static_cast<int32_t>(std::floor(x * 0x1p31 + 0.5)));
}

TEST(DescribedSource, GivesTheSame32BitWordsForTheSameSeed) {
  SignalConfig config;
  config.motion.kind = MotionKind::walk;
  config.motion.step_turns = 0.01;
  config.motion.seed = 1;
  config.noise.sigma = 1e-3;
  config.noise.seed = 1;
  DescribedSource source(config);
  uint32_t hash = 2166136261u;  // FNV-1a over the words of both channels
  for (int pass = 0; pass < 2; ++pass) {
    hash = 2166136261u;
    for (uint64_t k = 0; k < 1000; ++k) {
      const SensorValue value = *source.sample(k, k / 250.0);
      for (const uint32_t word : {word_of(value.u), word_of(value.v)}) {
        hash = (hash ^ word) * 16777619u;
      }
    }
    EXPECT_EQ(hash, 275523716u) << "pass " << pass;
    source.rewind();
  }
}

TEST(DescribedSource, DescribesItself) {
  SignalConfig config;
  config.motion.frequency_hz = -0.051;
  config.motion.reference_hz = 0.05;
  const Description d = describe(config);
  EXPECT_EQ(*d.a1, 0.6079);
  EXPECT_EQ(*d.beta, 0.0629);
  EXPECT_EQ(*d.frequency_hz, -0.051);
  EXPECT_EQ(*d.reference_hz, 0.05);
  EXPECT_EQ(*d.adc_bits, 32);
  EXPECT_EQ(*d.sample_rate_hz, 250.0);
  config.motion.kind = MotionKind::shuffled;
  EXPECT_FALSE(describe(config).frequency_hz);
  EXPECT_STREQ(name_of(describe(config).motion), "shuffled");
}

}  // namespace
}  // namespace capsoc::sensor
