#include "csfn/robust_fit.h"

#include <algorithm>
#include <cmath>

#include "csfn/calibration.h"
#include "csfn/circle_plane.h"
#include "csfn/distributions.h"
#include "csfn/ellipse_fit.h"
#include "csfn/random.h"
#include "support/constants.h"

namespace capsoc::csfn {
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
    const Eigen::Index place = random.below(from);
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
/// ellipse than from where it would be without noise, and that distance exceeds k in exp(-k^2/2) of
/// all cases; Student's distribution has the uncertainty of the noise itself.
double reach_of(Eigen::Index count, Eigen::Index kept) {
  const double tail = false_alarms / static_cast<double>(count);
  const double freedom = std::max(static_cast<double>(kept) - 6, 1.0);
  return std::sqrt(-2 * std::log(tail)) * student_quantile(1 - tail, freedom) /
         normal_quantile(1 - tail);
}

/// The places within reach; for the others the distance as well.
std::vector<Eigen::Index> within(const Channel& u, const Channel& v, const Parameters& p,
                                 double noise, double reach, RobustFit& robust) {
  const CirclePlane plane(p);
  std::vector<Eigen::Index> places;
  robust.outliers.clear();
  robust.nearest = HUGE_VAL;
  robust.farthest = 0;
  for (Eigen::Index i = 0; i < u.size(); ++i) {
    double distance = std::abs(first_order_distance(plane, u[i], v[i]));
    if (distance > first_order_reach * noise || distance > reach / 2) {
      distance = std::abs(distance_from(p, u[i], v[i]));
    }
    if (distance <= reach) {
      places.push_back(i);
      continue;
    }
    robust.outliers.push_back(i);
    robust.nearest = std::min(robust.nearest, distance / noise);
    robust.farthest = std::max(robust.farthest, distance / noise);
  }
  return places;
}

}  // namespace

double distance_from(const Parameters& p, double u, double v) {
  const SignalModel model{p, {}, {}};
  constexpr int places = 24;
  double theta = 0, least = HUGE_VAL;
  for (int i = 0; i < places; ++i) {
    const Point at = point_at(model, 2 * pi * i / places);
    const double distance = std::hypot(u - at.u, v - at.v);
    if (distance >= least) continue;
    least = distance;
    theta = 2 * pi * i / places;
  }
  for (int i = 0; i < 20; ++i) {  // Gauss and Newton, kept from leaving the neighbourhood
    const Point at = point_at(model, theta), along = tangent_at(model, theta);
    const double step =
        ((u - at.u) * along.u + (v - at.v) * along.v) / (along.u * along.u + along.v * along.v);
    theta += std::clamp(step, -0.1, 0.1);
    if (std::abs(step) < 1e-12) break;
  }
  const Point at = point_at(model, theta);
  const double distance = std::min(least, std::hypot(u - at.u, v - at.v));
  return CirclePlane(p).at(u, v).length < 1 ? -distance : distance;
}

std::optional<RobustStart> robust_start(const Channel& u, const Channel& v) {
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

RobustFit fit_robustly(const Channel& u, const Channel& v, const RobustStart& start,
                       double resolution) {
  RobustFit robust;
  // What is evenly distorted, by harmonics for instance, is near no ellipse as a whole, and the
  // median follows a part of it: nothing is an outlier when nothing is far from the fit of all.
  robust.fit = fit_distances(u, v, start.parameters);
  if (robust.fit.converged) {
    const double noise = std::max(robust.fit.noise, resolution / 10);
    const double reach = std::max(resolution, noise * reach_of(u.size(), u.size()));
    within(u, v, robust.fit.parameters, noise, reach, robust);
    robust.kept = {u, v};
    if (robust.outliers.empty()) return robust;
  }
  robust.fit = {};
  robust.fit.parameters = start.parameters;
  robust.fit.noise = start.noise;
  std::vector<Eigen::Index> last;
  // The draws' median is less certain than a fit: nothing that may belong is left out at first.
  double allowance = 1 + 10 / static_cast<double>(u.size());
  Eigen::Index kept = u.size();
  for (int round = 0; round < rounds; ++round) {
    const double noise = std::max(robust.fit.noise, resolution / 10);
    const double reach = std::max(resolution, allowance * noise * reach_of(u.size(), kept));
    std::vector<Eigen::Index> places = within(u, v, robust.fit.parameters, noise, reach, robust);
    if (places == last) return robust;
    robust.kept = taken(u, v, places);
    kept = robust.kept.u.size();
    if (kept <= 5 || check_samples(robust.kept.u, robust.kept.v)) return robust;
    const Parameters from = robust.fit.parameters;
    robust.fit = fit_distances(robust.kept.u, robust.kept.v, from);
    if (!robust.fit.converged) return robust;
    allowance = 1;
    last = std::move(places);
  }
  return robust;
}

}  // namespace capsoc::csfn
