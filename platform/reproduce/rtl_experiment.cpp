#include "reproduce/rtl_experiment.h"

#include <algorithm>
#include <cmath>

#include "coprocessor/coprocessor.h"
#include "coprocessor/paper_units.h"
#include "sensor/described_source.h"

namespace capsoc::reproduce {
namespace {

using coprocessor::Coprocessor;

constexpr uint64_t samples = 100000;
constexpr double rate_hz = 250.0;
constexpr uint64_t last_window = 5000;     // 20 s
constexpr uint64_t cycles_a_sample = 200;  // more than the latency: one sample in flight
constexpr int operand_bits = 16;
constexpr uint32_t frequency_word = 858992;  // 2 floor(2^31 0.05 / 250)

uint32_t step_word(double step) {
  return static_cast<uint32_t>(std::llround(step * 0x1p31));
}

int32_t adc_word(double value) {
  return static_cast<int32_t>(std::clamp(std::floor(value * 0x1p31 + 0.5), -0x1p31, 0x1p31 - 1.0));
}

class Run {
 public:
  Run() : device_(options()), source_(sensor::SignalConfig()) {
    const std::array<double, 6> steps = {0.2, 0.2, 0.2, 0.5, 0.3, 0.1};
    for (uint32_t i = 0; i < steps.size(); ++i) {
      write(coprocessor::reg_step_au + 4 * i, step_word(steps[i]));
    }
    write(coprocessor::reg_freq_lo, 0);
    write(coprocessor::reg_freq_hi, frequency_word);
  }

  /// Feeds the record once; the largest angle error of the samples from `first` on.
  double record(uint32_t ctrl, uint64_t first) {
    write(coprocessor::reg_ctrl, ctrl | coprocessor::ctrl_adc);
    double largest = 0.0;
    for (uint64_t k = 0; k < samples; ++k) {
      const auto value = source_.sample(k, static_cast<double>(k) / rate_hz);
      device_.submit(cycle_, adc_word(value->u), adc_word(value->v), false);
      cycle_ += cycles_a_sample;
      if (k < first) continue;
      const double turns = read(coprocessor::reg_angle) * 0x1p-32 - value->angle_turns;
      largest = std::max(largest, 360.0 * std::abs(turns - std::round(turns)));
    }
    return largest;
  }

  uint32_t read(uint32_t offset) { return device_.read(cycle_, offset, true).value; }

 private:
  static coprocessor::Options options() {
    coprocessor::Options options;
    options.arithmetic = coprocessor::Arithmetic::paper;
    options.paper_operand_bits = operand_bits;
    options.paper_reference_lead = 2;
    options.paper_step_shift = 7;
    return options;
  }

  void write(uint32_t offset, uint32_t value) { device_.write(cycle_, offset, value); }

  Coprocessor device_;
  sensor::DescribedSource source_;
  uint64_t cycle_ = 1;
};

}  // namespace

RtlOutcome run_rtl() {
  Run run;
  RtlOutcome outcome;
  outcome.online_end =
      run.record(coprocessor::ctrl_demod | coprocessor::ctrl_calib, samples - last_window);
  for (uint32_t i = 0; i < outcome.words.size(); ++i) {
    outcome.words[i] = run.read(coprocessor::reg_a1 + 4 * i);
  }
  outcome.frozen = run.record(coprocessor::ctrl_calib, 0);
  return outcome;
}

double arctangent_error(double magnitude) {
  constexpr double two_pi = 6.283185307179586476925;
  constexpr int points = 3600;
  double largest = 0.0;
  for (int i = 0; i < points; ++i) {
    if (std::abs(i - points / 2) <= 10) continue;
    const double turns = static_cast<double>(i) / points;
    const int32_t sine = adc_word(magnitude * std::sin(two_pi * turns));
    const int32_t cosine = adc_word(magnitude * std::cos(two_pi * turns));
    const uint32_t angle = coprocessor::paper::arctangent(sine, cosine, operand_bits);
    const double error = angle * 0x1p-32 - turns;
    largest = std::max(largest, two_pi * std::abs(error - std::round(error)));
  }
  return largest;
}

}  // namespace capsoc::reproduce
