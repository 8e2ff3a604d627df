#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "coprocessor/coprocessor.h"

namespace capsoc::reproduce {

/// The coprocessor model as the SoC paper's, sample after sample, without a simulation: the paper's
/// arithmetic and steps of sections 4.2 and 4.3, the reference at 0.05 Hz / 250 Hz. Four settings
/// that the paper does not state give its Table 8:
/// - a frequency word truncated to 31 bits (858,992)
/// - two samples of latency between reference and data
/// - steps scaled by 2^-7
/// - 16-bit multipliers in the PI arctangent
class CoprocessorRun {
 public:
  static constexpr int operand_bits = 16;

  static constexpr uint32_t papers_frequency = 858992;  // 2 floor(2^31 0.05 / 250)

  explicit CoprocessorRun(const coprocessor::Options& options = papers_options(),
                          uint32_t frequency_word = papers_frequency)
      : device_(options) {
    const std::array<double, 6> steps = {0.2, 0.2, 0.2, 0.5, 0.3, 0.1};
    for (uint32_t i = 0; i < steps.size(); ++i)
      write(coprocessor::reg_step_au + 4 * i,
            static_cast<uint32_t>(std::llround(steps.at(i) * 0x1p31)));
    // Of 32 bits, as the paper's accumulator is: the upper ones of ours.
    write(coprocessor::reg_freq_lo, 0);
    write(coprocessor::reg_freq_hi, frequency_word);
  }

  /// The SoC paper's unit with the settings that give its Table 8.
  static coprocessor::Options papers_options() {
    coprocessor::Options options;
    options.arithmetic = coprocessor::Arithmetic::paper;
    options.paper_operand_bits = operand_bits;
    options.paper_reference_lead = 2;
    options.paper_step_shift = 7;
    options.paper_plain_arctangent = true;
    return options;
  }

  /// Parameters that were stored, for calibration mode: written and loaded as firmware does.
  void load(const std::array<uint32_t, 6>& words) {
    for (uint32_t i = 0; i < words.size(); ++i) write(coprocessor::reg_a1 + 4 * i, words.at(i));
    write(coprocessor::reg_cmd, coprocessor::cmd_load);
    cycle_ += cycles_a_sample;  // LOAD takes 97
  }

  /// Gates of CTRL for the samples to come.
  void control(uint32_t gates) { write(coprocessor::reg_ctrl, gates | coprocessor::ctrl_adc); }

  /// One sample, to its result.
  void submit(int32_t u, int32_t v) {
    device_.submit(cycle_, u, v, false);
    cycle_ += cycles_a_sample;
  }

  uint32_t read(uint32_t offset) { return device_.read(cycle_, offset, true).value; }

  /// a1, a2, b1, b2, beta, phi.
  std::array<uint32_t, 6> parameter_words() {
    std::array<uint32_t, 6> words{};
    for (uint32_t i = 0; i < words.size(); ++i) words.at(i) = read(coprocessor::reg_a1 + 4 * i);
    return words;
  }

 private:
  static constexpr uint64_t cycles_a_sample = 200;  // more than the latency: one sample in flight

  void write(uint32_t offset, uint32_t value) { device_.write(cycle_, offset, value); }

  coprocessor::Coprocessor device_;
  uint64_t cycle_ = 1;
};

}  // namespace capsoc::reproduce
