#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace capsoc::sensor {

/// One sample of the two channels. 1.0 is the converter's full scale; values beyond +-1 are legal
/// here, the ADC front-end clips them.
struct SensorValue {
  double u = 0.0;
  double v = 0.0;
  double angle_turns = 0.0;      ///< true angle theta in [0, 1); only when has_truth
  bool has_truth = false;        ///< the true angle is known
  double reference_turns = 0.0;  ///< theta without phi (omega k of the paper) in [0, 1)
};

enum class MotionKind { constant, ripple, shuffled, walk, swing, profile, recorded };

/// "constant", "ripple", ...: the word used in description files and reports.
const char* name_of(MotionKind kind);

/// What is known about a source before its first sample. Absent means unknown, never zero; a
/// parameter that drifts has no one value and is absent, too.
/// U = a1 sin(theta) + b1, V = a2 cos(theta + beta) + b2 (the SoC paper, Eq (1)); amplitudes and
/// offsets in units of full scale, beta and phi in radians, theta = omega t + phi.
struct Description {
  std::string name;
  std::string origin;  ///< where the signal comes from, one sentence
  MotionKind motion = MotionKind::recorded;
  std::optional<double> a1, a2, b1, b2, beta, phi;
  std::optional<double> frequency_hz;    ///< mean rotation, negative: reverse
  std::optional<double> reference_hz;    ///< the frequency that firmware gets
  std::optional<double> sample_rate_hz;  ///< rate that the signal is meant for, or was recorded at
  std::optional<int> adc_bits;           ///< converter width, 12 .. 32
  std::optional<uint64_t> samples;       ///< length of the record
  // Of a recording only.
  std::string unit = {};                  ///< what its values were taken for, with --scale auto
  double full_scale = 1, zero = 0;        ///< values of the file that are 1 and 0 of full scale
  std::optional<double> step = {};        ///< of the grid that all values lie on, of full scale
  std::vector<std::string> remarks = {};  ///< sentences: what its user should know
};

/// A sensor. Deterministic: the same k and t after rewind() give the same bits.
class Source {
 public:
  virtual ~Source() = default;

  /// Sample number k, taken t seconds after the start. Nothing when the record has ended.
  virtual std::optional<SensorValue> sample(uint64_t k, double t_seconds) = 0;

  /// Back to before the first sample.
  virtual void rewind() = 0;

  virtual const Description& description() const = 0;
};

}  // namespace capsoc::sensor
