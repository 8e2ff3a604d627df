// The turn meter of firmware/apps/track, compiled for the host, on turns of a known length.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <random>

extern "C" {
#include "apps/track/turn_meter.c"
}

namespace {

struct Signal {
  double turn;        ///< samples
  double begin = 0;   ///< turns
  double noise = 0;   ///< standard deviation, of the amplitude
  unsigned seed = 0;  ///< of the noise
};

/// Length of the first turn that is found, in samples; 0: none in ten turns.
double measured(const Signal& signal) {
  std::mt19937_64 bits(signal.seed);
  std::normal_distribution<double> noise(0, signal.noise);
  turn_meter meter{};
  for (int k = 0; k < 10 * signal.turn; ++k) {
    const double angle = 6.283185307179586 * (signal.begin + k / signal.turn);
    const double value = 0.3 + 0.5 * (std::sin(angle) + (signal.noise > 0 ? noise(bits) : 0));
    const uint64_t turn =
        turn_meter_feed(&meter, static_cast<int32_t>(std::lround(value * 0x1p31)));
    if (turn != 0) return static_cast<double>(turn) / 256;
  }
  return 0;
}

TEST(TurnMeter, MeasuresFromTwentyTwoSamplesOn) {
  for (const double turn : {22.0, 27.7, 250.0, 4999.6})
    for (int begin = 0; begin < 16; ++begin)
      EXPECT_NEAR(measured({turn, begin / 16.0}), turn, 0.02 + turn / 1000) << begin;
}

TEST(TurnMeter, TakesNoNoiseForATurn) {
  for (unsigned seed = 1; seed <= 20; ++seed)
    for (const double share : {0.003, 0.01})
      for (int begin = 0; begin < 16; ++begin)
        EXPECT_NEAR(measured({5000, begin / 16.0, share, seed}), 5000, 120) << seed << ' ' << begin;
}

}  // namespace
