// The committed traces: all of them load, and those with a printed figure give it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "base/constants.h"
#include "sensor/load.h"

namespace capsoc::sensor {
namespace {

std::unique_ptr<Source> trace(const std::string& name) {
  Result<std::unique_ptr<Source>> result = load("traces/" + name);
  EXPECT_TRUE(result) << result.error();
  return result ? std::move(result.value()) : nullptr;
}

struct Errors {
  double largest, peak_to_peak, largest_from_mean;
};

/// Errors in degrees of the angle against the true one, raw or by Eq (4) with the parameters of
/// `d`.
Errors angle_errors(Source& source, const Description& d, uint64_t count, bool calibrated) {
  std::vector<double> errors;
  for (uint64_t k = 0; k < count; ++k) {
    const auto value = source.sample(k, static_cast<double>(k) / *d.sample_rate_hz);
    if (!value) break;
    double s = value->u, c = value->v;
    if (calibrated) {
      s = (value->u - *d.b1) / *d.a1;
      c = (value->v - *d.b2) / (*d.a2 * std::cos(*d.beta)) + s * std::tan(*d.beta);
    }
    const double turns = std::atan2(s, c) / two_pi - value->angle_turns;
    errors.push_back(360.0 * (turns - std::round(turns)));
  }
  const auto [low, high] = std::minmax_element(errors.begin(), errors.end());
  double mean = 0.0;
  for (const double error : errors) mean += error / static_cast<double>(errors.size());
  return {std::max(*high, -*low), *high - *low, std::max(*high - mean, mean - *low)};
}

Errors angle_errors(Source& source, uint64_t count, bool calibrated) {
  return angle_errors(source, source.description(), count, calibrated);
}

TEST(Traces, AllLoadAndGiveSamples) {
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator("traces")) {
    const std::string extension = entry.path().extension().string();
    if (extension != ".toml" && extension != ".csv") continue;
    ++files;
    Result<std::unique_ptr<Source>> source = load(entry.path().string());
    ASSERT_TRUE(source) << source.error();
    EXPECT_TRUE(source.value()->sample(0, 0.0));
    if (extension == ".toml") {
      EXPECT_EQ(source.value()->description().name, entry.path().stem().string());
      EXPECT_FALSE(source.value()->description().origin.empty());
    }
  }
  EXPECT_GE(files, 18);
}

TEST(Traces, TheSocSignalHasItsUncalibratedError) {
  const auto source = trace("soc_eq21.toml");
  EXPECT_NEAR(angle_errors(*source, 5000, false).largest, 25.364, 5e-4);
  EXPECT_LT(angle_errors(*source, 5000, true).largest, 1e-12);
}

TEST(Traces, TheCsfnSignalsHaveTheirPrintedErrors) {
  // 10,000 random angles come within 0.3 degrees of the largest error.
  EXPECT_NEAR(angle_errors(*trace("csfn_eq.toml"), 10000, false).peak_to_peak, 73.72, 0.3);
  EXPECT_NEAR(angle_errors(*trace("csfn_h3.toml"), 10000, false).peak_to_peak, 74.17, 0.3);
}

TEST(Traces, TheRebuiltExperimentsHaveTheirPrintedErrors) {
  const auto csfn = trace("csfn_experiment.toml");
  EXPECT_NEAR(angle_errors(*csfn, 20000, false).peak_to_peak, 42.57, 0.05);
  Description table_2 = csfn->description();
  table_2.a1 = 0.6083, table_2.a2 = 0.6223, table_2.b1 = 0.1324, table_2.b2 = 0.1830;
  table_2.beta = 0.0657;
  EXPECT_NEAR(angle_errors(*csfn, table_2, 20000, true).peak_to_peak, 2.97, 0.05);
  const auto soc = trace("soc_experiment.toml");
  const Errors raw = angle_errors(*soc, 4902, false);  // one turn
  EXPECT_NEAR(raw.peak_to_peak, 43.3964, 0.02);
  EXPECT_NEAR(raw.largest_from_mean, 22.5154, 0.02);
}

TEST(Traces, TheRebuiltExperimentLooksLikeTable9AgainstAForwardReference) {
  const auto source = trace("soc_experiment.toml");
  const double beta = 2105078019.0 * two_pi / 4294967295.0;
  const double phi = 3700681650.0 * two_pi / 4294967295.0;
  const double full = 2147483647.0;
  for (uint64_t k = 0; k < 5000; k += 50) {
    const double t = static_cast<double>(k) / 250.0;
    const double w = two_pi * 0.051 * t;
    const SensorValue value = *source->sample(k, t);
    // 1.4 % of harmonics and 1e-5 of noise apart.
    EXPECT_NEAR(value.u, (1308364580.0 * std::sin(w + phi) + 274228330.0) / full, 0.0088);
    EXPECT_NEAR(value.v, (1336685245.0 * std::cos(w + phi + beta) + 388108700.0) / full, 0.0089);
  }
}

TEST(Traces, TheExampleRecordingIsTheSignalItsHeadDescribes) {
  const auto source = trace("recorded_example.csv");
  EXPECT_EQ(source->description().samples, 750u);
  EXPECT_NEAR(*source->description().sample_rate_hz, 250.0, 1e-9);
  for (uint64_t k = 0; k < 750; ++k) {
    const SensorValue value = *source->sample(k, 0.0);
    const double theta = two_pi * static_cast<double>(k) / 250.0 + 0.0876;
    EXPECT_NEAR(value.u, 0.6079 * std::sin(theta) + 0.1336, 0x1p-16 + 1e-9);  // 16 bits
    EXPECT_NEAR(value.v, 0.6228 * std::cos(theta + 0.0629) + 0.1831, 0x1p-16 + 1e-9);
    const double turns = value.angle_turns - theta / two_pi;
    EXPECT_NEAR(turns - std::round(turns), 0.0, 1e-8);
  }
}

}  // namespace
}  // namespace capsoc::sensor
