#include "reproduce/rtl_experiment.h"

#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "coprocessor/paper_units.h"
#include "reproduce/paper_words.h"
#include "sensor/described_source.h"

namespace capsoc::reproduce {
namespace {

constexpr uint64_t samples = 100000;
constexpr double rate_hz = 250.0;
constexpr uint64_t last_window = 5000;  // 20 s

int32_t adc_word(double value) {
  return static_cast<int32_t>(std::clamp(std::floor(value * 0x1p31 + 0.5), -0x1p31, 0x1p31 - 1.0));
}

double uncalibrated() {
  sensor::DescribedSource source{sensor::SignalConfig()};
  double largest = 0.0;
  for (uint64_t k = 0; k < samples; ++k) {
    const auto value = source.sample(k, static_cast<double>(k) / rate_hz);
    const double turns = std::atan2(value->u, value->v) / two_pi - value->reference_turns;
    largest = std::max(largest, 360.0 * std::abs(turns - std::round(turns)));
  }
  return largest;
}

/// Feeds the record once; the largest angle error of the samples from `first` on. `curve` takes the
/// errors in degrees over time.
double record(CoprocessorRun& run, uint32_t ctrl, uint64_t first, Curve* curve = nullptr) {
  sensor::DescribedSource source{sensor::SignalConfig()};
  run.control(ctrl);
  double largest = 0.0;
  for (uint64_t k = 0; k < samples; ++k) {
    const auto value = source.sample(k, static_cast<double>(k) / rate_hz);
    run.submit(adc_word(value->u), adc_word(value->v));
    if (k < first) continue;
    const double turns = run.read(coprocessor::reg_angle) * 0x1p-32 - value->angle_turns;
    const double error = 360.0 * (turns - std::round(turns));
    if (curve != nullptr) curve->add(static_cast<double>(k) / rate_hz, error);
    largest = std::max(largest, std::abs(error));
  }
  return largest;
}

/// The record once, `each` after every sample until it says that this is enough.
template <typename Each>
void learn(CoprocessorRun& run, Each each) {
  sensor::DescribedSource source{sensor::SignalConfig()};
  run.control(coprocessor::ctrl_demod | coprocessor::ctrl_calib);
  for (uint64_t k = 0; k < samples; ++k) {
    const auto value = source.sample(k, static_cast<double>(k) / rate_hz);
    run.submit(adc_word(value->u), adc_word(value->v));
    if (!each(static_cast<double>(k + 1) / rate_hz)) return;
  }
}

}  // namespace

std::vector<std::array<uint32_t, 6>> rtl_learning_curve(const std::vector<double>& times_s) {
  CoprocessorRun run;
  std::vector<std::array<uint32_t, 6>> curve;
  learn(run, [&](double t) {
    if (t >= times_s[curve.size()]) curve.push_back(run.parameter_words());
    return curve.size() < times_s.size();
  });
  return curve;
}

std::optional<double> rtl_convergence_s() {
  const sensor::SignalConfig s;
  const std::array<double, 5> preset = {s.a1, s.a2, s.b1, s.b2, s.beta};
  CoprocessorRun run;
  std::optional<double> first;
  learn(run, [&](double t) {
    const auto words = run.parameter_words();
    bool within = true;
    for (std::size_t i = 0; i < preset.size(); ++i) {
      const double value = value_of_word(i, static_cast<int32_t>(words.at(i)));
      within = within && std::abs(value - preset.at(i)) <= 0.01 * std::abs(preset.at(i));
    }
    if (within) first = t;
    return !within;
  });
  return first;
}

double a1_with_printed_steps() {
  coprocessor::Options options = CoprocessorRun::papers_options();
  options.paper_step_shift = 0;
  CoprocessorRun run(options);
  learn(run, [](double) { return true; });
  return value_of_word(0, static_cast<int32_t>(run.parameter_words()[0]));
}

RtlOutcome run_rtl(const coprocessor::Options& options) {
  CoprocessorRun run(options);
  RtlOutcome outcome;
  outcome.uncalibrated = uncalibrated();
  outcome.online_end =
      record(run, coprocessor::ctrl_demod | coprocessor::ctrl_calib, samples - last_window);
  outcome.words = run.parameter_words();
  outcome.frozen = record(run, coprocessor::ctrl_calib, 0);
  return outcome;
}

Curve rtl_angle_error() {
  CoprocessorRun run;
  learn(run, [](double) { return true; });
  Curve curve;
  record(run, coprocessor::ctrl_calib, 0, &curve);
  return curve;
}

double arctangent_error(double magnitude, Curve* curve) {
  constexpr int points = 3600;
  double largest = 0.0;
  for (int i = 0; i < points; ++i) {
    if (std::abs(i - points / 2) <= 10) continue;
    const double turns = static_cast<double>(i) / points;
    const int32_t sine = adc_word(magnitude * std::sin(two_pi * turns));
    const int32_t cosine = adc_word(magnitude * std::cos(two_pi * turns));
    const uint32_t angle =
        coprocessor::paper::arctangent(sine, cosine, CoprocessorRun::operand_bits);
    const double error = angle * 0x1p-32 - turns;
    const double radians = two_pi * (error - std::round(error));
    if (curve != nullptr) curve->add(360 * turns, radians);
    largest = std::max(largest, std::abs(radians));
  }
  return largest;
}

}  // namespace capsoc::reproduce
