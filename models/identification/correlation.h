// Whether the noise of a record continues from one sample to the next, and what that does to a fit.
#pragma once

#include <vector>

#include "identification/distance_fit.h"
#include "identification/scores.h"
#include "identification/structure.h"

namespace capsoc::identification {

/// Noise as a sum of independent parts, each of which forgets exponentially; the same and
/// independent in both channels. White noise, autoregressive noise, and both together are such
/// sums; 1/f noise is one over any range of times.
struct NoiseCorrelation {
  struct Part {
    double variance = 0;  ///< unit of the samples, squared
    double samples = 0;   ///< after which exp(-1) of it is left
  };
  bool found = false;
  double white = 0;  ///< variance without a memory
  std::vector<Part> parts;
  /// Variance of what remembers for longer than a fortieth of the record, unit squared: how much
  /// slower it gets the record does not tell. Not among `parts`; 0 unless it is significant.
  double slow = 0;
  /// Noise of short and of long memories alike, as 1/f noise is: there may be longer ones than
  /// those that the record shows.
  bool of_all_memories = false;
  /// Correlation of samples that follow each other.
  double of_neighbours() const;
};

/// From the products of distances that are some samples apart, seen along their normals: distances
/// of a quarter turn apart say nothing about each other. The distances are those that the terms of
/// `structure` leave; what these terms took of the noise is put back.
NoiseCorrelation correlation_of(const Channel& u, const Channel& v, const DistanceFit& fit,
                                const Scores& scores, const Structure& structure);

/// Covariance of the scores' sum for such noise.
ScoreMatrix covariance_of_sums(const Channel& u, const Channel& v, const CirclePlane& plane,
                               const NoiseCorrelation& noise);

}  // namespace capsoc::identification
