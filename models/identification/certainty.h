// What an identification guarantees: intervals of the parameters and a bound of the angle.
#pragma once

#include "identification/coverage.h"
#include "identification/distance_fit.h"
#include "identification/samples.h"
#include "identification/structure.h"

namespace capsoc::identification {

/// Half widths of the confidence intervals, in the units of the parameters.
struct Intervals {
  double a1 = 0, a2 = 0, b1 = 0, b2 = 0, beta = 0;
  double confidence = 0;
};

/// Largest error of the calibrated angle against U = a1 sin(theta) + b1, radians, over the whole
/// turn or over a part of it. The noise of the single sample that is calibrated later is not in it,
/// nor is a single harmonic whose effect is along the curve: no test of the samples' distances sees
/// that.
struct AngleError {
  double total = 0;       ///< parameters and harmonics
  double parameters = 0;  ///< the sum of noise, method, drift and resolution
  double noise = 0;       ///< exceeded in one record of ten thousand, at any angle
  double method = 0;      ///< by how much the answer's angle differs from the distance fit's
  double drift = 0;       ///< of the sensor while it was recorded
  double harmonics = 0;   ///< of harmonics that are too small to be found
  double resolution = 0;  ///< of the converter or of the arithmetic
};

struct AngleBound : AngleError {
  AngleError arc;            ///< over the part of the turn that the samples cover
  double arc_degrees = 360;  ///< the size of that part
};

constexpr double bound_confidence = 0.9999;  ///< of the bound's noise

/// What the bound takes for the angle's error in units of the harmonics' amplitude in the radius:
/// meant for harmonics of several orders at any phase (docs/explanation/fitting.md). A single one
/// can exceed it.
constexpr double angle_by_amplitude = 6;

/// What the certainty follows from.
struct Evidence {
  Parameters answer;  ///< of the method that was asked for
  DistanceFit fit;
  /// Of the ellipse's change (circle_plane.h), with what correlation of the noise does to it.
  Eigen::Matrix<double, 5, 5> covariance = Eigen::Matrix<double, 5, 5>::Zero();
  double freedom = 0;  ///< degrees of freedom of it
  Structure structure;
  Coverage coverage;
  double drift = 0;       ///< of the angle, radians
  double count = 0;       ///< samples
  double resolution = 0;  ///< the error that a sample has however often it is taken, its unit
  /// Samples that are the same as another, as a part of all: they say nothing about rounding.
  double repeated = 0;
};

/// Student's interval of the distance fit, about the answer: widened by the answer's difference
/// from that fit, by the resolution, and by harmonics if they were found.
Intervals intervals_of(const Evidence& evidence, double confidence);

AngleBound bound_of(const Evidence& evidence);

}  // namespace capsoc::identification
