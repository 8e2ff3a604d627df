// The distance of samples from an ellipse, exact for thin ones as well.
#pragma once

#include "identification/samples.h"

namespace capsoc::identification {

/// Distances from one ellipse. The axes are computed once.
class EllipseDistance {
 public:
  /// Parameters with a1, a2 > 0 and |beta| < pi/2, unit of the samples.
  explicit EllipseDistance(const Parameters& parameters);

  /// Distance of a sample, unit of the samples, negative inside the ellipse.
  double at(double u, double v) const;

 private:
  double centre_u_, centre_v_;
  double major_, minor_;  ///< half axes
  double cosine_, sine_;  ///< direction of the major axis in the plane of the samples
};

}  // namespace capsoc::identification
