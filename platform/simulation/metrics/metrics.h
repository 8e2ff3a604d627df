// The metrics of a run: the identified parameters, and the angle error compared with the sensor's
// true angle.
#pragma once

#include <cmath>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "base/archive.h"
#include "base/constants.h"
#include "metrics/truth_alignment.h"

namespace capsoc::metrics {

/// The six parameters of the SoC paper's Eq (5). Amplitudes and offsets in full scale, angles in
/// radians.
struct Parameters {
  double a1 = 0, a2 = 0, b1 = 0, b2 = 0, beta = 0, phi = 0;
};

/// The six parameters as the coprocessor's registers hold them.
struct ParameterWords {
  int32_t a1 = 0, a2 = 0, b1 = 0, b2 = 0;  ///< Q1.31
  uint32_t beta = 0, phi = 0;              ///< 2^-32 turn

  void visit(Archive& archive);
};

/// Words to numbers: Q1.31 to full scale, 2^-32 turn to radians in (-pi, pi].
inline Parameters to_values(const ParameterWords& words) {
  const auto radians = [](uint32_t turn_word) {
    return static_cast<int32_t>(turn_word) / q32 * two_pi;
  };
  return {words.a1 / q31, words.a2 / q31,      words.b1 / q31,
          words.b2 / q31, radians(words.beta), radians(words.phi)};
}

/// Shortest difference from `b` to `a`, turns in [-0.5, 0.5]; exact.
inline double turn_difference(double a, double b) {
  return (a - b) - std::nearbyint(a - b);
}

/// Numbers to words, rounded to the nearest. Empty if an amplitude is not above 0 and below full
/// scale, or an offset does not fit the registers.
std::optional<ParameterWords> to_words(const Parameters& values);

/// A sample that the coprocessor took, with the sensor's true values.
struct SensorTruth {
  double time_s = 0;       ///< of the sensor, since its sample 0
  double u = 0, v = 0;     ///< before quantisation
  double angle_turns = 0;  ///< true mechanical angle theta, turns
  bool has_truth = false;

  void visit(Archive& archive);
};

/// The coprocessor's result for a sample.
struct CoprocessorResult {
  uint32_t angle = 0;  ///< 2^-32 turn
  bool angle_valid = false;
  bool demodulating = false;
  bool numeric_reference = true;
  ParameterWords words = {};
  bool correcting = false;  ///< CTRL.CORRECT
};

/// When all six parameters are within 1 % of the truth.
struct Convergence {
  enum class State {
    not_known,    ///< the sensor's parameters are not known, or phi's is not comparable
    not_reached,  ///< they were not within it when demodulation ended
    reached,
  };
  State state = State::not_known;
  double since_s = 0;  ///< only with `reached`: the sensor's time from when on they stayed, seconds
};

/// Largest absolute angle errors, degrees; empty if the sensor's angle is not known or the run did
/// not reach that phase.
struct AngleErrors {
  bool angle_known = false;  ///< of any sample
  /// atan2(U, V) against theta, in demodulation (before the first of it: in calibration mode)
  std::optional<double> uncalibrated_max;
  std::optional<double>
      uncalibrated_max_paper;  ///< atan2(U, V) against omega k, as the paper counts
  std::optional<double> calibrated_max_last_revolution;  ///< last revolution of demodulation
  /// all of calibration mode; since CTRL.CORRECT changed, if it did
  std::optional<double> calibration_mode_max;

  void visit(Archive& archive);
};

/// Computes the metrics sample by sample. Never influences the simulation.
class Metrics {
 public:
  /// `truth`: the sensor's parameters where known. `revolution_s`: of one turn of the sensor, in
  /// the sensor's time.
  /// `alignment`: of a recording with angles.
  Metrics(std::optional<Parameters> truth, double revolution_s,
          std::optional<TruthAlignment> alignment = std::nullopt);

  /// A sample that the coprocessor accepted; results arrive in the same order.
  void accepted(const SensorTruth& sample);
  void result(const CoprocessorResult& result);
  /// Call when the coprocessor was reset: samples in flight are dropped.
  void dropped_all() { in_flight_.clear(); }

  uint64_t samples() const { return samples_; }
  Convergence convergence() const;
  /// Whether phi can be compared with the sensor's. phi is relative to the reference's angle at the
  /// sensor's sample 0, so the sensor's phi is the true one for a numeric reference that began
  /// there. It is not for a program that measured or tracked the speed, took the angle as its
  /// reference or never demodulated.
  bool phi_comparable() const { return has_demodulated_ && !phi_shifted_; }
  /// In the program's own direction: while its beta is beyond a quarter turn and the sensor's is
  /// not, or the other way round, its angle is half a turn less the sensor's.
  AngleErrors angle_errors() const;
  /// Largest error of the last `samples` results, degrees; empty if none is known.
  std::optional<double> largest_error_of_last(uint64_t samples) const;
  /// The parameters at the end of demodulation; without demodulation, the preset ones.
  const ParameterWords& words() const { return words_; }
  void preset(const ParameterWords& words) { words_ = words; }

  void visit(Archive& archive);
  const std::optional<Parameters>& truth() const { return truth_; }

 private:
  struct TimedError {
    double time_s = 0, degrees = 0;

    void visit(Archive& archive);
  };

  /// The largest error of each suffix of the results: those that a later one exceeds are gone.
  struct NumberedError {
    uint64_t sample = 0;
    double degrees = 0;

    void visit(Archive& archive);
  };

  static constexpr std::size_t longest_revolution = 10'000'000;  ///< samples
  static constexpr std::size_t most_suffixes = 65536;

  bool within_one_percent(const ParameterWords& words) const;
  bool follow_correction(bool correcting);
  void keep_last_revolution(TimedError newest);
  void keep_suffix(double degrees);
  bool counts_reversed(uint32_t beta) const;

  std::optional<Parameters> truth_;
  double revolution_s_;
  double zero_turns_ = 0;  ///< added to the recorded angle
  uint64_t samples_ = 0;
  std::deque<SensorTruth> in_flight_;
  ParameterWords words_;
  bool has_demodulated_ = false;
  bool phi_shifted_ = false;
  bool correcting_ = false;
  unsigned in_change_ = 0;  ///< results of samples that may have entered before CORRECT changed
  std::optional<double> converged_since_s_;
  bool sensor_reversed_;                    ///< beta beyond a quarter turn
  std::deque<TimedError> last_revolution_;  ///< of demodulation, the newest last
  std::deque<NumberedError> suffixes_;
  AngleErrors errors_;
};

/// a - b wrapped to (-pi, pi].
double wrapped_difference(double a, double b);

}  // namespace capsoc::metrics
