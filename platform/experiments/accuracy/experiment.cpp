#include "accuracy/experiment.h"

#include <algorithm>
#include <cmath>
#include <future>

#include "base/constants.h"
#include "coprocessor/coprocessor.h"
#include "coprocessor/register_map.h"
#include "peripherals/quantiser.h"
#include "sensor/described_source.h"

namespace capsoc::accuracy {
namespace {

using namespace coprocessor;

constexpr uint64_t cycles_a_sample = 200;  // more than the latency: one sample in flight

Options options_of(Arithmetic arithmetic) {
  Options options;
  options.arithmetic = arithmetic;
  return options;
}

double part_of_turn(double turns) {
  return turns - std::round(turns);
}

class Run {
 public:
  Run(const Experiment& experiment, Arithmetic arithmetic)
      : experiment_(experiment),
        device_(options_of(arithmetic)),
        source_(experiment.signal),
        rate_hz_(experiment.signal.sample_rate_hz) {
    const auto word = std::llround(std::ldexp(experiment.reference_hz / rate_hz_, 48));
    write(reg_freq_lo, static_cast<uint32_t>(word & 0xFFFF));
    write(reg_freq_hi, static_cast<uint32_t>(word >> 16));
    if (experiment.step) {
      const auto step = static_cast<uint32_t>(std::llround(*experiment.step * 0x1p31));
      for (uint32_t r = reg_step_au; r <= reg_step_cv; r += 4) write(r, step);
    }
    if (experiment.blocks) prepare_blocks();
    write(reg_ctrl, ctrl_demod | ctrl_calib | ctrl_adc | (experiment.blocks ? ctrl_block : 0) |
                        static_cast<uint32_t>(experiment.source) << ctrl_ref_shift);
  }

  Outcome finish() {
    const auto count = std::llround(experiment_.duration_s * rate_hz_);
    const auto first = count - std::llround(experiment_.window_s * rate_hz_);
    Outcome outcome;
    long long outside = 0;  // samples up to the last one with a parameter off by more than 1 %
    for (long long k = 0; k < count; ++k) {
      const double truth = step(static_cast<uint64_t>(k), outcome);
      if (!settled()) outside = k + 1;
      if (k < first) continue;
      const double turns = part_of_turn(read(reg_angle) * 0x1p-32 - truth);
      outcome.error_deg = std::max(outcome.error_deg, 360.0 * std::abs(turns));
    }
    outcome.parameters = {fraction(reg_a1), fraction(reg_a2), fraction(reg_b1), fraction(reg_b2),
                          part_of_turn(read(reg_beta) * 0x1p-32) * two_pi};
    if (outside < count) outcome.settled_s = static_cast<double>(outside) / rate_hz_;
    return outcome;
  }

 private:
  /// 2 / N for sine and cosine, 1 / N for the constant.
  void prepare_blocks() {
    const double turn = rate_hz_ / std::abs(experiment_.reference_hz);
    const auto step = static_cast<uint32_t>(std::llround(0x1p32 / turn));
    for (uint32_t i = 0; i < 6; ++i) {
      write(reg_step_au + 4 * i, i == 2 || i == 5 ? step / 2 : step);
      write(reg_au_lo + 8 * i, 0);
      write(reg_au_lo + 8 * i + 4, 0);
    }
  }

  /// One sample through converter and coprocessor; the true angle in turns.
  double step(uint64_t k, Outcome& outcome) {
    const auto value = source_.sample(k, static_cast<double>(k) / rate_hz_);
    const auto bits = static_cast<unsigned>(experiment_.signal.adc_bits);
    const peripherals::Quantised u = peripherals::quantise(value->u, bits);
    const peripherals::Quantised v = peripherals::quantise(value->v, bits);
    const bool clip = u.clipped || v.clipped;
    outcome.clipped = outcome.clipped || clip;
    device_.submit(cycle_, u.word, v.word, clip);
    cycle_ += cycles_a_sample;
    device_.advance(cycle_);
    return value->angle_turns;
  }

  bool settled() {
    const sensor::SignalConfig& s = experiment_.signal;
    return near(reg_a1, s.a1) && near(reg_a2, s.a2) && near(reg_b1, s.b1) && near(reg_b2, s.b2) &&
           std::abs(part_of_turn(read(reg_beta) * 0x1p-32 - s.beta / two_pi)) <=
               0.01 * std::abs(s.beta) / two_pi;
  }

  bool near(uint32_t offset, double truth) {
    return std::abs(fraction(offset) - truth) <= 0.01 * std::abs(truth);
  }

  double fraction(uint32_t offset) { return static_cast<int32_t>(read(offset)) * 0x1p-31; }
  uint32_t read(uint32_t offset) { return device_.read(cycle_, offset, true).value; }
  void write(uint32_t offset, uint32_t value) { device_.write(cycle_, offset, value); }

  const Experiment& experiment_;
  Coprocessor device_;
  sensor::DescribedSource source_;
  double rate_hz_;
  uint64_t cycle_ = 1;
};

}  // namespace

Outcome run(const Experiment& experiment, Arithmetic arithmetic) {
  return Run(experiment, arithmetic).finish();
}

Comparison compare(const Experiment& experiment) {
  auto paper = std::async(std::launch::async, [&] { return run(experiment, Arithmetic::paper); });
  const Outcome precise = run(experiment, Arithmetic::precise);
  return {precise, paper.get()};
}

}  // namespace capsoc::accuracy
