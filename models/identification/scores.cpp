#include "identification/scores.h"

#include <algorithm>
#include <cmath>

namespace capsoc::identification {
namespace {

constexpr Eigen::Index most_blocks = 48;

void add_asymmetry(const SampleScore& seen, double noise, Asymmetry& asymmetry) {
  const double relative = seen.distance / noise;
  const double third = relative * (relative * relative - 3);
  constexpr double of_third = 6;  // variance of the third Hermite polynomial
  const std::array<double, 3> part = {1, seen.normal_u, seen.normal_v};
  for (std::size_t k = 0; k < part.size(); ++k) {
    asymmetry.sum[k] += third * part[k];
    asymmetry.square[k] += of_third * part[k] * part[k];
  }
}

}  // namespace

SampleScore score_at(const CirclePlane& plane, double u, double v) {
  const CirclePlane::Polar at = plane.at(u, v);
  const double slope = std::sqrt(plane.square_slope(at));
  const Eigen::Matrix2d& map = plane.map();
  return {shape_of<harmonic_orders>(at) / slope, (at.length - 1) / slope,
          (map(0, 0) * at.cosine + map(1, 0) * at.sine) / slope,
          (map(0, 1) * at.cosine + map(1, 1) * at.sine) / slope};
}

Scores scores_of(const Channel& u, const Channel& v, const DistanceFit& fit) {
  const CirclePlane plane(fit.parameters);
  const NoiseExpectation<harmonic_orders> expectation(plane, fit.noise);
  const Eigen::Index size = u.size(), blocks = std::min(most_blocks, size);
  const double noise = std::max(fit.noise, 1e-300);
  Scores scores;
  scores.count = static_cast<double>(size);
  for (Eigen::Index block = 0; block < blocks; ++block) {
    ScoreBlock sums;
    for (Eigen::Index i = size * block / blocks; i < size * (block + 1) / blocks; ++i) {
      const CirclePlane::Polar at = plane.at(u[i], v[i]);
      const SampleScore seen = score_at(plane, u[i], v[i]);
      sums.information.noalias() += seen.shape * seen.shape.transpose();
      sums.sum += seen.distance * seen.shape -
                  expectation.at(std::atan2(at.sine, at.cosine)).head<score_terms>();
      scores.square += seen.distance * seen.distance;
      add_asymmetry(seen, noise, scores.asymmetry);
    }
    scores.information += sums.information;
    scores.sum += sums.sum;
    scores.blocks.push_back(sums);
  }
  return scores;
}

}  // namespace capsoc::identification
