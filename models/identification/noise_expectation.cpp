#include "identification/noise_expectation.h"

#include <array>

#include "base/constants.h"
#include "identification/linear_algebra.h"

namespace capsoc::identification {
namespace {

/// Angles at which the means are taken, 3.75 degrees apart. Means of an ellipse five times as long
/// as wide vary over some 11 degrees.
constexpr int angles = 96;
constexpr int half = angles / 2;
/// Corrections of the table for its being read at noisy angles.
constexpr int sharpenings = 4;
/// The corners of the quadrature's square hold nothing.
constexpr double smallest_weight = 1e-12;
/// Below this the means are rounding.
constexpr double smallest_noise = 1e-7;

/// Nodes and weights for a normal variable of variance 1 (Golub and Welsch, Math. Comp. 23, 1969).
struct Rule {
  Eigen::VectorXd node, weight;
};

Rule gauss_hermite(int size) {
  Eigen::MatrixXd recurrence = Eigen::MatrixXd::Zero(size, size);
  for (int i = 1; i < size; ++i) {
    recurrence(i, i - 1) = recurrence(i - 1, i) = std::sqrt(static_cast<double>(i));
  }
  const SymmetricEigen eigen = eigen_of_symmetric(recurrence);
  return {eigen.values, eigen.vectors.row(0).transpose().array().square()};
}

const Rule& rule_for(double relative_noise) {
  static const Rule rules[] = {gauss_hermite(4), gauss_hermite(5), gauss_hermite(7),
                               gauss_hermite(10)};
  return rules[relative_noise < 0.01   ? 0
               : relative_noise < 0.05 ? 1
               : relative_noise < 0.12 ? 2
                                       : 3];
}

/// Cubic interpolation between four angles of the grid.
struct Place {
  std::array<int, 4> index;
  std::array<double, 4> weight;
};

Place place_of(double theta) {
  const double at = (theta + 2 * pi) * (angles / (2 * pi));
  const double below = std::floor(at);
  const double t = at - below;
  const int first = static_cast<int>(below) + angles - 1;
  return {{first % angles, (first + 1) % angles, (first + 2) % angles, (first + 3) % angles},
          {-t * (t - 1) * (t - 2) / 6, (t + 1) * (t - 1) * (t - 2) / 2, -(t + 1) * t * (t - 2) / 2,
           (t + 1) * t * (t - 1) / 6}};
}

template <class Table>
auto interpolated(const Table& table, const Place& place) {
  return (place.weight[0] * table.col(place.index[0]) +
          place.weight[1] * table.col(place.index[1]) +
          place.weight[2] * table.col(place.index[2]) + place.weight[3] * table.col(place.index[3]))
      .eval();
}

/// Half a turn on, the ellipse is the same and the terms of odd orders have the other sign.
template <int orders>
Terms<orders> mirror_of() {
  Terms<orders> mirror = Terms<orders>::Ones();
  for (int m = 1; m <= orders; m += 2) mirror[2 * m - 1] = mirror[2 * m] = -1;
  return mirror;
}

/// Nodes in the circle plane around a point, with their weights.
struct Node {
  double x, y, weight;
};

std::vector<Node> nodes_of(const CirclePlane& plane, double noise) {
  const Rule& rule = rule_for(noise * plane.largest_slope());
  std::vector<Node> nodes;
  for (Eigen::Index i = 0; i < rule.node.size(); ++i) {
    for (Eigen::Index k = 0; k < rule.node.size(); ++k) {
      const double weight = rule.weight[i] * rule.weight[k];
      if (weight < smallest_weight) continue;
      const Eigen::Vector2d d = noise * (plane.map() * Eigen::Vector2d(rule.node[i], rule.node[k]));
      nodes.push_back({d[0], d[1], weight});
    }
  }
  return nodes;
}

}  // namespace

template <int orders>
NoiseExpectation<orders>::NoiseExpectation(const CirclePlane& plane, double noise,
                                           bool with_scatter)
    : table_(Table::Zero(2 * orders + 2, angles)) {
  constexpr int last = 2 * orders + 1;
  const Terms<orders> mirror = mirror_of<orders>();
  const double relative = noise * plane.largest_slope();
  const bool rounding = !(relative > smallest_noise);
  if (rounding) table_.row(last).setConstant(noise * noise);
  if (rounding && !with_scatter) return;
  const std::vector<Node> nodes = nodes_of(plane, noise);
  Table mean = Table::Zero(2 * orders + 2, half);
  // The mean over the noise of a function of the noisy angle, given on half the grid; of functions
  // that repeat after half a turn and of those that change sign.
  Eigen::MatrixXd even = Eigen::MatrixXd::Zero(half, half), odd = even;
  std::vector<Terms<orders>> terms;
  std::vector<Place> places;
  for (int j = 0; j < half; ++j) {
    const double theta = 2 * pi * j / angles;
    const double cosine = std::cos(theta), sine = std::sin(theta);
    for (const Node& node : nodes) {
      const auto at = CirclePlane::polar(cosine + node.x, sine + node.y);
      const Terms<orders> one = terms_of<orders>(plane, at);
      mean.col(j) += node.weight * one;
      const Place place = place_of(std::atan2(at.sine, at.cosine));
      for (int k = 0; k < 4; ++k) {
        const double share = node.weight * place.weight[k];
        const int index = place.index[k];
        even(place.index[k] % half, j) += share;
        odd(place.index[k] % half, j) += index < half ? share : -share;
      }
      if (!with_scatter) continue;
      terms.push_back(one);
      places.push_back(place);
    }
  }
  if (!rounding) {
    Table table = mean;
    for (int i = 0; i < sharpenings; ++i) {
      const Table blurred_even = table * even, blurred_odd = table * odd;
      for (int row = 0; row <= last; ++row) {
        table.row(row) += mean.row(row) - (mirror[row] > 0 ? blurred_even : blurred_odd).row(row);
      }
    }
    table_ << table, mirror.asDiagonal() * table;
  }
  if (!with_scatter) return;
  scatter_.assign(angles, Square::Zero());
  for (int j = 0; j < half; ++j) {
    for (std::size_t q = 0; q < nodes.size(); ++q) {
      const std::size_t at = j * nodes.size() + q;
      const Terms<orders> rest = terms[at] - interpolated(table_, places[at]);
      scatter_[j] += nodes[q].weight * rest * rest.transpose();
    }
    scatter_[j + half] = mirror.asDiagonal() * scatter_[j] * mirror.asDiagonal();
  }
}

template <int orders>
Terms<orders> NoiseExpectation<orders>::at(double theta) const {
  return interpolated(table_, place_of(theta));
}

template <int orders>
typename NoiseExpectation<orders>::Square NoiseExpectation<orders>::scatter(
    const Eigen::ArrayXd& theta) const {
  Eigen::VectorXd share = Eigen::VectorXd::Zero(angles);
  for (const double angle : theta) {
    const Place place = place_of(angle);
    for (int k = 0; k < 4; ++k) share[place.index[k]] += place.weight[k];
  }
  Square sum = Square::Zero();
  for (int j = 0; j < angles; ++j) sum += share[j] * scatter_[j];
  return sum;
}

template class NoiseExpectation<fit_orders>;
template class NoiseExpectation<harmonic_orders>;

}  // namespace capsoc::identification
