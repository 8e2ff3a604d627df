// The unevenness of a turn, from the angles that a sensor with harmonics along the circle gives.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

extern "C" {
#include "apps/common/evenness.c"
}

namespace {

constexpr double pi = 3.14159265358979323846;

uint32_t word_of(double turns) {
  return static_cast<uint32_t>(
      static_cast<int64_t>(std::llround((turns - std::floor(turns)) * 4294967296.0)));
}

/// Half the range, in turns, that is seen of `amplitude` turns of an order, after `turns` turns at
/// a steady `step` a sample. A window ends with the first sample after a whole turn.
double seen(unsigned order, double amplitude, double step, unsigned turns) {
  evenness state{};
  double travel = 0, before = 0;
  for (unsigned k = 0, done = 0; done < turns; ++k) {
    const double place = 0.3 + step * k;
    const double angle = place + amplitude * std::sin(2 * pi * order * place);
    evenness_feed(&state, word_of(angle), 1);
    if (k != 0) travel += angle - before;
    before = angle;
    if (std::fabs(travel) < 1) continue;
    evenness_end_window(&state, true);
    travel = 0;
    ++done;
  }
  return evenness_deviation(&state) / 4294967296.0;
}

/// However far the window's beginning wanders: it goes once round in some of these.
TEST(Evenness, SeesEveryOrderAtItsFixedPlaces) {
  for (const double step : {0.0019352, -0.0019352, 1 / 500.0, 0.0137, 0.00003})
    for (const unsigned order : {1u, 2u, 4u, 5u})
      for (const unsigned turns : {1u, 10u, step < 0.0001 ? 12u : 250u}) {
        const double amplitude = 1e-4;
        const double range = seen(order, amplitude, step, turns);
        // Linear between samples; 32 places in a turn.
        EXPECT_GT(range, 0.93 * amplitude) << order << " " << step << " " << turns;
        EXPECT_LT(range, 1.07 * amplitude) << order << " " << step << " " << turns;
      }
}

TEST(Evenness, OfASteadyTurnIsNone) {
  EXPECT_LT(seen(1, 0, 0.0019352, 250), 2e-9);
}

/// Steps of 0.001 turns there and back, and one of 0.1.
TEST(Evenness, TheExcessIsOfTheLongestStepEitherWay) {
  for (const double jump : {0.0, 0.1, -0.1}) {
    evenness state{};
    double angle = 0.3;
    for (unsigned k = 0; k < 1000; ++k) {
      evenness_feed(&state, word_of(angle), 1);
      angle += (k < 600 ? 0.001 : -0.001) + (k == 300 ? jump : 0);
    }
    const double longest = jump != 0 ? std::fabs(jump + 0.001) : 0.001;
    const double mean = 0.001 + (longest - 0.001) / 999;
    EXPECT_NEAR(evenness_excess(&state) / 4294967296.0, std::max(0.0, longest - 2 * mean), 1e-6);
  }
}

/// Three quarters of a turn forth, a quarter back and half a turn forth again are a whole turn, and
/// no steady one.
TEST(Evenness, ATurnInWhichTheShaftTurnsBackSaysNothing) {
  evenness state{};
  double angle = 0.3;
  for (unsigned k = 0; k < 1500; ++k) {
    evenness_feed(&state, word_of(angle), 1);
    angle += k < 750 || k >= 1000 ? 0.001 : -0.001;
  }
  evenness_end_window(&state, true);
  EXPECT_EQ(evenness_deviation(&state), 1u << 31);  // not known
  EXPECT_EQ(evenness_repeating(&state), 0u);
}

}  // namespace
