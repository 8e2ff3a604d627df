#include "identification/robust_fit.h"

#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "base/random.h"
#include "identification/calibration.h"
#include "identification/circle_plane.h"
#include "identification/distributions.h"
#include "identification/ellipse_distance.h"
#include "identification/ellipse_fit.h"

namespace capsoc::identification {
namespace {

/// With 30 % outliers one draw of eight in 17 has none of them.
constexpr int draws = 120;
constexpr Eigen::Index drawn = 8;
/// Samples that a draw is judged by.
constexpr Eigen::Index judges = 400;
constexpr uint64_t draws_seed = 1984;
/// The standard deviation of normal noise in units of its median size.
constexpr double normal_by_median = 1.4826;
/// Rounds and reach (in units of the noise) of the refinement.
constexpr int refinements = 4;
constexpr double refinement_reach = 3;
/// Records without outliers in which a sample is left out.
constexpr double false_alarms = 1e-3;
constexpr int rounds = 10;
/// Distances to first order are exact enough below this, in units of the noise.
constexpr double first_order_reach = 2.5;

double first_order_distance(const CirclePlane& plane, double u, double v) {
  const CirclePlane::Polar at = plane.at(u, v);
  return (at.length - 1) / std::sqrt(plane.square_slope(at));
}

Samples taken(const Channel& u, const Channel& v, const std::vector<Eigen::Index>& places) {
  const auto count = static_cast<Eigen::Index>(places.size());
  Samples samples{Eigen::ArrayXd(count), Eigen::ArrayXd(count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    samples.u[i] = u[places[static_cast<std::size_t>(i)]];
    samples.v[i] = v[places[static_cast<std::size_t>(i)]];
  }
  return samples;
}

std::vector<Eigen::Index> draw(Random& random, Eigen::Index from, Eigen::Index count) {
  std::vector<Eigen::Index> places;
  while (static_cast<Eigen::Index>(places.size()) < count) {
    const Eigen::Index place = random.index(from);
    if (std::find(places.begin(), places.end(), place) == places.end()) places.push_back(place);
  }
  return places;
}

double median_distance(const Parameters& p, const Channel& u, const Channel& v) {
  const CirclePlane plane(p);
  std::vector<double> distance;
  for (Eigen::Index i = 0; i < u.size(); ++i) {
    const double d = std::abs(first_order_distance(plane, u[i], v[i]));
    distance.push_back(std::isfinite(d) ? d : HUGE_VAL);
  }
  const auto middle = distance.begin() + static_cast<std::ptrdiff_t>(distance.size() / 2);
  std::nth_element(distance.begin(), middle, distance.end());
  return *middle;
}

Result<Parameters> closed_form(const Channel& u, const Channel& v) {
  Result<Parameters> fit = fit_taubin(u, v);
  return fit ? fit : fit_direct(u, v);
}

/// Cells of the plane in which the samples are counted, along each side; and the most samples that
/// a cell may have, in units of the average cell's.
constexpr int cells = 64;
constexpr double fullest = 8;
/// Most samples in which a start is looked for; of longer records, this many are taken from all
/// over the record.
constexpr Eigen::Index most_for_start = 1 << 17;
constexpr double golden_step = 0.61803398874989484820;

/// Places of samples, of which no cell of the plane has more than a few times the others'; empty
/// when all of a record may be used.
std::vector<Eigen::Index> evenly_placed(const Channel& u, const Channel& v) {
  const double least_u = u.minCoeff(), least_v = v.minCoeff();
  const double scale_u = cells / std::max(u.maxCoeff() - least_u, 1e-300);
  const double scale_v = cells / std::max(v.maxCoeff() - least_v, 1e-300);
  const auto cell_of = [&](Eigen::Index i) {
    const int x = std::min(static_cast<int>((u[i] - least_u) * scale_u), cells - 1);
    const int y = std::min(static_cast<int>((v[i] - least_v) * scale_v), cells - 1);
    return static_cast<std::size_t>(x) * cells + static_cast<std::size_t>(y);
  };
  const Eigen::Index stride = (u.size() - 1) / most_for_start + 1;
  const Eigen::Index steps = (u.size() - 1) / stride + 1;
  // In step with no period of the samples.
  const auto place_of = [&](Eigen::Index k) {
    double turns = 0;
    const double within = std::modf(static_cast<double>(k) * golden_step, &turns);
    return std::min(k * stride + static_cast<Eigen::Index>(within * static_cast<double>(stride)),
                    u.size() - 1);
  };
  std::vector<Eigen::Index> samples(cells * cells), used(cells * cells);
  for (Eigen::Index k = 0; k < steps; ++k) ++samples[cell_of(place_of(k))];
  const auto occupied = static_cast<double>(
      samples.size() - static_cast<std::size_t>(std::count(samples.begin(), samples.end(), 0)));
  const auto limit = static_cast<Eigen::Index>(fullest * static_cast<double>(steps) / occupied) + 1;
  const bool even = *std::max_element(samples.begin(), samples.end()) <= limit;
  std::vector<Eigen::Index> places;
  if (even && stride == 1) return places;
  for (Eigen::Index k = 0; k < steps; ++k) {
    const std::size_t cell = cell_of(place_of(k));
    // Of a full cell every N-th sample, spread over the record.
    const Eigen::Index every = (samples[cell] - 1) / limit + 1;
    if (used[cell]++ % every == 0) places.push_back(place_of(k));
  }
  return places;
}

/// The best of everything and of the draws.
std::optional<Parameters> best_draw(const Channel& u, const Channel& v) {
  Random random(draws_seed);
  const Eigen::Index looked_at = std::min(u.size(), judges);
  Samples judge{u, v};
  if (looked_at < u.size()) judge = taken(u, v, draw(random, u.size(), looked_at));
  std::optional<Parameters> best;
  double smallest = HUGE_VAL;
  const auto offer = [&](const Result<Parameters>& fit) {
    if (!fit) return;
    const double distance = median_distance(fit.value(), judge.u, judge.v);
    if (!(distance < smallest)) return;
    smallest = distance;
    best = fit.value();
  };
  for (const auto& fit : {fit_taubin(u, v), fit_heydemann(u, v), fit_direct(u, v)}) offer(fit);
  for (int i = 0; i < draws; ++i) {
    const Samples some = taken(u, v, draw(random, u.size(), std::min(drawn, u.size())));
    offer(closed_form(some.u, some.v));
  }
  return best;
}

/// How far noise reaches in a record of that many samples. A sample is never farther from the
/// ellipse than from its place without noise. That distance exceeds k in exp(-k^2/2) of all cases.
/// Student's distribution adds the uncertainty of the noise itself.
double reach_of(Eigen::Index count, Eigen::Index kept) {
  const double tail = false_alarms / static_cast<double>(count);
  const double freedom = std::max(static_cast<double>(kept) - 6, 1.0);
  return std::sqrt(-2 * std::log(tail)) * student_quantile(1 - tail, freedom) /
         normal_quantile(1 - tail);
}

/// The outliers, and how far they are.
void find_outliers(const Channel& u, const Channel& v, const Parameters& p, double noise,
                   double reach, RobustFit& robust) {
  const CirclePlane plane(p);
  const EllipseDistance exact(p);
  robust.outliers.clear();
  robust.nearest = HUGE_VAL;
  robust.farthest = 0;
  for (Eigen::Index i = 0; i < u.size(); ++i) {
    double distance = std::abs(first_order_distance(plane, u[i], v[i]));
    if (distance > first_order_reach * noise || distance > reach / 2)
      distance = std::abs(exact.at(u[i], v[i]));
    if (distance <= reach) continue;
    robust.outliers.push_back(i);
    robust.nearest = std::min(robust.nearest, distance / noise);
    robust.farthest = std::max(robust.farthest, distance / noise);
  }
}

/// The samples at all other places; `outliers` ascend.
Samples all_but(const Channel& u, const Channel& v, const std::vector<Eigen::Index>& outliers) {
  const Eigen::Index count = u.size() - static_cast<Eigen::Index>(outliers.size());
  Samples samples{Eigen::ArrayXd(count), Eigen::ArrayXd(count)};
  auto next = outliers.begin();
  for (Eigen::Index i = 0, k = 0; i < u.size(); ++i) {
    if (next != outliers.end() && *next == i) {
      ++next;
      continue;
    }
    samples.u[k] = u[i];
    samples.v[k++] = v[i];
  }
  return samples;
}

}  // namespace

double distance_from(const Parameters& p, double u, double v) {
  return EllipseDistance(p).at(u, v);
}

namespace {

std::optional<RobustStart> start_of(const Channel& u, const Channel& v) {
  const std::optional<Parameters> drawn_best = best_draw(u, v);
  if (!drawn_best) return std::nullopt;
  RobustStart start{*drawn_best, normal_by_median * median_distance(*drawn_best, u, v)};
  for (int i = 0; i < refinements; ++i) {
    const CirclePlane plane(start.parameters);
    std::vector<Eigen::Index> near;
    for (Eigen::Index k = 0; k < u.size(); ++k) {
      const double distance = std::abs(first_order_distance(plane, u[k], v[k]));
      if (distance <= refinement_reach * start.noise) near.push_back(k);
    }
    if (static_cast<Eigen::Index>(near.size()) < drawn) break;
    const Samples some = taken(u, v, near);
    const Result<Parameters> fit = fit_taubin(some.u, some.v);
    if (!fit) break;
    const double noise = normal_by_median * median_distance(fit.value(), u, v);
    if (!(noise < start.noise)) break;
    start = {fit.value(), noise};
  }
  return start;
}

}  // namespace

std::optional<RobustStart> robust_start(const Channel& u, const Channel& v) {
  const std::vector<Eigen::Index> places = evenly_placed(u, v);
  if (places.empty()) return start_of(u, v);
  const Samples some = taken(u, v, places);
  return start_of(some.u, some.v);
}

RobustFit fit_robustly(const Channel& u, const Channel& v, const RobustStart& start,
                       double resolution) {
  RobustFit robust;
  // Evenly distorted signals, by harmonics for instance, are near no ellipse as a whole, and the
  // median follows a part of them. So the fit of all samples comes first: if no sample is far from
  // it, there are no outliers.
  robust.fit = fit_distances(u, v, start.parameters);
  if (robust.fit.converged) {
    const double noise = std::max(robust.fit.noise, resolution / 10);
    const double reach = std::max(resolution, noise * reach_of(u.size(), u.size()));
    find_outliers(u, v, robust.fit.parameters, noise, reach, robust);
    if (robust.outliers.empty()) return robust;
  }
  robust.fit = {};
  robust.fit.parameters = start.parameters;
  robust.fit.noise = start.noise;
  std::optional<std::vector<Eigen::Index>> last;
  // The draws' median is less certain than a fit: nothing that may belong is left out at first.
  double allowance = 1 + 10 / static_cast<double>(u.size());
  Eigen::Index kept = u.size();
  for (int round = 0; round < rounds; ++round) {
    const double noise = std::max(robust.fit.noise, resolution / 10);
    const double reach = std::max(resolution, allowance * noise * reach_of(u.size(), kept));
    find_outliers(u, v, robust.fit.parameters, noise, reach, robust);
    if (robust.outliers == last || robust.outliers.size() == static_cast<std::size_t>(u.size()))
      return robust;
    last = robust.outliers;
    robust.kept.reset();  // before there are new ones
    robust.kept = all_but(u, v, robust.outliers);
    const Samples& some = *robust.kept;
    kept = some.u.size();
    if (kept <= 5 || check_samples(some.u, some.v)) return robust;
    const Parameters from = robust.fit.parameters;
    robust.fit = fit_distances(some.u, some.v, from);
    if (!robust.fit.converged) return robust;
    allowance = 1;
  }
  return robust;
}

}  // namespace capsoc::identification
