// Records of a few angles with many samples each: indexing tables, steppers, sampling that is
// locked to the turn.
#pragma once

#include "identification/distance_fit.h"
#include "identification/samples.h"
#include "identification/scores.h"

namespace capsoc::identification {

/// The distinct angles of a record, and what they tell: the scatter within them is noise alone
/// (pure error), that between them contains what no ellipse explains (lack of fit).
struct Positions {
  int count = 0;           ///< distinct angles; 0: the samples are not in groups
  double between = 0;      ///< squares of the positions' mean distances, a sample, unit squared
  double lack_of_fit = 1;  ///< mean square between them over that within them
  double probability = 1;  ///< that noise alone leaves such a ratio
  /// Noise alone does not explain how the positions lie about the ellipse: each counts as one.
  bool scattered() const { return probability < 0.01 && lack_of_fit > 1; }
};

/// Groups that are narrower than the gaps between them, five at least, three samples each on the
/// average. One pass over the samples and one for each group's sums.
Positions positions_of(const Channel& u, const Channel& v, const DistanceFit& fit);

/// One score for each position: the mean of its samples' scores.
Scores of_means(const Scores& scores, const Positions& positions);

}  // namespace capsoc::identification
