// Records drawn from a seed, good and bad ones, whose sensor and angles are known.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "base/random.h"
#include "identification/calibration.h"
#include "identification/samples.h"

namespace capsoc::fit {

/// Of every table.
inline constexpr uint64_t seed = 2018;

enum class RecordKind {
  good,
  arc,
  tiny,
  offset,
  converter,
  outliers,
  clipped,
  harmonics,
  dead,
  constant,
  equal,
};
constexpr int record_kinds = 11;
const char* to_string(RecordKind kind);

struct DrawnRecord {
  RecordKind kind = RecordKind::good;
  identification::Samples samples;
  Eigen::ArrayXd theta;              ///< true angles, radians
  identification::Parameters truth;  ///< canonical; full scale = 1
  /// Relative to the amplitudes, order 2 to 5 of each channel: size and phase.
  std::array<identification::HarmonicTerm, 4> u{}, v{};
  double noise = 0;    ///< standard deviation of each channel
  double step = 0;     ///< of the converter; 0: none
  double outside = 0;  ///< part of the samples that are outliers
  int clipped = 0;     ///< samples that were clipped
};

/// Amplitudes 0.1 .. 0.9, ratio 0.5 .. 2, offsets to 0.3, |beta| to 1 rad, noise 1e-4 .. 3e-2 of
/// the smaller amplitude, 20 .. 20,000 samples (both spread evenly over their logarithms) at random
/// angles, and what the kind has in addition.
DrawnRecord draw_record(Random& random, RecordKind kind);

/// The same with the noise (relative to the smaller amplitude) and the number of samples given.
DrawnRecord draw_good_record(Random& random, double noise, Eigen::Index count);

/// Without noise; harmonics of the orders least .. highest, within 2 .. 5, of amplitudes to 0.001
/// at any phase, in both channels or in U alone.
DrawnRecord draw_harmonic_record(Random& random, int least, int highest, bool both,
                                 Eigen::Index count);

/// Of the sensor without noise, at the angle (radians).
identification::Point point_of(const DrawnRecord& record, double theta);

/// Largest error of the angle over the turn, radians, with the parameters given.
double angle_error_of(const DrawnRecord& record, const identification::Parameters& parameters);

/// One of the standard normal distribution.
double normal(Random& random);

}  // namespace capsoc::fit
