// Records as people make them: what the identifier says of each kind, and that it is so.
#include <gtest/gtest.h>

#include "identification/calibration.h"
#include "identification/ellipse_distance.h"
#include "identification/identify.h"
#include "signals.h"

namespace capsoc::identification {
namespace {

constexpr Parameters usual_sensor = {0.45, 0.40, 0.06, -0.09, 0.2};

double normal(Random& random) {
  const double radius = std::sqrt(-2 * std::log(1 - random.uniform()));
  return radius * std::cos(2 * pi * random.uniform());
}

/// Samples at the angles of `theta`(i), with white noise.
template <class Theta>
Samples taken_at(const Parameters& p, Eigen::Index count, double noise, uint64_t seed,
                 Theta theta) {
  Random random(seed);
  Samples samples{Eigen::ArrayXd(count), Eigen::ArrayXd(count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    const Point at = point_at({p, {}, {}}, theta(i));
    samples.u[i] = at.u + noise * normal(random);
    samples.v[i] = at.v + noise * normal(random);
  }
  return samples;
}

bool has(const std::string& text, const char* part) {
  return text.find(part) != std::string::npos;
}

TEST(EllipseDistance, IsTheNearestPointsOfAnyEllipse) {
  Random random(3);
  for (int k = 0; k < 200; ++k) {
    const Parameters p = {0.1 + random.uniform(), 0.1 + random.uniform(), random.uniform(),
                          random.uniform(), 3.1 * (random.uniform() - 0.5)};
    const double u = 3 * random.uniform() - 1, v = 3 * random.uniform() - 1;
    double least = HUGE_VAL;
    for (int i = 0; i < 20000; ++i) {
      const Point at = point_at({p, {}, {}}, 2 * pi * i / 20000);
      least = std::min(least, std::hypot(u - at.u, v - at.v));
    }
    EXPECT_NEAR(std::abs(EllipseDistance(p).at(u, v)), least, 3e-4) << "beta " << p.beta;
  }
}

TEST(HardRecords, AThinEllipseHasNoOutliers) {
  Parameters thin = usual_sensor;
  thin.beta = -1.46;
  const auto found =
      identify(taken_at(thin, 5000, 2e-5, 8, [](auto i) { return 0.0123 * i; })).value();
  EXPECT_FALSE(found.rejected()) << found.rejection();
  EXPECT_TRUE(found.outliers.empty());
}

TEST(HardRecords, CorrelatedNoiseWidensTheIntervals) {
  Random random(4);
  Samples samples =
      taken_at(usual_sensor, 1000, 0, 1, [](auto i) { return 2 * pi * 20.3 * i / 1000; });
  double u = 0, v = 0;
  for (Eigen::Index i = 0; i < 1000; ++i) {
    u = 0.9 * u + std::sqrt(0.19) * 4e-4 * normal(random);
    v = 0.9 * v + std::sqrt(0.19) * 4e-4 * normal(random);
    samples.u[i] += u;
    samples.v[i] += v;
  }
  const auto found = identify(samples).value();
  EXPECT_TRUE(found.correlation.found);
  EXPECT_NEAR(found.correlation.of_neighbours(), 0.9, 0.05);
  EXPECT_GT(found.widening, 2);
  ASSERT_FALSE(found.notes.empty());
  EXPECT_TRUE(has(found.notes.front(), "correlated"));
  const auto white = identify(taken_at(usual_sensor, 1000, 4e-4, 1, [](auto i) {
                       return 2 * pi * 20.3 * i / 1000;
                     })).value();
  EXPECT_FALSE(white.correlation.found);
  EXPECT_TRUE(white.notes.empty());
}

TEST(HardRecords, AnOffsetThatDriftsLeavesNoIntervals) {
  Samples samples =
      taken_at(usual_sensor, 1000, 4e-4, 5, [](auto i) { return 2 * pi * 20.3 * i / 1000; });
  samples.u += Eigen::ArrayXd::LinSpaced(1000, -1e-3, 1e-3);
  const auto found = identify(samples).value();
  EXPECT_TRUE(has(found.no_intervals, "drifts") && has(found.no_intervals, "b1"))
      << found.no_intervals;
  ASSERT_TRUE(found.bound);
  EXPECT_GT(found.bound->drift, 1e-3);
}

// The angle at the record's start is off by what the offset still has to change: the bound contains
// that, or there is none.
TEST(HardRecords, ASensorThatWarmsUpIsWithinItsBoundOrHasNone) {
  int bounded = 0, refused = 0;
  for (const double share : {0.05, 0.1, 0.2, 0.5, 1.0, 3.0})
    for (const double size : {1e-3, 5e-3, 0.02})
      for (const bool first : {true, false}) {
        Samples samples =
            taken_at(usual_sensor, 4000, 4e-4, 5, [](auto i) { return 2 * pi * 20.3 * i / 4000; });
        Eigen::ArrayXd drift(4000);
        for (Eigen::Index i = 0; i < 4000; ++i)
          drift[i] = size * std::exp(-static_cast<double>(i) / (4000 * share));
        if (!first) drift = drift.reverse().eval();
        samples.u += drift;
        const auto found = identify(samples).value();
        if (found.rejected() || !found.bound) {
          ++refused;
          continue;
        }
        ++bounded;
        const double left = std::max(std::abs(usual_sensor.b1 + drift[0] - found.parameters.b1),
                                     std::abs(usual_sensor.b1 + drift[3999] - found.parameters.b1));
        EXPECT_GT(found.bound->total, left / usual_sensor.a1)
            << found.drift.found << found.drift.followed << " " << found.bound->drift << " p "
            << found.drift.probability << " out " << found.outliers.size() << " offset of " << size
            << " with a time constant of " << share << " records";
      }
  EXPECT_GT(bounded, 20);
  EXPECT_GT(refused, 5);
}

TEST(HardRecords, OneSidedOutliersLeaveNoIntervals) {
  Samples samples =
      taken_at(usual_sensor, 1000, 4e-4, 5, [](auto i) { return 2 * pi * 20.3 * i / 1000; });
  Random random(9);
  for (double& value : samples.u)
    if (random.uniform() < 0.05) value += 4e-4 * (2 + 4 * random.uniform());
  const auto found = identify(samples).value();
  EXPECT_TRUE(has(found.no_intervals, "farther to one side")) << found.no_intervals;
}

TEST(HardRecords, FewAnglesAreCountedAsSuch) {
  const auto indexed = [](int positions, int each) {
    return identify(taken_at(usual_sensor, positions * each, 2e-4, 5,
                             [&](auto i) {
                               return 2 * pi * static_cast<double>(i / each) / positions + 0.1;
                             }))
        .value();
  };
  const auto eight = indexed(8, 20);
  EXPECT_EQ(eight.positions.count, 8);
  ASSERT_TRUE(eight.bound);
  EXPECT_LT(eight.bound->total, 0.3 * radians_per_degree);
  const auto five = indexed(5, 40);
  EXPECT_EQ(five.positions.count, 5);
  EXPECT_EQ(five.warning, "");
  ASSERT_FALSE(five.notes.empty());
  EXPECT_TRUE(has(five.notes.front(), "nothing to test"));
  EXPECT_EQ(
      identify(taken_at(usual_sensor, 1000, 2e-4, 5,
                        [random = Random(6)](auto) mutable { return 2 * pi * random.uniform(); }))
          .value()
          .positions.count,
      0);
}

TEST(HardRecords, AStepperIsNotClipped) {
  Samples samples = taken_at(usual_sensor, 1000, 2e-4, 5, [](auto i) {
    return 2 * pi * static_cast<double>(i / 20) / 50 + 0.1;
  });
  for (Eigen::ArrayXd* channel : {&samples.u, &samples.v})
    *channel = (*channel * 2048).round() / 2048;
  const auto found = identify(samples).value();
  EXPECT_FALSE(found.rejected()) << found.rejection();
  EXPECT_LT(difference(found.parameters, usual_sensor), 1e-3);
}

TEST(HardRecords, ARecordThatRestsAndThenTurnsIsFitted) {
  const auto found =
      identify(taken_at(usual_sensor, 5000, 1e-4, 6, [](auto i) {
        return i < 4000 ? 0.7 : 0.7 + 2 * pi * 4 * static_cast<double>(i - 4000) / 1000;
      })).value();
  EXPECT_FALSE(found.rejected()) << found.rejection();
  EXPECT_LT(difference(found.parameters, usual_sensor), 1e-4);
}

TEST(HardRecords, ADeadZoneIsNoOutlier) {
  Samples samples =
      taken_at(usual_sensor, 3000, 1e-4, 7, [](auto i) { return 2 * pi * 6.0 * i / 3000; });
  for (double& value : samples.u)
    if (std::abs(value - usual_sensor.b1) < 0.08 * usual_sensor.a1) value = usual_sensor.b1;
  EXPECT_TRUE(has(identify(samples).value().rejection(), "dead zone"));
}

/// Which samples the gate "change" names; "" when it passed.
std::string changed_samples(const Samples& samples) {
  const auto found = identify(samples).value();
  for (const Gate& gate : found.gates)
    if (gate.name == "change") return gate.reason.substr(0, gate.reason.find(" follow"));
  ADD_FAILURE() << found.rejection();
  return "";
}

TEST(HardRecords, ASensorThatChangedForSomeTimeIsNoOutlier) {
  const auto theta = [](auto i) { return 2 * pi * static_cast<double>(i) / 197; };
  for (const double noise : {0.0, 1e-4}) {
    for (const Eigen::Index first : {Eigen::Index{0}, Eigen::Index{2600}, Eigen::Index{4700}}) {
      Parameters offset = usual_sensor, gain = usual_sensor, phase = usual_sensor;
      offset.b1 += 0.02;
      gain.a2 *= 1.05;
      phase.beta += 0.05;
      for (const Parameters& other : {offset, gain, phase}) {
        Samples samples = taken_at(usual_sensor, 5000, noise, 5, theta);
        const Samples after = taken_at(other, 5000, noise, 5, theta);
        samples.u.segment(first, 300) = after.u.segment(first, 300);
        samples.v.segment(first, 300) = after.v.segment(first, 300);
        const std::string named = changed_samples(samples);
        double from = -1, to = -1;
        ASSERT_EQ(std::sscanf(named.c_str(), "samples %lf to %lf", &from, &to), 2)
            << "noise " << noise << ", from " << first;
        EXPECT_NEAR(from, static_cast<double>(first), 25) << "an eighth of a turn";
        EXPECT_NEAR(to, static_cast<double>(first) + 299, 25);
      }
    }
  }
}

TEST(HardRecords, ASensorThatDriftsAwayOrComesBackIsNoOutlier) {
  const auto theta = [](auto i) { return 2 * pi * static_cast<double>(i) / 197; };
  for (const double noise : {0.0, 1e-4}) {
    Samples away = taken_at(usual_sensor, 20000, noise, 5, theta), back = away, gain = away;
    for (Eigen::Index i = 0; i < 600; ++i) {
      const auto k = static_cast<double>(i);
      away.u[19400 + i] += 0.02 * k / 600;
      back.u[i] += 0.1 * std::exp(-k / 100);
      gain.v[9000 + i] *= 1 + 0.05 * std::sin(pi * k / 600);
    }
    EXPECT_TRUE(has(changed_samples(away), "to 19999")) << noise;
    EXPECT_TRUE(has(changed_samples(back), "samples 0 to ")) << noise;
    EXPECT_TRUE(has(changed_samples(gain), "samples 90")) << noise;
  }
}

TEST(HardRecords, DisturbancesAreNoChangeOfTheSensor) {
  const auto theta = [](auto i) { return 2 * pi * static_cast<double>(i) / 197; };
  Random random(11);
  // Spikes anywhere, a burst that scatters, a signal that is lost.
  for (int k = 0; k < 10; ++k) {
    Samples spikes = taken_at(usual_sensor, 5000, 1e-4, 5, theta), burst = spikes, lost = spikes;
    for (Eigen::Index i = 0; i < 5000; ++i)
      if (random.uniform() < 0.05) spikes.u[i] += 0.02;
    EXPECT_EQ(changed_samples(spikes), "");
    const auto first = static_cast<Eigen::Index>(4400 * random.uniform());
    const Eigen::Index length = 10 + 60 * k;
    for (Eigen::Index i = first; i < first + length; ++i) burst.v[i] += 0.05 * normal(random);
    EXPECT_EQ(changed_samples(burst), "") << "seed 11, " << k;
    for (const int period : {40, 400}) {
      Samples slow = taken_at(usual_sensor, 5000, 1e-4, 5,
                              [&](auto i) { return 2 * pi * static_cast<double>(i) / period; });
      for (Eigen::Index i = first; i < first + length; ++i) slow.v[i] += 0.05 * normal(random);
      EXPECT_FALSE(has(identify(slow).value().rejection(), "another curve"))
          << "seed 11, " << k << ", period " << period;
    }
    lost.u.segment(first, 150) = 0.01;
    lost.v.segment(first, 150) = -0.01;
    EXPECT_EQ(changed_samples(lost), "");
  }
}

TEST(HardRecords, AnArcIsJudgedByItsBound) {
  const auto swing = [](double degrees, double noise) {
    return identify(taken_at(usual_sensor, 20000, noise, 7,
                             [&](auto i) {
                               return degrees / 2 * radians_per_degree *
                                      std::sin(2 * pi * i / 777.0);
                             }))
        .value();
  };
  const auto wide = swing(150, 1e-4);
  ASSERT_FALSE(wide.rejected()) << wide.rejection();
  EXPECT_NEAR(wide.bound->arc_degrees, 150, 3);
  EXPECT_LT(wide.bound->total, 0.2 * radians_per_degree);
  EXPECT_LE(wide.bound->arc.parameters, wide.bound->parameters);
  const auto narrow = swing(20, 2e-4);
  EXPECT_TRUE(narrow.rejected() || has(narrow.no_intervals, "too little of the turn"))
      << narrow.no_intervals;
}

}  // namespace
}  // namespace capsoc::identification
