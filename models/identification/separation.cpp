#include "identification/separation.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "identification/left_out.h"
#include "identification/sensor_change.h"
#include "identification/sentence.h"

namespace capsoc::identification {
namespace {

/// Rounding of the samples' last digits, in units of the record's largest value.
constexpr double arithmetic = 1e-14;

Samples without(const Samples& samples, const std::vector<Eigen::Index>& places) {
  const Eigen::Index count = samples.u.size() - static_cast<Eigen::Index>(places.size());
  Samples rest{Eigen::ArrayXd(count), Eigen::ArrayXd(count)};
  Eigen::Index to = 0;
  auto next = places.begin();
  for (Eigen::Index i = 0; i < samples.u.size(); ++i) {
    if (next != places.end() && *next == i) {
      ++next;
      continue;
    }
    rest.u[to] = samples.u[i];
    rest.v[to++] = samples.v[i];
  }
  return rest;
}

/// The fit of all samples but the plateau's; nothing when they do not determine an ellipse.
std::optional<RobustFit> fit_of_others(const Samples& samples, const Plateau& plateau,
                                       double resolution) {
  const Samples others = without(samples, plateau.places);
  if (others.u.size() < 12 || check_samples(others.u, others.v)) return std::nullopt;
  const auto start = robust_start(others.u, others.v);
  if (!start) return std::nullopt;
  RobustFit robust = fit_robustly(others.u, others.v, *start, resolution);
  if (!robust.fit.converged) return std::nullopt;
  return robust;
}

/// Noise of this many steps spreads a peak over several of them.
constexpr double noise_by_step = 3;

/// Distance of a plateau's value from the next one of its channel: the converter's step, where the
/// record does not say it.
double step_at(const Samples& samples, const Plateau& plateau) {
  const Eigen::ArrayXd& channel = plateau.name == "U" ? samples.u : samples.v;
  const double value = channel[plateau.places.front()];
  double least = HUGE_VAL;
  for (const double other : channel)
    if (other != value) least = std::min(least, std::abs(other - value));
  return least;
}

bool is_large(const Plateau& plateau, const Samples& samples) {
  return 100 * static_cast<Eigen::Index>(plateau.places.size()) >= samples.u.size();
}

}  // namespace

double resolution_of(const Samples& samples, const IdentifyOptions& options) {
  const double largest = std::max(samples.u.abs().maxCoeff(), samples.v.abs().maxCoeff());
  return std::max(options.step, arithmetic * largest);
}

void confirm_clipping(const Samples& samples, const IdentifyOptions& options, Gate& clipping) {
  const double full_scale = options.gates.full_scale;
  const double largest = std::max(samples.u.abs().maxCoeff(), samples.v.abs().maxCoeff());
  if (clipping.passed || (full_scale > 0 && largest >= full_scale)) return;
  const double resolution = resolution_of(samples, options);
  for (const Plateau& plateau : plateaus_of(samples.u, samples.v, options.step)) {
    const std::optional<RobustFit> others = fit_of_others(samples, plateau, resolution);
    if (!others) return;
    // Where noise is larger than the steps, equal values are no chance.
    const double step = std::max(options.step, step_at(samples, plateau));
    if (others->fit.noise > noise_by_step * step && is_large(plateau, samples)) return;
    const Gate gate = check_plateau(samples.u, samples.v, plateau, others->fit.parameters,
                                    others->fit.noise, std::max(resolution, step));
    if (!gate.passed) return;
  }
  clipping = {clipping.name, true, clipping.value, clipping.limit, ""};
}

Gate check_plateaus(const Samples& samples, double resolution, const IdentifyOptions& options) {
  Gate gate = {"plateau", true, 0, 0, ""};
  for (const Plateau& plateau : plateaus_of(samples.u, samples.v, options.step)) {
    const std::optional<RobustFit> robust = fit_of_others(samples, plateau, resolution);
    if (!robust) continue;
    gate = check_plateau(samples.u, samples.v, plateau, robust->fit.parameters, robust->fit.noise,
                         resolution);
    if (!gate.passed) break;
  }
  return gate;
}

RobustFit separate(const Samples& samples, double resolution, const IdentifyOptions& options,
                   Identification& found) {
  const auto start = robust_start(samples.u, samples.v);
  if (!start) {
    found.gates.push_back(
        failed_gate("distances",
                    "no ellipse lies near half of the samples: record more of the turn, or with "
                    "less noise"));
    return {};
  }
  RobustFit robust = fit_robustly(samples.u, samples.v, *start, resolution);
  found.outliers = robust.outliers;
  found.nearest_outlier = robust.outliers.empty() ? 0 : robust.nearest;
  found.farthest_outlier = robust.farthest;
  const auto count = static_cast<double>(robust.outliers.size());
  const double share = count / static_cast<double>(samples.u.size());
  Gate outliers = {"outliers", share <= options.gates.outliers, share, options.gates.outliers, ""};
  if (!outliers.passed) {
    outliers.reason = text(
        "%.0f samples (%.0f %% of them) lie off the ellipse of the others: find what disturbs them",
        count, 100 * share);
  }
  found.gates.push_back(std::move(outliers));
  if (found.rejected()) return robust;
  found.gates.push_back(check_left_out(samples, robust));
  if (found.rejected()) return robust;
  found.gates.push_back(check_change(samples, robust));
  if (found.rejected()) return robust;
  Gate distances = {"distances", robust.fit.converged, robust.fit.noise, HUGE_VAL, ""};
  if (!robust.fit.converged) {
    distances.reason =
        "no ellipse fits the samples by their distances: record more samples, more of the turn, or "
        "with less noise";
  }
  found.gates.push_back(std::move(distances));
  return robust;
}

}  // namespace capsoc::identification
