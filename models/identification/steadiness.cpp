#include "identification/steadiness.h"

#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "identification/angle_change.h"
#include "identification/circle_plane.h"
#include "identification/distributions.h"
#include "identification/linear_algebra.h"

namespace capsoc::identification {
namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

constexpr int shapes = 3;  ///< cos(pi j t), j = 1 .. shapes
constexpr int trend_terms = shapes * ellipse_terms;
constexpr double fewest_samples_a_term = 6;
/// A trend of which the terms without time take up all but this part is not looked at.
constexpr double least_trend_share = 0.1;

/// Sums over the blocks of the trends' terms.
struct TrendSums {
  Matrix information = Matrix::Zero(trend_terms, trend_terms);
  Matrix mixed = Matrix::Zero(trend_terms, score_terms);
  Matrix covariance = Matrix::Zero(trend_terms, trend_terms);
  Matrix mixed_covariance = Matrix::Zero(trend_terms, score_terms);
  Vector sum = Vector::Zero(trend_terms);
};

double trend_at(int shape, double time) {
  return std::cos(pi * (shape + 1) * time);
}

/// inflation: the covariance of the sums of information A is (A R + R^T A)/2.
TrendSums trend_sums_of(const Scores& scores, const ScoreVector& terms,
                        const ScoreMatrix& inflation) {
  TrendSums sums;
  const auto blocks = static_cast<double>(scores.blocks.size());
  for (std::size_t b = 0; b < scores.blocks.size(); ++b) {
    const ScoreBlock& block = scores.blocks[b];
    const double time = (static_cast<double>(b) + 0.5) / blocks;
    const ScoreMatrix scaled = block.information * inflation;
    const ScoreMatrix covariance = (scaled + scaled.transpose()) / 2;
    const ScoreVector rest = block.sum - block.information * terms;
    for (int j = 0; j < shapes; ++j) {
      const double one = trend_at(j, time);
      const int row = j * ellipse_terms;
      sums.sum.segment(row, ellipse_terms) += one * rest.head(ellipse_terms);
      sums.mixed.middleRows(row, ellipse_terms) += one * block.information.topRows(ellipse_terms);
      sums.mixed_covariance.middleRows(row, ellipse_terms) +=
          one * covariance.topRows(ellipse_terms);
      for (int k = 0; k < shapes; ++k) {
        const double both = one * trend_at(k, time);
        const int column = k * ellipse_terms;
        sums.information.block(row, column, ellipse_terms, ellipse_terms) +=
            both * block.information.topLeftCorner(ellipse_terms, ellipse_terms);
        sums.covariance.block(row, column, ellipse_terms, ellipse_terms) +=
            both * covariance.topLeftCorner(ellipse_terms, ellipse_terms);
      }
    }
  }
  return sums;
}

/// By how much the parameters and the angle change with these trends.
void measure(const Vector& trends, const Parameters& p, SensorDrift& drift) {
  constexpr int times = 32;
  const auto by = parameters_by_change(p);
  Eigen::Matrix<double, ellipse_terms, 1> least, largest;
  least.setConstant(HUGE_VAL);
  largest.setConstant(-HUGE_VAL);
  double angle = 0;
  for (int i = 0; i <= times; ++i) {
    Change change = Change::Zero();
    for (int j = 0; j < shapes; ++j)
      change += trend_at(j, static_cast<double>(i) / times) *
                trends.segment(j * ellipse_terms, ellipse_terms);
    const Eigen::Matrix<double, ellipse_terms, 1> moved = by * change;
    least = least.cwiseMin(moved);
    largest = largest.cwiseMax(moved);
    angle = std::max(angle, largest_angle_of(change));
  }
  const Eigen::Matrix<double, ellipse_terms, 1> range = largest - least;
  drift.change = {range[0], range[1], range[2], range[3], range[4]};
  drift.angle = angle;
}

}  // namespace

SensorDrift sensor_drift_of(const Scores& scores, const DistanceFit& fit,
                            const Structure& structure, const ScoreMatrix* covariance) {
  SensorDrift drift;
  if (scores.count < fewest_samples_a_term * trend_terms || scores.blocks.size() < 12) return drift;
  const ScoreMatrix& inverse = structure.inverse;
  const double variance = fit.noise * fit.noise;
  const ScoreMatrix inflation = covariance == nullptr
                                    ? ScoreMatrix(variance * ScoreMatrix::Identity())
                                    : ScoreMatrix(inverse * *covariance);
  const TrendSums sums = trend_sums_of(scores, structure.terms, inflation);
  const Matrix without = sums.mixed * inverse;
  const Matrix information = sums.information - without * sums.mixed.transpose();
  const ScoreMatrix whole =
      covariance == nullptr ? ScoreMatrix(variance * scores.information) : *covariance;
  const Matrix crossed = without * sums.mixed_covariance.transpose();
  const Matrix of_sums =
      sums.covariance - crossed - crossed.transpose() + without * whole * without.transpose();
  const SymmetricEigen eigen = eigen_of_symmetric(information);
  if (!eigen.found) return drift;
  const double typical = sums.information.diagonal().mean();
  const auto kept = static_cast<int>((eigen.values.array() > least_trend_share * typical).count());
  if (kept == 0) return drift;
  const Matrix basis = eigen.vectors.rightCols(kept);
  const Vector along = basis.transpose() * sums.sum;
  const Matrix of_along = basis.transpose() * of_sums * basis;
  const double squares = along.dot(Vector(solve_symmetric(of_along, along)));
  drift.probability = f_tail(squares / kept, kept, scores.count - score_terms - kept);
  drift.found = drift.probability < drift_false_alarms;
  if (!drift.found) return drift;
  const Vector trends = basis * along.cwiseQuotient(eigen.values.tail(kept));
  measure(trends, fit.parameters, drift);
  return drift;
}

OneSided one_sided(const Scores& scores, double memory, double relative_noise) {
  OneSided result;
  double largest = 0;
  for (std::size_t k = 0; k < scores.asymmetry.sum.size(); ++k) {
    const double square = scores.asymmetry.square[k];
    if (!(square > 0)) continue;
    const double excess = std::abs(scores.asymmetry.sum[k]) - relative_noise * scores.count;
    const double z = excess / std::sqrt(square * memory);
    if (z <= largest) continue;
    largest = z;
    result.skewness = scores.asymmetry.sum[k] / scores.count;
  }
  const auto tests = static_cast<double>(scores.asymmetry.sum.size());
  result.probability = std::min(1.0, tests * std::erfc(largest / std::sqrt(2.0)));
  result.found = result.probability < one_sided_false_alarms;
  return result;
}

}  // namespace capsoc::identification
