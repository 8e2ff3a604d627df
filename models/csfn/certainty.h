// What an identification vouches for: intervals of the parameters and a bound of the angle.
#pragma once

#include "csfn/distance_fit.h"
#include "csfn/samples.h"
#include "csfn/structure.h"

namespace capsoc::csfn {

/// Half widths of the confidence intervals, in the units of the parameters.
struct Intervals {
  double a1 = 0, a2 = 0, b1 = 0, b2 = 0, beta = 0;
  double confidence = 0;
};

/// Largest error of the calibrated angle over the whole turn against U = a1 sin(theta) + b1,
/// radians. The noise of the single sample that is calibrated later is not in it, nor is a single
/// harmonic whose effect is along the curve: no test of the samples' distances sees that.
struct AngleBound {
  double total = 0;       ///< the sum of what follows
  double noise = 0;       ///< exceeded in one record of a thousand
  double method = 0;      ///< by how much the answer's angle differs from the distance fit's
  double harmonics = 0;   ///< of harmonics that are too small to be found
  double resolution = 0;  ///< of the converter or of the arithmetic
};

constexpr double bound_confidence = 0.999;  ///< of the bound's noise

/// What the bound takes for the angle's error in units of the harmonics' amplitude in the radius:
/// meant for harmonics of several orders at any phase (docs/fitting.md). A single one can exceed
/// it.
constexpr double angle_by_amplitude = 6;

/// What the certainty follows from.
struct Evidence {
  Parameters answer;  ///< of the method that was asked for
  DistanceFit fit;
  Structure structure;
  double count = 0;       ///< samples
  double resolution = 0;  ///< the error that a sample has however often it is taken, its unit
  /// Samples that are the same as another, as a part of all: they say nothing about rounding.
  double repeated = 0;
};

/// Student's interval of the distance fit, about the answer: widened by the answer's difference
/// from that fit, by the resolution, and by harmonics if they were found.
Intervals intervals_of(const Evidence& evidence, double confidence);

AngleBound bound_of(const Evidence& evidence);

}  // namespace capsoc::csfn
