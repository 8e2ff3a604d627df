#include "identification/correlation.h"

#include <algorithm>
#include <cmath>

#include "identification/circle_plane.h"
#include "identification/linear_algebra.h"

namespace capsoc::identification {
namespace {

constexpr Eigen::Index fewest_for_correlation = 30;
/// Lags up to this are looked at one by one, later ones in bins this much longer each.
constexpr Eigen::Index single_lags = 12;
constexpr double bin_growth = 1.2;
constexpr int lags_a_bin = 8;
constexpr Eigen::Index longest_lag = 1 << 18;
/// Pairs a lag, and pairs that the fit's own share is taken from.
constexpr Eigen::Index most_pairs = 100'000, pairs_of_share = 300;
/// Memories of the parts, samples, and the part of a record that the longest may last.
constexpr double shortest_memory = 0.45, memory_growth = 1.5, longest_part = 0.1;
/// Better by this much of chi^2 than white noise, or than noise without slow parts in units of what
/// its memory does to the products: one record in some hundred without.
constexpr double improvement_limit = 7, slow_limit = 14;
constexpr double slow_part = 1.0 / 40;  ///< of the record
/// Short and long memories, parts of the record, and the share of the variance that each has where
/// noise is of all memories.
constexpr double short_memory = 1.0 / 300, long_memory = 1.0 / 100, least_of_memories = 0.08;
/// Least length and share of the variance of a single long memory, where a record shows no other.
/// White noise may then stand for the short memories, and the long one may mask memories longer
/// than the record.
constexpr double lone_memory = 1.0 / 80, least_of_lone_memory = 0.25;
constexpr int noise_rounds = 4;
/// Samples of one stretch, at least, that the covariance of the sums is taken from.
constexpr Eigen::Index longest_stretch = 1 << 17;

/// Distances that the structure's terms leave.
class Remainder {
 public:
  Remainder(const Channel& u, const Channel& v, const CirclePlane& plane, const ScoreVector& terms)
      : u_(u), v_(v), plane_(plane), terms_(terms) {}
  SampleScore at(Eigen::Index i) const {
    SampleScore seen = score_at(plane_, u_[i], v_[i]);
    seen.distance -= seen.shape.dot(terms_);
    return seen;
  }

 private:
  const Channel &u_, &v_;
  const CirclePlane& plane_;
  const ScoreVector& terms_;
};

double along(const SampleScore& one, const SampleScore& other) {
  return one.normal_u * other.normal_u + one.normal_v * other.normal_v;
}

struct Bin {
  std::vector<Eigen::Index> lags;
  double product = 0, weight = 0;  ///< sums of d d' c and of c^2
};

std::vector<Bin> bins_for(Eigen::Index count) {
  std::vector<Bin> bins;
  const Eigen::Index last = std::min(count / 4, longest_lag);
  for (Eigen::Index from = 1; from <= last;) {
    const auto to =
        from < single_lags
            ? from + 1
            : static_cast<Eigen::Index>(std::ceil(static_cast<double>(from) * bin_growth));
    Bin bin;
    const Eigen::Index step = std::max<Eigen::Index>((to - from) / lags_a_bin, 1);
    for (Eigen::Index lag = from; lag < std::min(to, last + 1); lag += step)
      bin.lags.push_back(lag);
    bins.push_back(std::move(bin));
    from = to;
  }
  return bins;
}

/// Sums over the pairs; returns the mean square of the distances.
double add_pairs(const Remainder& remainder, Eigen::Index count, std::vector<Bin>& bins) {
  double square = 0;
  if (count <= most_pairs) {
    std::vector<SampleScore> all;
    all.reserve(static_cast<std::size_t>(count));
    Eigen::ArrayXd distance(count), normal_u(count), normal_v(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const SampleScore seen = remainder.at(i);
      distance[i] = seen.distance;
      normal_u[i] = seen.normal_u;
      normal_v[i] = seen.normal_v;
    }
    for (Bin& bin : bins) {
      for (const Eigen::Index lag : bin.lags) {
        const Eigen::Index pairs = count - lag;
        const Eigen::ArrayXd cosine = normal_u.head(pairs) * normal_u.tail(pairs) +
                                      normal_v.head(pairs) * normal_v.tail(pairs);
        bin.product += (distance.head(pairs) * distance.tail(pairs) * cosine).sum();
        bin.weight += cosine.square().sum();
      }
    }
    return distance.square().mean();
  }
  const Eigen::Index stride = count / most_pairs + 1;
  Eigen::Index looked_at = 0;
  for (Eigen::Index i = 0; i < count; i += stride) {
    const SampleScore one = remainder.at(i);
    square += one.distance * one.distance;
    ++looked_at;
    for (Bin& bin : bins) {
      // One lag of the bin a sample, in turn.
      const Eigen::Index lag = bin.lags[static_cast<std::size_t>(looked_at) % bin.lags.size()];
      if (i + lag >= count) continue;
      const SampleScore other = remainder.at(i + lag);
      const double cosine = along(one, other);
      bin.product += one.distance * other.distance * cosine;
      bin.weight += cosine * cosine;
    }
  }
  return square / static_cast<double>(looked_at);
}

/// What the terms with that covariance took of each bin's mean product, and of the mean square.
std::vector<double> taken_by(const Remainder& remainder, Eigen::Index count,
                             const std::vector<Bin>& bins, const ScoreMatrix& covariance) {
  std::vector<double> taken;
  double square = 0, samples = 0;
  const Eigen::Index stride = std::max<Eigen::Index>(count / pairs_of_share, 1);
  for (Eigen::Index i = 0; i < count; i += stride) {
    const SampleScore one = remainder.at(i);
    square += one.shape.dot(covariance * one.shape);
    samples += 1;
  }
  taken.push_back(square / samples);
  for (const Bin& bin : bins) {
    const Eigen::Index lag = bin.lags[bin.lags.size() / 2];
    double product = 0, weight = 1e-300;
    for (Eigen::Index i = 0; i + lag < count; i += stride) {
      const SampleScore one = remainder.at(i), other = remainder.at(i + lag);
      const double cosine = along(one, other);
      product += cosine * one.shape.dot(covariance * other.shape);
      weight += cosine * cosine;
    }
    taken.push_back(product / weight);
  }
  return taken;
}

/// Least squares with unknowns that are not negative, by coordinates in turn.
Eigen::VectorXd not_negative(const Eigen::MatrixXd& normal, const Eigen::VectorXd& right) {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(right.size());
  for (int round = 0; round < 3000; ++round) {
    double moved = 0;
    for (Eigen::Index k = 0; k < x.size(); ++k) {
      if (!(normal(k, k) > 0)) continue;
      const double next = std::max(x[k] + (right[k] - normal.row(k).dot(x)) / normal(k, k), 0.0);
      moved = std::max(moved, std::abs(next - x[k]));
      x[k] = next;
    }
    if (moved < 1e-9) break;
  }
  return x;
}

/// Mean products by lag and what parts of every memory give, the mean square first.
struct Products {
  std::vector<double> memories;
  Eigen::MatrixXd design;  ///< a column for white noise, then one a memory
  Eigen::VectorXd value, weight;
};

Products products_of(const std::vector<Bin>& bins, const std::vector<double>& values,
                     Eigen::Index count) {
  Products products;
  const double longest_memory = longest_part * static_cast<double>(count);
  double memory = shortest_memory;
  while (memory <= longest_memory) {
    products.memories.push_back(memory);
    memory *= memory_growth;
  }
  const auto columns = static_cast<Eigen::Index>(products.memories.size());
  const auto rows = static_cast<Eigen::Index>(bins.size()) + 1;
  products.design = Eigen::MatrixXd::Zero(rows, columns + 1);
  products.value.resize(rows);
  products.weight.resize(rows);
  products.design.row(0).setOnes();  // all parts together are the mean square
  products.value[0] = 1;
  products.weight[0] = 10 * static_cast<double>(count);
  for (Eigen::Index row = 1; row < rows; ++row) {
    const Bin& bin = bins[static_cast<std::size_t>(row) - 1];
    products.value[row] = values[static_cast<std::size_t>(row)] / values.front();
    products.weight[row] = bin.weight;
    for (Eigen::Index k = 0; k < columns; ++k)
      for (const Eigen::Index lag : bin.lags)
        products.design(row, k + 1) +=
            std::exp(-static_cast<double>(lag) / products.memories[static_cast<std::size_t>(k)]) /
            static_cast<double>(bin.lags.size());
  }
  return products;
}

/// Shares of the first `columns` columns, and chi^2 of what they leave.
struct Shares {
  Eigen::VectorXd x;
  double rest = 0;
};

Shares shares_of(const Products& products, Eigen::Index columns) {
  const Eigen::MatrixXd design = products.design.leftCols(columns);
  const Eigen::MatrixXd weighted = products.weight.asDiagonal() * design;
  Shares shares;
  shares.x = not_negative(design.transpose() * weighted, weighted.transpose() * products.value);
  const Eigen::VectorXd left = products.value - design * shares.x;
  shares.rest = (products.weight.array() * left.array().square()).sum();
  return shares;
}

/// By how much noise of such shares (white first) makes products of one lag less certain than white
/// noise does: the sum of the squares of its correlation over all lags, by variance.
double uncertainty_of(const Eigen::VectorXd& shares, const std::vector<double>& memories) {
  double sum = 1;
  for (Eigen::Index j = 1; j < shares.size(); ++j) {
    for (Eigen::Index k = 1; k < shares.size(); ++k) {
      const double keeps = std::exp(-1 / memories[static_cast<std::size_t>(j) - 1] -
                                    1 / memories[static_cast<std::size_t>(k) - 1]);
      sum += 2 * shares[j] * shares[k] * keeps / (1 - keeps);
    }
  }
  return sum;
}

/// Parts that explain the mean products. values: the mean square first.
NoiseCorrelation explained_by(const std::vector<Bin>& bins, const std::vector<double>& values,
                              Eigen::Index count) {
  const Products products = products_of(bins, values, count);
  const double variance = values.front();
  const auto all = products.design.cols();
  const auto fast = 1 + static_cast<Eigen::Index>(
                            std::upper_bound(products.memories.begin(), products.memories.end(),
                                             slow_part * static_cast<double>(count)) -
                            products.memories.begin());
  const double white = shares_of(products, 1).rest;
  const Shares with_slow = shares_of(products, all), without = shares_of(products, fast);
  const bool slow =
      without.rest - with_slow.rest > slow_limit * uncertainty_of(without.x, products.memories);
  const Shares& shares = slow ? with_slow : without;
  NoiseCorrelation noise;
  noise.found = white - shares.rest > improvement_limit;
  noise.white = shares.x[0] * variance;
  for (Eigen::Index k = 1; k < shares.x.size(); ++k) {
    const double part = shares.x[k] * variance;
    if (k >= fast)
      noise.slow += part;
    else if (shares.x[k] > 1e-6)
      noise.parts.push_back({part, products.memories[static_cast<std::size_t>(k) - 1]});
  }
  double short_ones = 0, long_ones = 0, lone = 0;
  for (const auto& part : noise.parts) {
    if (part.samples <= short_memory * static_cast<double>(count)) short_ones += part.variance;
    if (part.samples >= long_memory * static_cast<double>(count)) long_ones += part.variance;
    if (part.samples >= lone_memory * static_cast<double>(count)) lone += part.variance;
  }
  const bool of_lone = noise.white + short_ones > least_of_memories * variance &&
                       lone > least_of_lone_memory * variance;
  noise.of_all_memories =
      noise.found && (std::min(short_ones, long_ones) > least_of_memories * variance || of_lone);
  return noise;
}

}  // namespace

double NoiseCorrelation::of_neighbours() const {
  double all = white + slow, common = slow;
  for (const Part& part : parts) {
    all += part.variance;
    common += part.variance * std::exp(-1 / part.samples);
  }
  return all > 0 ? common / all : 0;
}

NoiseCorrelation correlation_of(const Channel& u, const Channel& v, const DistanceFit& fit,
                                const Scores& scores, const Structure& structure) {
  const Eigen::Index count = u.size();
  NoiseCorrelation noise;
  noise.white = fit.noise * fit.noise;
  if (count < fewest_for_correlation || !(fit.noise > 0)) return noise;
  const CirclePlane plane(fit.parameters);
  const ScoreVector terms = structure.terms;
  const Remainder remainder(u, v, plane, terms);
  std::vector<Bin> bins = bins_for(count);
  const double square = add_pairs(remainder, count, bins);
  ScoreMatrix of_sums = noise.white * scores.information;
  for (int round = 0; round < noise_rounds; ++round) {
    std::vector<double> values =
        taken_by(remainder, count, bins, structure.inverse * of_sums * structure.inverse);
    values.front() += square;
    for (std::size_t k = 0; k < bins.size(); ++k)
      values[k + 1] += bins[k].product / std::max(bins[k].weight, 1e-300);
    noise = explained_by(bins, values, count);
    if (!noise.found) break;
    of_sums = covariance_of_sums(u, v, plane, noise);
  }
  return noise;
}

ScoreMatrix covariance_of_sums(const Channel& u, const Channel& v, const CirclePlane& plane,
                               const NoiseCorrelation& noise) {
  using State = Eigen::Matrix<double, score_terms, 2>;
  const Eigen::Index count = u.size();
  // Of a long record the middle, as long as the longest memory needs.
  double longest = 0;
  for (const auto& part : noise.parts) longest = std::max(longest, part.samples);
  const auto wanted = std::max(longest_stretch, static_cast<Eigen::Index>(40 * longest));
  const Eigen::Index length = std::min(count, wanted), first = (count - length) / 2;
  std::vector<State> states(noise.parts.size(), State::Zero());
  ScoreMatrix sum = ScoreMatrix::Zero(), once = ScoreMatrix::Zero();
  for (Eigen::Index i = first; i < first + length; ++i) {
    const SampleScore seen = score_at(plane, u[i], v[i]);
    Eigen::Matrix<double, 2, 1> normal(seen.normal_u, seen.normal_v);
    once.noalias() += seen.shape * seen.shape.transpose();
    ScoreVector remembered = ScoreVector::Zero();
    for (std::size_t k = 0; k < states.size(); ++k) {
      const double keeps = std::exp(-1 / noise.parts[k].samples);
      states[k] *= keeps;  // of the samples before this one
      remembered += noise.parts[k].variance * (states[k] * normal);
      states[k] += seen.shape * normal.transpose();
    }
    sum.noalias() += seen.shape * remembered.transpose();
  }
  double all = noise.white;
  for (const auto& part : noise.parts) all += part.variance;
  const double scale = static_cast<double>(count) / static_cast<double>(length);
  return scale * (all * once + sum + sum.transpose());
}

}  // namespace capsoc::identification
