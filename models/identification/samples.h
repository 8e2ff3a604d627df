// What the identifiers work on: two channels of samples and the five parameters, Eq (3) of the CSFN
// paper.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "base/result.h"

namespace capsoc::identification {

/// One channel, in any unit (full scale = 1 in this project). A std::vector<double> is passed as
/// Eigen::Map<const Eigen::ArrayXd>.
using Channel = Eigen::Ref<const Eigen::ArrayXd>;

/// A record, in the order in which it was taken.
struct Samples {
  Eigen::ArrayXd u;
  Eigen::ArrayXd v;
};

/// U = a1 sin(theta) + b1, V = a2 cos(theta + beta) + b2, Eq (3). Amplitudes and offsets in the
/// unit of the samples, beta in radians.
///
/// Identified from samples without their angles, the parameters are canonical: a1, a2 > 0 and
/// |beta| < pi/2. The set of points is the same for beta and for pi - beta turned the other way
/// round, so the handedness is not in these five numbers.
struct Parameters {
  double a1 = 0;
  double a2 = 0;
  double b1 = 0;
  double b2 = 0;
  double beta = 0;
};

/// Nothing when an ellipse can be identified from the samples; otherwise the sentence that says why
/// not. The causes are different lengths, fewer than five samples, a value that is not finite, a
/// single point, a channel that does not move, a straight line, fewer than five different points.
std::optional<Error> check_samples(const Channel& u, const Channel& v);

}  // namespace capsoc::identification
