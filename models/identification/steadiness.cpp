#include "identification/steadiness.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/constants.h"
#include "identification/angle_change.h"
#include "identification/circle_plane.h"
#include "identification/distributions.h"
#include "identification/linear_algebra.h"

namespace capsoc::identification {
namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

constexpr int tested_shapes = 3;  ///< cos(pi j t), j = 1 .. tested_shapes
constexpr int finest_shapes = 12;
constexpr int trend_terms = tested_shapes * ellipse_terms;
constexpr double fewest_samples_a_term = 6;
/// A trend of which the terms without time take up all but this part is not looked at.
constexpr double least_trend_share = 0.1;

/// Sums over the blocks of the trends' terms.
struct TrendSums {
  explicit TrendSums(int shapes)
      : information(Matrix::Zero(shapes * ellipse_terms, shapes * ellipse_terms)),
        mixed(Matrix::Zero(shapes * ellipse_terms, score_terms)),
        covariance(information),
        mixed_covariance(mixed),
        sum(Vector::Zero(shapes * ellipse_terms)) {}
  Matrix information, mixed, covariance, mixed_covariance;
  Vector sum;
};

double trend_at(int shape, double time) {
  return std::cos(pi * (shape + 1) * time);
}

/// inflation: the covariance of the sums of information A is (A R + R^T A)/2.
TrendSums trend_sums_of(const Scores& scores, const ScoreVector& terms,
                        const ScoreMatrix& inflation, int shapes) {
  TrendSums sums(shapes);
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

/// The trends that the sums tell, of which some combinations may be the terms' without time.
struct Trends {
  Matrix basis;    ///< of those that are not
  Vector weights;  ///< their information
  bool known() const { return weights.size() > 0; }
  Vector of(const Vector& sum) const {
    return basis * Vector((basis.transpose() * sum).cwiseQuotient(weights));
  }
};

Trends trends_in(const TrendSums& sums, const ScoreMatrix& inverse) {
  const SymmetricEigen eigen =
      eigen_of_symmetric(Matrix(sums.information - sums.mixed * inverse * sums.mixed.transpose()));
  if (!eigen.found) return {};
  const double typical = sums.information.diagonal().mean();
  const auto kept = static_cast<int>((eigen.values.array() > least_trend_share * typical).count());
  return {eigen.vectors.rightCols(kept), eigen.values.tail(kept)};
}

/// By how much the parameters and the angle change with these trends about `mean`, which robust
/// fits are not at.
void measure(const Vector& trends, const Change& mean, const Parameters& p, SensorDrift& drift) {
  constexpr int times = 64;
  const auto shapes = static_cast<int>(trends.size() / ellipse_terms);
  const auto by = parameters_by_change(p);
  Eigen::Matrix<double, ellipse_terms, 1> least, largest;
  least.setConstant(HUGE_VAL);
  largest.setConstant(-HUGE_VAL);
  double angle = 0;
  for (int i = 0; i <= times; ++i) {
    Change change = mean;
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

/// The change as the first terms of its series tell it; none: the record is too short for them.
std::optional<SensorDrift> departure(const Scores& scores, const DistanceFit& fit,
                                     const Structure& structure, int shapes) {
  if (scores.count < fewest_samples_a_term * shapes * ellipse_terms) return std::nullopt;
  const TrendSums sums = trend_sums_of(scores, structure.terms, ScoreMatrix::Identity(), shapes);
  const Trends trends = trends_in(sums, structure.inverse);
  if (!trends.known()) return std::nullopt;
  SensorDrift drift;
  measure(trends.of(sums.sum), structure.terms.head<ellipse_terms>(), fit.parameters, drift);
  return drift;
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
  const TrendSums sums = trend_sums_of(scores, structure.terms, inflation, tested_shapes);
  const Matrix without = sums.mixed * inverse;
  const ScoreMatrix whole =
      covariance == nullptr ? ScoreMatrix(variance * scores.information) : *covariance;
  const Matrix crossed = without * sums.mixed_covariance.transpose();
  const Matrix of_sums =
      sums.covariance - crossed - crossed.transpose() + without * whole * without.transpose();
  const Trends trends = trends_in(sums, inverse);
  if (!trends.known()) return drift;
  const auto kept = static_cast<int>(trends.weights.size());
  const Vector along = trends.basis.transpose() * sums.sum;
  const Matrix of_along = trends.basis.transpose() * of_sums * trends.basis;
  const double squares = along.dot(Vector(solve_symmetric(of_along, along)));
  drift.probability = f_tail(squares / kept, kept, scores.count - score_terms - kept);
  drift.found = drift.probability < drift_false_alarms;
  if (!drift.found) return drift;
  measure(trends.of(sums.sum), structure.terms.head<ellipse_terms>(), fit.parameters, drift);
  return drift;
}

void follow_drift(const Scores& scores, const DistanceFit& fit, const Structure& structure,
                  SensorDrift& drift) {
  constexpr double most_rest = 0.2, noise_widths = 3;
  const bool is_long = scores.count >= fewest_samples_a_term * finest_shapes * ellipse_terms;
  const int shapes = is_long ? finest_shapes : 2 * tested_shapes;
  const auto less = departure(scores, fit, structure, shapes / 2);
  const auto more = departure(scores, fit, structure, shapes);
  if (!less || !more) return;
  // The series has no end. Of a smooth change the terms from a number to twice that number have
  // half of the rest, so twice of what they add is allowed for.
  const double rest = std::max(more->angle - less->angle, 0.0);
  const double of_noise = noise_widths * fit.noise * CirclePlane(fit.parameters).largest_slope() *
                          std::sqrt(shapes * ellipse_terms / scores.count);
  drift.change = more->change;
  drift.angle = std::max(drift.angle, more->angle + 2 * rest);
  drift.followed = rest <= most_rest * less->angle + of_noise;
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
