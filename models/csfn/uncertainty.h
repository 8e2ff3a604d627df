// How far the identified parameters can be trusted.
#pragma once

#include <array>

#include "csfn/network.h"

namespace capsoc::csfn {

/// Standard errors of a1, a2, b1, b2 (unit of the samples) and beta (radians) at the minimum of the
/// network's loss, from the information that the samples carry: H^-1 S H^-1 with H = J^T J the
/// (Fisher) information of the residuals and S their scatter in it. S rather than H times one
/// variance, because noise equal in U and V is not equal in 1 - Y: it is divided by a local radius.
/// Noise must be independent from sample to sample. Of a long record 16,384 samples are looked at.
std::array<double, 5> standard_errors(const Channel& u, const Channel& v,
                                      const Parameters& parameters);

/// Number of standard deviations that hold the given share of a normal distribution, share in
/// (0, 1): 0.95 gives 1.96.
double normal_quantile(double share);

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

}  // namespace capsoc::csfn
