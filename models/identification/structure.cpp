#include "identification/structure.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "identification/circle_plane.h"
#include "identification/distributions.h"
#include "identification/linear_algebra.h"

namespace capsoc::identification {
namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

constexpr int first_order = fit_orders + 1;
/// Samples an order, at least: fewer at random angles leave gaps in which an order is not known.
constexpr int samples_an_order = 6;
/// Squares that remain are at least this part of what the fit's noise leaves: of few samples the
/// orders can take more than there is.
constexpr double least_rest = 0.25;
/// A combination of orders of which the ellipse takes up all but this part is not tested.
constexpr double least_share = 0.02;

/// The orders' part of the sums once the ellipse has taken what it can.
struct Rest {
  Matrix information;
  Vector sum;
  Matrix by_ellipse;  ///< the ellipse's change for each of the orders' terms
  SymmetricEigen eigen;
};

Rest rest_of(const Scores& scores, int used) {
  const int more = used - ellipse_terms;
  const Matrix first = scores.information.topLeftCorner(ellipse_terms, ellipse_terms);
  const Matrix mixed = scores.information.block(0, ellipse_terms, ellipse_terms, more);
  Rest rest;
  rest.by_ellipse = solve_symmetric(first, mixed);
  rest.information = scores.information.block(ellipse_terms, ellipse_terms, more, more) -
                     mixed.transpose() * rest.by_ellipse;
  rest.sum = scores.sum.segment(ellipse_terms, more) -
             rest.by_ellipse.transpose() * scores.sum.head(ellipse_terms);
  rest.eigen = eigen_of_symmetric(rest.information);
  return rest;
}

/// Tests of each order and of those up to it, with all terms known.
void test_orders(const Scores& scores, int used, double noise, Structure& structure) {
  const Eigen::LLT<Matrix> factor(scores.information.topLeftCorner(used, used));
  if (factor.info() != Eigen::Success) {
    structure.last_order = 0;
    return;
  }
  // With the factor L the squares that each order explains, after those below it, are the squares
  // of L^-1 sum.
  const Vector explained = factor.matrixL().solve(scores.sum.head(used)).array().square();
  const Matrix inverse = factor.solve(Matrix::Identity(used, used));
  structure.terms.head(used) = factor.solve(scores.sum.head(used));
  structure.inverse.topLeftCorner(used, used) = inverse;
  const double freedom = scores.count - used;
  const double rest =
      std::max({scores.square - explained.sum(), least_rest * freedom * noise * noise, 1e-300});
  double joint = 0, largest = 0, least = 1;
  const int tests = 2 * (structure.last_order - first_order + 1) - 1;
  for (int order = first_order; order <= structure.last_order; ++order) {
    const int at = 2 * order - 1;
    const double one = explained[at] + explained[at + 1];
    joint += one;
    const double above = 2 * (order - first_order + 1);
    const double below = scores.count - 2 * order - 1;
    const double others =
        std::max(scores.square - explained.head(ellipse_terms).sum() - joint, rest);
    least = std::min({least, f_tail(one / 2 / (rest / freedom), 2, freedom),
                      f_tail(joint / above / (others / below), above, below)});
    const double power = structure.terms.segment(at, 2).squaredNorm();
    if (power > largest) structure.order = order;
    largest = std::max(largest, power);
  }
  const auto harmonics = used - ellipse_terms;
  structure.directions = harmonics;
  structure.amplitude = structure.terms.segment(ellipse_terms, harmonics).norm();
  structure.noise = std::sqrt(rest / freedom * inverse.diagonal().tail(harmonics).sum());
  structure.probability = std::min(1.0, least * tests);
}

/// The same against noise whose covariance of the sums is known.
void test_orders_of_correlated(const Scores& scores, int used, const ScoreMatrix& covariance,
                               Structure& structure) {
  const Matrix information = scores.information.topLeftCorner(used, used);
  const Matrix inverse = solve_symmetric(information, Matrix::Identity(used, used));
  const Matrix of_terms = inverse * covariance.topLeftCorner(used, used) * inverse;
  structure.terms.head(used) = inverse * scores.sum.head(used);
  structure.inverse.topLeftCorner(used, used) = inverse;
  double largest = 0, least = 1;
  const int orders = structure.last_order - first_order + 1;
  const auto tail = [&](int at, int count) {
    const Vector some = structure.terms.segment(at, count);
    const Matrix block = of_terms.block(at, at, count, count);
    return f_tail(some.dot(Vector(solve_symmetric(block, some))) / count, count, scores.count);
  };
  for (int order = first_order; order <= structure.last_order; ++order) {
    const int at = 2 * order - 1;
    least = std::min(least, tail(at, 2));
    const double power = structure.terms.segment(at, 2).squaredNorm();
    if (power > largest) structure.order = order;
    largest = std::max(largest, power);
  }
  const auto harmonics = used - ellipse_terms;
  least = std::min(least, tail(ellipse_terms, harmonics));
  structure.directions = harmonics;
  structure.amplitude = structure.terms.segment(ellipse_terms, harmonics).norm();
  structure.noise = std::sqrt(of_terms.diagonal().tail(harmonics).sum());
  structure.probability = std::min(1.0, least * (orders + 1));
}

/// One test of the combinations that the samples tell from an ellipse. What the others may be is
/// taken from those: all terms are of one size then.
void test_directions(const Scores& scores, const Rest& rest, int directions, double noise,
                     const ScoreMatrix* covariance, Structure& structure) {
  const auto more = static_cast<int>(rest.sum.size());
  structure.order = 0;
  structure.directions = directions;
  const Matrix kept = rest.eigen.vectors.rightCols(directions);
  const Vector values = rest.eigen.values.tail(directions);
  const Vector along = kept.transpose() * rest.sum;
  const Vector coefficients = along.cwiseQuotient(values);
  structure.terms.setZero();
  structure.terms.segment(ellipse_terms, more) = kept * coefficients;
  structure.terms.head(ellipse_terms) =
      -rest.by_ellipse * structure.terms.segment(ellipse_terms, more);
  const int size = ellipse_terms + more;
  Matrix basis = Matrix::Zero(size, ellipse_terms + directions);
  basis.topLeftCorner(ellipse_terms, ellipse_terms).setIdentity();
  basis.bottomRightCorner(more, directions) = kept;
  const Matrix reduced = basis.transpose() * scores.information.topLeftCorner(size, size) * basis;
  structure.inverse.topLeftCorner(size, size) =
      basis * Matrix(solve_symmetric(reduced, basis.transpose()));
  const double explained = along.dot(coefficients);
  double variance;
  if (covariance == nullptr) {
    const double freedom = std::max(scores.count - ellipse_terms - directions, 1.0);
    const double others =
        std::max({scores.square - explained, least_rest * freedom * noise * noise, 1e-300});
    variance = others / freedom;
    structure.probability = f_tail(explained / directions / variance, directions, freedom);
  } else {
    Matrix projection = Matrix::Zero(more, size);
    projection.leftCols(ellipse_terms) = -rest.by_ellipse.transpose();
    projection.rightCols(more).setIdentity();
    const Matrix of_sums = kept.transpose() * projection * covariance->topLeftCorner(size, size) *
                           projection.transpose() * kept;
    const double squares = along.dot(Vector(solve_symmetric(of_sums, along)));
    variance = (of_sums.diagonal().cwiseQuotient(values)).sum() / directions;
    structure.probability = f_tail(squares / directions, directions, scores.count);
  }
  const double scale = more / values.sum();
  structure.amplitude = std::sqrt(scale * explained);
  structure.noise = std::sqrt(scale * directions * variance);
  structure.leak = rest.by_ellipse * rest.by_ellipse.transpose() / more;
}

}  // namespace

Structure structure_of(const Scores& scores, const DistanceFit& fit, double resolution,
                       const ScoreMatrix* covariance) {
  Structure structure;
  structure.inverse.topLeftCorner(ellipse_terms, ellipse_terms) =
      solve_symmetric(scores.information.topLeftCorner(ellipse_terms, ellipse_terms),
                      Matrix::Identity(ellipse_terms, ellipse_terms));
  const auto count = static_cast<int>(std::min(scores.count, 1e9));
  structure.last_order = std::min(harmonic_orders, count / samples_an_order);
  if (structure.last_order < first_order) {
    structure.last_order = 0;
    return structure;
  }
  const int used = 2 * structure.last_order + 1;
  const Rest rest = rest_of(scores, used);
  const double typical =
      scores.information.diagonal().segment(ellipse_terms, used - ellipse_terms).mean();
  const auto directions =
      static_cast<int>((rest.eigen.values.array() > least_share * typical).count());
  if (!rest.eigen.found || directions == 0) {
    structure.last_order = 0;
    return structure;
  }
  if (directions < used - ellipse_terms)
    test_directions(scores, rest, directions, fit.noise, covariance, structure);
  else if (covariance == nullptr)
    test_orders(scores, used, fit.noise, structure);
  else
    test_orders_of_correlated(scores, used, *covariance, structure);
  const double slope = CirclePlane(fit.parameters).largest_slope();
  structure.found =
      structure.probability < structure_false_alarms && structure.amplitude > resolution * slope;
  return structure;
}

}  // namespace capsoc::identification
