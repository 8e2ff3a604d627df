// Whether the sensor stayed the same while it was recorded, and whether its noise is symmetric.
#pragma once

#include "identification/scores.h"
#include "identification/structure.h"

namespace capsoc::identification {

/// Records with noise alone in which a drift, or an asymmetry, is found.
constexpr double drift_false_alarms = 1e-3, one_sided_false_alarms = 4e-3;

/// Slow changes of the ellipse over the record: its five terms times cos(pi j t), j = 1 .. 3, t
/// from 0 to 1 over the record.
struct SensorDrift {
  bool found = false;
  double probability = 1;
  /// By how much each parameter changes (largest less smallest), in its unit.
  Parameters change;
  double angle = 0;  ///< what the sensor's departure from its mean does to the angle, radians
  /// `angle` is the whole of it: more terms, up to cos(12 pi t), find hardly more. They do of a
  /// change within a small part of the record.
  bool followed = false;
};

/// F test of what the structure's terms leave. With `covariance`, that of the scores' sum, noise is
/// not taken as independent.
SensorDrift sensor_drift_of(const Scores& scores, const DistanceFit& fit,
                            const Structure& structure, const ScoreMatrix* covariance);

/// Sets the drift's change, and its angle if that is larger now, and whether they are the whole.
void follow_drift(const Scores& scores, const DistanceFit& fit, const Structure& structure,
                  SensorDrift& drift);

/// Noise that reaches farther to one side than to the other: outliers that lie within the noise.
struct OneSided {
  bool found = false;
  double probability = 1;
  double skewness = 0;  ///< third moment of the distances in units of the noise
};

/// z tests of the third moments; `memory`: by how much correlated noise widens them, in variance.
/// relative_noise: in units of the smaller half axis; the ellipse's curvature makes that much of
/// noise that is symmetric.
OneSided one_sided(const Scores& scores, double memory, double relative_noise);

}  // namespace capsoc::identification
