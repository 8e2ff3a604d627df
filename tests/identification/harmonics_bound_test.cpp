// What the bound of a fit with harmonics is worth when the sensor has more than were asked for.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "base/constants.h"
#include "identification/identify.h"

namespace capsoc::identification {
namespace {

constexpr int last_order = 5;

/// A sensor with harmonics of any order, relative to the amplitude.
struct Sensor {
  Parameters p;
  std::array<std::array<HarmonicTerm, last_order + 1>, 2> terms{};

  Point at(double theta) const {
    Point point = point_at({p, {}, {}}, theta);
    for (int order = 2; order <= last_order; ++order) {
      const auto k = static_cast<std::size_t>(order);
      const double sine = std::sin(order * theta), cosine = std::cos(order * theta);
      point.u += p.a1 * (terms[0].at(k).sine * sine + terms[0].at(k).cosine * cosine);
      point.v += p.a2 * (terms[1].at(k).sine * sine + terms[1].at(k).cosine * cosine);
    }
    return point;
  }
  double error_of(const SignalModel& model) const {
    double largest = 0;
    for (int i = 0; i < 360; ++i) {
      const double theta = 2 * pi * i / 360;
      const Point point = at(theta);
      largest = std::max(largest, std::abs(wrapped(angle_of(model, point.u, point.v) - theta)));
    }
    return largest;
  }
};

enum class Motion { steady, shuffled, random };

class Draw {
 public:
  explicit Draw(uint32_t seed) : random_(seed) {}
  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  double log_between(double low, double high) {
    return std::exp(between(std::log(low), std::log(high)));
  }
  double normal() { return std::normal_distribution<double>()(random_); }

  Sensor sensor(int lowest, int highest) {
    Sensor s;
    s.p.a1 = between(0.1, 0.9);
    s.p.a2 = std::clamp(s.p.a1 * log_between(0.5, 2), 0.1, 0.9);
    s.p.b1 = between(-0.3, 0.3);
    s.p.b2 = between(-0.3, 0.3);
    s.p.beta = between(-1, 1);
    const double size = log_between(1e-3, 3e-2);
    for (auto& channel : s.terms)
      for (int order = lowest; order <= highest; ++order) {
        const double amplitude = size * between(0, 1), phase = between(0, 2 * pi);
        channel.at(static_cast<std::size_t>(order)) = {amplitude * std::cos(phase),
                                                       amplitude * std::sin(phase)};
      }
    return s;
  }

  Samples samples(const Sensor& sensor, Motion motion) {
    const auto count = static_cast<Eigen::Index>(log_between(60, 4000));
    const double noise = log_between(1e-4, 1e-2) * std::min(sensor.p.a1, sensor.p.a2);
    const double origin = between(0, 2 * pi), turns = between(1.1, 4);
    Samples all = {Eigen::ArrayXd(count), Eigen::ArrayXd(count)};
    for (Eigen::Index i = 0; i < count; ++i) {
      const double part = static_cast<double>(i) / static_cast<double>(count);
      const double angle = motion == Motion::random ? between(0, 2 * pi) : 2 * pi * turns * part;
      const Point point = sensor.at(origin + angle);
      all.u[i] = point.u + noise * normal();
      all.v[i] = point.v + noise * normal();
    }
    for (Eigen::Index i = count - 1; motion == Motion::shuffled && i > 0; --i) {
      const auto k = static_cast<Eigen::Index>(between(0, static_cast<double>(i) + 0.999));
      std::swap(all.u[i], all.u[k]);
      std::swap(all.v[i], all.v[k]);
    }
    return all;
  }

 private:
  std::mt19937 random_;
};

struct Tally {
  int bounds = 0;
  double worst = 0;  ///< error in units of the bound
};

Tally fit_drawn(int records, int lowest, int highest, Motion motion) {
  constexpr uint32_t seed = 11;
  Draw draw(seed);
  Tally tally;
  for (int record = 0; record < records; ++record) {
    const Sensor sensor = draw.sensor(lowest, highest);
    IdentifyOptions options;
    options.harmonics.highest = 3;
    const auto found = identify(draw.samples(sensor, motion), options);
    if (!found || found.value().rejected() || !found.value().bound) continue;
    ++tally.bounds;
    tally.worst = std::max(
        tally.worst, sensor.error_of(found.value().harmonics.model) / found.value().bound->total);
  }
  std::printf("seed %u: %d of %d with a bound, worst error %.2f of it\n", seed, tally.bounds,
              records, tally.worst);
  return tally;
}

TEST(HarmonicsBound, HoldsWhereTheHarmonicsAreThoseThatWereAskedFor) {
  const Tally tally = fit_drawn(40, 2, 3, Motion::steady);
  EXPECT_GE(tally.bounds, 36);
  EXPECT_LE(tally.worst, 1);
}

TEST(HarmonicsBound, IsNotStatedOrHoldsWhereThereAreMore) {
  EXPECT_LE(fit_drawn(30, 2, 5, Motion::steady).worst, 1);
  EXPECT_LE(fit_drawn(30, 4, 5, Motion::steady).worst, 1);
}

TEST(HarmonicsBound, IsNotStatedOrHoldsWhereTheOrderIsLost) {
  for (const Motion motion : {Motion::shuffled, Motion::random})
    for (const int highest : {3, 5})
      EXPECT_LE(fit_drawn(20, 2, highest, motion).worst, 1) << static_cast<int>(motion);
}

}  // namespace
}  // namespace capsoc::identification
