// How the samples lie about the identified curve.
#pragma once

#include <array>

#include "identification/network.h"

namespace capsoc::identification {

/// Distances to the curve of a fitted ellipse, to first order, and how they vary over the turn.
struct Scatter {
  double noise = 0;               ///< rms distance, unit of the samples
  double largest = 0;             ///< of |1 - Y|
  double rms = 0;                 ///< of 1 - Y
  std::array<double, 5> order{};  ///< |mean of (1 - Y) e^(i m theta)| for m = 0 .. 4
  /// Mean of e^(i step), step the angle from one sample to the next: length and argument.
  double step_length = 0, step = 0;
};
Scatter scatter_of(const Channel& u, const Channel& v, const Parameters& parameters);

}  // namespace capsoc::identification
