#include "identification/error_curve.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include "base/constants.h"
#include "identification/calibration.h"
#include "identification/linear_algebra.h"
#include "identification/sentence.h"

namespace capsoc::identification {
namespace {

constexpr int most_terms = 2 * highest_error_order + 1;
constexpr double fewest_samples = 200;
/// Beyond this an order up to the tenth may do what it likes between the samples, degrees.
constexpr double largest_gap = 18;
/// Sectors of the turn that are held out together, in turn.
constexpr int sectors = 90;
/// The table's range, 2^-24 turn.
constexpr double largest_node = (1 << 19) - 1;

using Row = Eigen::Matrix<double, most_terms, 1>;
using Square = Eigen::Matrix<double, most_terms, most_terms>;

Row row_at(double theta) {
  Row row;
  row[0] = 1;
  const std::complex<double> step = std::polar(1.0, theta);
  std::complex<double> power = 1;
  for (int order = 1; order <= highest_error_order; ++order) {
    power *= step;
    row[2 * order - 1] = power.real();
    row[2 * order] = power.imag();
  }
  return row;
}

/// Sums of least squares.
struct Normal {
  Square left = Square::Zero();
  Row right = Row::Zero();
  double square = 0, count = 0;

  void add(const Row& row, double value) {
    // The lower half; by hand, for Eigen's rankUpdate() may allocate.
    for (Eigen::Index j = 0; j < row.size(); ++j)
      left.col(j).tail(row.size() - j) += row[j] * row.tail(row.size() - j);
    right += value * row;
    square += value * value;
    ++count;
  }
  void add(const Normal& other) {
    left += other.left;
    right += other.right;
    square += other.square;
    count += other.count;
  }
};

using Folds = std::array<Normal, error_folds>;

Eigen::VectorXd solve(const Normal& normal, int terms) {
  const Eigen::MatrixXd left =
      Eigen::MatrixXd(normal.left.selfadjointView<Eigen::Lower>()).topLeftCorner(terms, terms);
  return solve_symmetric(left, normal.right.head(terms));
}

Normal all_but(const Folds& folds, int left_out) {
  Normal sum;
  for (int fold = 0; fold < error_folds; ++fold)
    if (fold != left_out) sum.add(folds[static_cast<std::size_t>(fold)]);
  return sum;
}

/// Sum of squares that terms leave of the samples of a fold.
double rest_of(const Normal& fold, const Eigen::VectorXd& x) {
  const Eigen::Index terms = x.size();
  const Eigen::MatrixXd left =
      Eigen::MatrixXd(fold.left.selfadjointView<Eigen::Lower>()).topLeftCorner(terms, terms);
  return std::max(fold.square - 2 * x.dot(fold.right.head(terms)) + x.dot(left * x), 0.0);
}

/// The samples' angles, what they are wrong by, and in which fold they are.
struct Errors {
  Eigen::ArrayXd theta, error;
  std::vector<int> fold;
};

/// Argument of U's sine where `truth` is 0, by least squares.
double zero_of(const Channel& u, const Eigen::ArrayXd& truth) {
  Eigen::Matrix3d left = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (Eigen::Index i = 0; i < u.size(); ++i) {
    const Eigen::Vector3d row(1, std::sin(truth[i]), std::cos(truth[i]));
    left += row * row.transpose();
    right += u[i] * row;
  }
  const Eigen::VectorXd x = solve_symmetric(left, right);
  return std::atan2(x[2], x[1]);
}

double gap_of(Eigen::ArrayXd theta) {
  std::sort(theta.begin(), theta.end());
  double gap = theta[0] + two_pi - theta[theta.size() - 1];
  for (Eigen::Index i = 1; i < theta.size(); ++i) gap = std::max(gap, theta[i] - theta[i - 1]);
  return gap * degrees_per_radian;
}

/// Consecutive whole turns where the record has enough of them in order, otherwise sectors.
bool assign_folds(const Eigen::ArrayXd& truth, std::vector<int>& fold) {
  const auto count = static_cast<std::size_t>(truth.size());
  fold.resize(count);
  double path = 0, travel = 0;
  for (Eigen::Index i = 1; i < truth.size(); ++i) {
    const double step = wrapped(truth[i] - truth[i - 1]);
    path += step;
    travel += std::abs(step);
  }
  const double turns = std::abs(path) / two_pi;
  const bool by_turns = turns >= error_folds && std::abs(path) > 0.99 * travel;
  path = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    if (i > 0) path += wrapped(truth[at] - truth[at - 1]);
    const double turn = truth[at] / two_pi - std::floor(truth[at] / two_pi);
    fold[i] = by_turns
                  ? std::min(static_cast<int>(error_folds * std::floor(std::abs(path) / two_pi) /
                                              std::floor(turns)),
                             error_folds - 1)
                  : static_cast<int>(turn * sectors) % error_folds;
  }
  return by_turns;
}

HeldOutError held_out(const Errors& errors, const std::array<Eigen::VectorXd, error_folds>& terms) {
  HeldOutError error;
  for (Eigen::Index i = 0; i < errors.theta.size(); ++i) {
    const Eigen::VectorXd& x =
        terms[static_cast<std::size_t>(errors.fold[static_cast<std::size_t>(i)])];
    const double rest = errors.error[i] - row_at(errors.theta[i]).head(x.size()).dot(x);
    error.rms += rest * rest;
    error.largest = std::max(error.largest, std::abs(rest));
  }
  error.rms = std::sqrt(error.rms / static_cast<double>(errors.theta.size()));
  return error;
}

/// Squares that held-out samples keep, by fold.
std::array<double, error_folds> rests(const Folds& folds, int order) {
  std::array<double, error_folds> rest{};
  for (int fold = 0; fold < error_folds; ++fold)
    rest[static_cast<std::size_t>(fold)] =
        rest_of(folds[static_cast<std::size_t>(fold)], solve(all_but(folds, fold), 2 * order + 1));
  return rest;
}

double sum_of(const std::array<double, error_folds>& rest) {
  double sum = 0;
  for (const double square : rest) sum += square;
  return sum;
}

/// The coprocessor draws chords between its nodes: half of what they miss of an arc is added.
bool make_nodes(ErrorCurve& curve) {
  ErrorCurve larger = curve;
  for (int order = 1; order <= curve.order; ++order) {
    const double z = pi * order / error_nodes;
    for (int k = 2 * order - 1; k <= 2 * order; ++k)
      larger.terms[static_cast<std::size_t>(k)] *= 1 + z * z / 4;
  }
  for (int node = 0; node < error_nodes; ++node) {
    const double value = error_at(larger, two_pi * node / error_nodes) / two_pi * 0x1p24;
    if (!(std::abs(value) <= largest_node)) return false;
    curve.nodes[static_cast<std::size_t>(node)] = static_cast<int32_t>(std::lround(value));
  }
  return true;
}

Errors errors_of(const Samples& samples, const Eigen::ArrayXd& truth, const Parameters& parameters,
                 const std::vector<Eigen::Index>& left_out, ErrorCurve& curve) {
  const Eigen::Index count = samples.u.size() - static_cast<Eigen::Index>(left_out.size());
  Errors errors{Eigen::ArrayXd(count), Eigen::ArrayXd(count), {}};
  Eigen::ArrayXd true_angle(count), u(count);
  auto next = left_out.begin();
  std::complex<double> direct = 0, reversed = 0;
  for (Eigen::Index i = 0, k = 0; i < samples.u.size(); ++i) {
    if (next != left_out.end() && *next == i) {
      ++next;
      continue;
    }
    errors.theta[k] = angle_of(parameters, samples.u[i], samples.v[i]);
    true_angle[k] = truth[i];
    u[k] = samples.u[i];
    direct += std::polar(1.0, errors.theta[k] - truth[i]);
    reversed += std::polar(1.0, errors.theta[k] + truth[i]);
    ++k;
  }
  curve.reversed = std::abs(reversed) > std::abs(direct);
  if (curve.reversed) true_angle = -true_angle;
  curve.zero = zero_of(u, true_angle);
  const double taken_off = std::abs(curve.zero) > own_zero ? curve.zero : 0;
  for (Eigen::Index k = 0; k < count; ++k)
    errors.error[k] = wrapped(errors.theta[k] - true_angle[k] - taken_off);
  curve.by_turns = assign_folds(true_angle, errors.fold);
  return errors;
}

/// The order with the least squares of held-out samples; 0: none gains in every fold.
int best_order(const Folds& folds) {
  const auto before = rests(folds, 0);
  int best = 0;
  double least = sum_of(before);
  for (int order = 1; order <= highest_error_order; ++order) {
    const auto rest = rests(folds, order);
    bool gains = true;
    for (std::size_t fold = 0; fold < error_folds; ++fold)
      gains = gains && rest[fold] < before[fold];
    if (!gains || sum_of(rest) >= least) continue;
    best = order;
    least = sum_of(rest);
  }
  return best;
}

}  // namespace

double error_at(const ErrorCurve& curve, double theta) {
  const Row row = row_at(theta);
  double sum = 0;
  for (std::size_t k = 0; k < curve.terms.size(); ++k)
    sum += curve.terms[k] * row[static_cast<Eigen::Index>(k)];
  return sum;
}

ErrorCurve error_curve_of(const Samples& samples, const Eigen::ArrayXd& truth,
                          const Parameters& parameters, const std::vector<Eigen::Index>& left_out) {
  ErrorCurve curve;
  const auto count = static_cast<double>(samples.u.size()) - static_cast<double>(left_out.size());
  if (count < fewest_samples) {
    curve.reason = text("%.0f samples are too few for an error table: record at least %.0f", count,
                        fewest_samples);
    return curve;
  }
  const Errors errors = errors_of(samples, truth, parameters, left_out, curve);
  if (const double gap = gap_of(errors.theta); gap > largest_gap) {
    curve.reason = text(
        "the samples leave %.0f degrees of the turn without a true angle (at most %.0f): record "
        "whole turns",
        gap, largest_gap);
    return curve;
  }
  Folds folds;
  for (Eigen::Index i = 0; i < errors.theta.size(); ++i)
    folds[static_cast<std::size_t>(errors.fold[static_cast<std::size_t>(i)])].add(
        row_at(errors.theta[i]), errors.error[i]);
  const int order = best_order(folds);
  std::array<Eigen::VectorXd, error_folds> without, with;
  for (int fold = 0; fold < error_folds; ++fold) {
    const Normal others = all_but(folds, fold);
    without[static_cast<std::size_t>(fold)] = solve(others, 1);
    with[static_cast<std::size_t>(fold)] = solve(others, 2 * order + 1);
  }
  curve.before = held_out(errors, without);
  curve.after = held_out(errors, with);
  if (order == 0) {
    curve.reason =
        "an error table does not make the angle of held-out samples better: what is left of their "
        "error does not repeat with the angle";
    return curve;
  }
  curve.order = order;
  const Eigen::VectorXd x = solve(all_but(folds, error_folds), 2 * order + 1);
  curve.terms.assign(x.begin(), x.end());
  if (!make_nodes(curve)) {
    curve.reason = text(
        "the error of the angle is larger than the table can take (%.4g degrees): look at the "
        "column of the true angle",
        largest_node / 0x1p24 * 360);
    return curve;
  }
  curve.identified = true;
  curve.reason = curve.by_turns
                     ? text(
                           "orders 0 to %.0f of the angle, validated on %.0f groups of "
                           "consecutive turns",
                           order, error_folds)
                     : text(
                           "orders 0 to %.0f of the angle, validated on %.0f groups of sectors of "
                           "4 degrees",
                           order, error_folds);
  return curve;
}

}  // namespace capsoc::identification
