// The error of the calibrated angle over the angle, from a recorded true angle: what the
// coprocessor's harmonic correction takes off (docs/reference/coprocessor.md). No motion is
// assumed.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "identification/samples.h"

namespace capsoc::identification {

constexpr int error_nodes = 128;         ///< of the coprocessor's table
constexpr int highest_error_order = 10;  ///< as firmware/apps/harmonics/error_table.h
constexpr int error_folds = 5;           ///< of the cross-validation

/// Of samples that the curve was not fitted to, about their mean, radians.
struct HeldOutError {
  double rms = 0;
  double largest = 0;
};

struct ErrorCurve {
  bool identified = false;
  /// One sentence: how it was validated, or why there is no table.
  std::string reason;
  int order = 0;  ///< highest order of the angle in it, at most highest_error_order
  /// Angle of the parameters less the true one, radians: the mean, then cosine and sine of each
  /// order of the angle of the parameters. 2 order + 1 terms.
  std::vector<double> terms;
  /// The same as the coprocessor's table has it, 2^-24 turn, at angles of 1/128 turn.
  std::array<int32_t, error_nodes> nodes{};
  bool reversed = false;  ///< the true angle counts the other way round
  /// Argument of channel U's sine where the recorded angle is 0, radians. It is taken off if it is
  /// beyond own_zero; below that it is an error of the angle and in the table.
  double zero = 0;
  bool by_turns = false;  ///< the folds are consecutive turns; otherwise sectors of 4 degrees
  HeldOutError before, after;
};

/// Radians; as `capsoc run` takes a recorded angle (metrics/truth_alignment.h).
constexpr double own_zero = 10 * 3.14159265358979323846 / 180;

/// `truth` in radians, one angle a sample; samples whose places are in `left_out` (ascending) are
/// not used. The number of orders is the one with the least error of held-out samples. None are
/// identified where samples are too few, leave a gap, or where held-out samples do not gain.
ErrorCurve error_curve_of(const Samples& samples, const Eigen::ArrayXd& truth,
                          const Parameters& parameters, const std::vector<Eigen::Index>& left_out);

/// The curve's value at an angle of the parameters, radians.
double error_at(const ErrorCurve& curve, double theta);

}  // namespace capsoc::identification
