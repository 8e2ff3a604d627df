#include "metrics/metrics.h"

#include <algorithm>
#include <cmath>

#include "base/constants.h"

namespace capsoc::metrics {
namespace {

const double degrees_per_turn = 360.0;

void keep_larger(std::optional<double>& largest, double value) {
  largest = largest ? std::max(*largest, value) : value;
}

}  // namespace

double wrapped_difference(double a, double b) {
  return std::remainder(a - b, two_pi);
}

std::optional<ParameterWords> to_words(const Parameters& values) {
  const auto fits = [](double value) {
    const double word = std::round(value * q31);
    return word >= -q31 && word < q31;  // NaN does not
  };
  const bool amplitudes = fits(values.a1) && fits(values.a2) && values.a1 > 0 && values.a2 > 0;
  const bool angles = std::isfinite(values.beta) && std::isfinite(values.phi);
  if (!amplitudes || !fits(values.b1) || !fits(values.b2) || !angles) return std::nullopt;
  const auto fraction = [](double value) {
    return static_cast<int32_t>(std::llround(value * q31));
  };
  const auto turn = [](double angle) {
    const double turns = std::remainder(angle, two_pi) / two_pi;
    return static_cast<uint32_t>(static_cast<int64_t>(std::llround(turns * q32)));
  };
  return ParameterWords{fraction(values.a1), fraction(values.a2), fraction(values.b1),
                        fraction(values.b2), turn(values.beta),   turn(values.phi)};
}

Metrics::Metrics(std::optional<Parameters> truth, double revolution_s,
                 std::optional<TruthAlignment> alignment)
    : truth_(truth),
      revolution_s_(revolution_s),
      sensor_reversed_(truth ? std::cos(truth->beta) < 0 : alignment && alignment->reversed) {
  if (alignment && std::fabs(alignment->zero_turns) > own_zero_turns)
    zero_turns_ = alignment->zero_turns;
}

void Metrics::accepted(const SensorTruth& sample) {
  in_flight_.push_back(sample);
}

bool Metrics::within_one_percent(const ParameterWords& words) const {
  const Parameters now = to_values(words);
  const auto close = [](double value, double wanted) {
    return std::fabs(value - wanted) <= 0.01 * std::fabs(wanted);
  };
  const auto close_angle = [](double value, double wanted) {
    return std::fabs(wrapped_difference(value, wanted)) <= 0.01 * std::fabs(wanted);
  };
  return close(now.a1, truth_->a1) && close(now.a2, truth_->a2) && close(now.b1, truth_->b1) &&
         close(now.b2, truth_->b2) && close_angle(now.beta, truth_->beta) &&
         close_angle(now.phi, truth_->phi);
}

void Metrics::result(const CoprocessorResult& result) {
  if (in_flight_.empty()) return;  // a sample that software fed: nothing is known about it
  const SensorTruth sample = in_flight_.front();
  in_flight_.pop_front();
  ++samples_;

  if (result.demodulating) {
    const bool late = !has_demodulated_ && sample.time_s > 0;
    if (late || !result.numeric_reference) phi_shifted_ = true;
    has_demodulated_ = true;
    words_ = result.words;
    if (truth_) {
      const bool inside = within_one_percent(result.words);
      if (!inside) converged_since_s_.reset();
      if (inside && !converged_since_s_) converged_since_s_ = sample.time_s;
    }
  }
  const bool in_change = follow_correction(result.correcting);
  if (!sample.has_truth) return;
  errors_.angle_known = true;

  const double aligned = sample.angle_turns + zero_turns_;
  const double turns = aligned - std::floor(aligned);
  if (result.demodulating || !has_demodulated_) {
    const double raw = std::atan2(sample.u, sample.v);
    keep_larger(errors_.uncalibrated_max,
                std::fabs(wrapped_difference(raw, turns * two_pi)) / two_pi * degrees_per_turn);
    if (truth_)
      keep_larger(errors_.uncalibrated_max_paper,
                  std::fabs(wrapped_difference(raw, turns * two_pi - truth_->phi)) / two_pi *
                      degrees_per_turn);
  }
  if (!result.angle_valid) return;
  const double expected = counts_reversed(result.words.beta) ? 0.5 - turns : turns;
  const double error = std::fabs(turn_difference(result.angle / q32, expected)) * degrees_per_turn;
  keep_suffix(error);
  if (result.demodulating) {
    keep_last_revolution({sample.time_s, error});
  } else if (!in_change) {
    keep_larger(errors_.calibration_mode_max, error);
  }
}

bool Metrics::counts_reversed(uint32_t beta) const {
  constexpr uint32_t quarter = uint32_t{1} << 30;
  const bool program_reversed = beta - quarter < 2 * quarter;
  return program_reversed != sensor_reversed_;
}

void Metrics::keep_suffix(double degrees) {
  while (!suffixes_.empty() && suffixes_.back().degrees <= degrees) suffixes_.pop_back();
  suffixes_.push_back({samples_, degrees});
  if (suffixes_.size() > most_suffixes) suffixes_.pop_front();
}

std::optional<double> Metrics::largest_error_of_last(uint64_t samples) const {
  const uint64_t first = samples < samples_ ? samples_ - samples + 1 : 1;
  for (const NumberedError& error : suffixes_)
    if (error.sample >= first) return error.degrees;
  return std::nullopt;
}

/// Angles with and without the correction are two things: the largest error is that of the last.
/// True for results of samples that may have entered before the change.
bool Metrics::follow_correction(bool correcting) {
  constexpr unsigned pipeline_depth = 5;
  if (correcting != correcting_) in_change_ = pipeline_depth;
  correcting_ = correcting;
  if (in_change_ == 0) return false;
  --in_change_;
  errors_.calibration_mode_max.reset();
  return true;
}

void Metrics::keep_last_revolution(TimedError newest) {
  // Less than half a sample's worth of rounding: a turn of n samples is n of them, not n + 1.
  const double age = revolution_s_ * (1 - 1e-9);
  last_revolution_.push_back(newest);
  // A time that goes back is a sensor that began again.
  while (newest.time_s - last_revolution_.front().time_s >= age ||
         newest.time_s < last_revolution_.front().time_s ||
         last_revolution_.size() > longest_revolution)
    last_revolution_.pop_front();
}

Convergence Metrics::convergence() const {
  if (!truth_ || !phi_comparable()) return {Convergence::State::not_known};
  if (!converged_since_s_) return {Convergence::State::not_reached};
  return {Convergence::State::reached, *converged_since_s_};
}

AngleErrors Metrics::angle_errors() const {
  AngleErrors errors = errors_;
  for (const TimedError& error : last_revolution_)
    keep_larger(errors.calibrated_max_last_revolution, error.degrees);
  return errors;
}

void ParameterWords::visit(Archive& archive) {
  archive("a1", a1);
  archive("a2", a2);
  archive("b1", b1);
  archive("b2", b2);
  archive("beta", beta);
  archive("phi", phi);
}

void SensorTruth::visit(Archive& archive) {
  archive("time_s", time_s);
  archive("u", u);
  archive("v", v);
  archive("angle_turns", angle_turns);
  archive("has_truth", has_truth);
}

void AngleErrors::visit(Archive& archive) {
  archive("angle_known", angle_known);
  archive("uncalibrated_max", uncalibrated_max);
  archive("uncalibrated_max_paper", uncalibrated_max_paper);
  archive("calibrated_max_last_revolution", calibrated_max_last_revolution);
  archive("calibration_mode_max", calibration_mode_max);
}

void Metrics::NumberedError::visit(Archive& archive) {
  archive("sample", sample);
  archive("degrees", degrees);
}

void Metrics::TimedError::visit(Archive& archive) {
  archive("time_s", time_s);
  archive("degrees", degrees);
}

void Metrics::visit(Archive& archive) {
  archive("samples", samples_);
  archive("in_flight", in_flight_);
  archive("words", words_);
  archive("has_demodulated", has_demodulated_);
  archive("phi_shifted", phi_shifted_);
  archive("correcting", correcting_);
  archive("in_change", in_change_);
  archive("converged_since_s", converged_since_s_);
  archive.sequence("last_revolution", last_revolution_, longest_revolution + 1);
  archive.sequence("suffixes", suffixes_, most_suffixes + 1);
  archive("errors", errors_);
}

}  // namespace capsoc::metrics
