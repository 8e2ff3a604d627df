// Limited slew of the coefficients (JUDGE.SLEW): what a burst of spikes does to the parameters with
// each limit, and what the limit costs: the time to settle. The figures of
// docs/explanation/measurements.md, "Limited slew".
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <random>

#include "bench.h"

namespace capsoc::coprocessor::test {
namespace {

constexpr double sample_hz = 250;
constexpr double turn_a_sample = 0.05 / sample_hz;
constexpr uint32_t reset_step = 1349307;
constexpr uint32_t learning = ctrl_demod | ctrl_calib;
constexpr int spikes = 50;

Options of(Arithmetic arithmetic) {
  Options options;
  options.arithmetic = arithmetic;
  return options;
}

void limit(Bench& bench, unsigned slew) {
  bench.write(reg_judge, 0x13333u | slew << judge_slew_shift);
}

double worst(const std::array<double, 6>& deviation) {
  return *std::max_element(deviation.begin(), deviation.end());
}

double coefficient_change(const Nodes& now, const Nodes& before) {
  int64_t most = 0;
  for (int64_t Nodes::*w :
       {&Nodes::a_u, &Nodes::b_u, &Nodes::c_u, &Nodes::a_v, &Nodes::b_v, &Nodes::c_v})
    most = std::max(most, std::abs(now.*w - before.*w));
  return std::ldexp(static_cast<double>(most), -46);
}

// s until all six parameters stay within 1 %, from reset; the whole time if they do not.
double settling(Arithmetic arithmetic, unsigned slew, double seconds) {
  const Sensor sensor;
  Bench bench(of(arithmetic));
  bench.start(learning, turn_a_sample, reset_step);
  limit(bench, slew);
  double settled = 0;
  for (int k = 0; k < seconds * sample_hz; ++k) {
    bench.sample(sensor, tau * turn_a_sample * k);
    if (worst(deviations(bench.parameters(), sensor)) > 0.01) settled = (k + 1) / sample_hz;
  }
  return settled;
}

struct Burst {
  double parameters = 0;  // largest relative deviation of a parameter, as deviations()
  double angle = 0;       // largest error of a good sample's angle, degrees
  double step = 0;        // largest change of a coefficient in one sample
  bool alarm = false;
};

// 400 s without a limit, then a second with 50 spikes, each fifth sample, and a turn of recovery.
Burst burst(Arithmetic arithmetic, unsigned slew) {
  const Sensor sensor;
  Bench bench(of(arithmetic));
  bench.start(learning, turn_a_sample, reset_step);
  int k = 0;
  for (; k < 100000; ++k) bench.sample(sensor, tau * turn_a_sample * k);
  limit(bench, slew);
  bench.write(reg_flags, flags_all);
  std::mt19937 random(11);
  Burst out;
  for (int i = 0; i < 5 * spikes + 5000; ++i, ++k) {
    const double shaft = tau * turn_a_sample * k;
    const Nodes before = bench.dut.nodes();
    if (i < 5 * spikes && i % 5 == 0) {
      Sensor spike = sensor;
      (random() % 2 == 0 ? spike.b1 : spike.b2) += random() % 2 == 0 ? 0.9 : -0.9;
      bench.sample(spike, shaft);
    } else {
      bench.sample(sensor, shaft);
      out.angle = std::max(out.angle, distance_degrees(bench.angle(), shaft + sensor.phi));
    }
    out.step = std::max(out.step, coefficient_change(bench.dut.nodes(), before));
    out.parameters = std::max(out.parameters, worst(deviations(bench.parameters(), sensor)));
  }
  out.alarm = (bench.read(reg_flags) & flag_alarm) != 0;
  return out;
}

class Slew : public testing::TestWithParam<Arithmetic> {};

TEST_P(Slew, KeepsABurstOfSpikesOutOfTheParameters) {
  const double step = reset_step / 2147483648.0;
  const Burst without = burst(GetParam(), 0);
  std::printf("SLEW 0: parameters %.3g, angle %.3g deg, coefficients %.3g a sample\n",
              without.parameters, without.angle, without.step);
  double last = without.parameters;
  for (unsigned n = 1; n < 8; ++n) {
    const Burst with = burst(GetParam(), n);
    std::printf("SLEW %u: parameters %.3g, angle %.3g deg, coefficients %.3g a sample\n", n,
                with.parameters, with.angle, with.step);
    EXPECT_FALSE(with.alarm) << "spikes that are too rare for the alarm";
    // The bound that the document states, and one unit of the word (Q1.31) for the rounding.
    EXPECT_LE(with.step, std::ldexp(step, -2 * static_cast<int>(n)) + 0x1p-30);
    EXPECT_LE(with.parameters, last * 0.85);
    last = with.parameters;
  }
}

TEST_P(Slew, CostsTimeToSettle) {
  constexpr std::array<double, 5> least = {90, 90, 100, 180, 550}, most = {100, 100, 115, 220, 680};
  for (unsigned n = 0; n < least.size(); ++n) {
    const double settled = settling(GetParam(), n, most[n] + 20);
    std::printf("SLEW %u: within 1 %% for good after %.2f s\n", n, settled);
    EXPECT_GE(settled, least[n]);
    EXPECT_LE(settled, most[n]);
  }
}

INSTANTIATE_TEST_SUITE_P(Arithmetics, Slew, testing::Values(Arithmetic::precise, Arithmetic::paper),
                         [](const auto& which) {
                           return which.param == Arithmetic::paper ? "Paper" : "Precise";
                         });

}  // namespace
}  // namespace capsoc::coprocessor::test
