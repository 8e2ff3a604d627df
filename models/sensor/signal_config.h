#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sensor/source.h"

namespace capsoc::sensor {

/// A point of a speed profile.
struct SpeedPoint {
  double time_s = 0.0;
  double speed_hz = 0.0;  ///< turns a second, negative: backwards
};

/// How the shaft turns. Angles in turns, times in seconds.
struct MotionConfig {
  MotionKind kind = MotionKind::constant;
  double frequency_hz = 0.05;          ///< constant, ripple: mean speed; negative turns backwards
  std::optional<double> reference_hz;  ///< the frequency that firmware gets; absent: frequency_hz
  std::optional<double> reverse_at_s;  ///< constant, ripple: from here on the direction is opposite
  double ripple_amplitude = 0.0;       ///< ripple: speed = frequency (1 + amplitude sin(2 pi hz t))
  double ripple_hz = 0.0;
  uint64_t seed = 0;          ///< shuffled, walk
  double step_turns = 0.0;    ///< walk: standard deviation of one sample's step
  double centre_turns = 0.0;  ///< swing: centre + amplitude sin(2 pi hz t)
  double amplitude_turns = 0.0;
  double swing_hz = 0.0;
  /// profile: not empty, from 0 s on with rising times; straight lines between the points, and the
  /// last speed for ever.
  std::vector<SpeedPoint> speeds;
};

enum class Channel { u, v };

/// Adds amplitude a1 sin(order theta + phase) to U, or amplitude a2 cos(order theta + phase) to V.
/// theta without beta, the form that gives the CSFN paper's 74.17 degrees.
struct Harmonic {
  Channel channel = Channel::u;
  int order = 2;
  double amplitude = 0.0;  ///< relative to the channel's own amplitude
  double phase_rad = 0.0;
};

/// White Gaussian noise, independent in the two channels.
struct NoiseConfig {
  double sigma = 0.0;  ///< standard deviation in units of full scale, both channels
  double peak = 0.0;  ///< or the SoC paper's section 4.1.2: scaled so that its largest value within
                      ///< the record is peak times the channel's amplitude
  uint64_t record_samples = 100000;
  uint64_t seed = 0;
};

/// The SoC paper's Eq (22): each channel's frequency has a separate random error at every sample,
/// normalised to its peak within the record. The phase is f (1 + scale g(k) / max|g|) times the
/// time in seconds. So the phase error grows with time, and the two channels see different angles.
struct SpeedDisturbanceConfig {
  double scale = 0.0;
  uint64_t record_samples = 100000;
  uint64_t seed = 0;
};

/// Parameters that move, as with temperature: p + rate c(t), where c(t) is the smaller of t and
/// until_s, or period_s / (2 pi) sin(2 pi t / period_s), whose steepest slope is 1. Amplitudes and
/// offsets by parts of the channel's amplitude at 0 s (an offset may be 0), beta in radians.
struct DriftConfig {
  double a1 = 0.0, a2 = 0.0, b1 = 0.0, b2 = 0.0, beta = 0.0;  ///< rates, 1/s and rad/s
  std::optional<double> until_s, period_s;                    ///< one of them where a rate is not 0

  /// c(t) in seconds; 0 without until_s and period_s.
  double course(double t_seconds) const;
  /// The largest |c(t)|.
  double extent_s() const;
};

/// Everything a described signal consists of. The defaults are the SoC paper's Eq (21).
struct SignalConfig {
  std::string name = "soc_eq21";
  std::string origin;
  double a1 = 0.6079, a2 = 0.6228;     ///< amplitudes, full scale = 1; all at 0 s if they drift
  double b1 = 0.1336, b2 = 0.1831;     ///< offsets
  double beta = 0.0629, phi = 0.0876;  ///< rad
  double sample_rate_hz = 250.0;
  std::optional<uint64_t> samples;  ///< the source ends after that many; absent: never
  int adc_bits = 32;
  MotionConfig motion;
  DriftConfig drift;
  std::vector<Harmonic> harmonics;
  NoiseConfig noise;
  SpeedDisturbanceConfig speed_disturbance;
};

/// What the sources' users see of it.
Description describe(const SignalConfig& config);

}  // namespace capsoc::sensor
