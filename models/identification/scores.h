// The sums over a record that every test of its distances works on, from one pass.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "identification/distance_fit.h"
#include "identification/noise_expectation.h"
#include "identification/samples.h"

namespace capsoc::identification {

/// Derivatives of the radius by its Fourier terms of the orders 0 .. 8: the first five are the
/// ellipse's own.
constexpr int score_terms = 2 * harmonic_orders + 1;
constexpr int ellipse_terms = 2 * fit_orders + 1;
using ScoreVector = Eigen::Matrix<double, score_terms, 1>;
using ScoreMatrix = Eigen::Matrix<double, score_terms, score_terms>;

/// One sample seen from a fitted ellipse.
struct SampleScore {
  ScoreVector shape;          ///< derivatives of the distance, unit of the samples
  double distance;            ///< to first order, unit of the samples
  double normal_u, normal_v;  ///< direction of the distance, of length 1
};
SampleScore score_at(const CirclePlane& plane, double u, double v);

/// Consecutive samples of a record.
struct ScoreBlock {
  ScoreMatrix information = ScoreMatrix::Zero();  ///< sum of shape shape^T
  ScoreVector sum = ScoreVector::Zero();  ///< of shape distance, less what noise makes of it
};

/// Distances in units of the noise, cubed less three times themselves, times 1 and the two parts of
/// the normal: 0 on the average where noise is symmetric. `square`: the variances of these sums for
/// normal noise.
struct Asymmetry {
  std::array<double, 3> sum{}, square{};
};

struct Scores {
  std::vector<ScoreBlock> blocks;  ///< of equal numbers of samples, in the record's order
  ScoreMatrix information = ScoreMatrix::Zero();
  ScoreVector sum = ScoreVector::Zero();
  double square = 0;  ///< sum of the squares of the distances
  double count = 0;
  Asymmetry asymmetry;
};

/// At most 48 blocks.
Scores scores_of(const Channel& u, const Channel& v, const DistanceFit& fit);

}  // namespace capsoc::identification
