#include "csfn/assessment.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "csfn/circle_plane.h"
#include "csfn/sentence.h"
#include "support/constants.h"

namespace capsoc::csfn {
namespace {

/// Part of the samples whose values occur before.
double repeated_part(const Samples& samples) {
  std::vector<std::pair<double, double>> points;
  for (Eigen::Index i = 0; i < samples.u.size(); ++i)
    points.emplace_back(samples.u[i], samples.v[i]);
  std::sort(points.begin(), points.end());
  const auto end = std::unique(points.begin(), points.end());
  return 1 - static_cast<double>(end - points.begin()) / static_cast<double>(samples.u.size());
}

std::string warning_of(const Structure& structure) {
  // Harmonics of the same size in both channels, at any phases, leave an amplitude of h/sqrt(2).
  return text(
             "the intervals do not hold: the samples' distance from the ellipse repeats %.0f times "
             "a turn, as a harmonic of %.2g %% of the amplitude leaves it",
             structure.order, 100 * std::sqrt(2.0) * structure.amplitude) +
         (structure.order <= 4
              ? " (order " + std::to_string(structure.order - 1) + " or " +
                    std::to_string(structure.order + 1) + "); use --harmonics " +
                    std::to_string(structure.order - 1)
              : " (order " + std::to_string(structure.order - 1) + " or " +
                    std::to_string(structure.order + 1) + ", beyond what --harmonics identifies)");
}

}  // namespace

Gate check_noise(const DistanceFit& fit, double limit) {
  const double relative = fit.noise * CirclePlane(fit.parameters).largest_slope();
  Gate gate = {"noise", relative <= limit, relative, limit, ""};
  if (!gate.passed) {
    gate.reason = text(
        "the samples scatter by %.2g of the ellipse's smaller half axis (at most %.2g): these are "
        "not a sine and a cosine of one angle, or the noise is too large",
        relative, limit);
  }
  return gate;
}

Intervals assess(const Samples& samples, const DistanceFit& fit, const IdentifyOptions& options,
                 Identification& found) {
  Evidence evidence;
  evidence.answer = found.network_parameters;
  evidence.fit = fit;
  evidence.structure = found.structure;
  evidence.count = static_cast<double>(samples.u.size());
  evidence.resolution = options.step / std::sqrt(12.0);
  if (fit.noise < 2 * options.step) evidence.repeated = repeated_part(samples);
  found.intervals = intervals_of(evidence, options.confidence);
  Evidence of_noise = evidence;
  of_noise.answer = fit.parameters;
  of_noise.structure = {};
  const Intervals explained = intervals_of(of_noise, options.confidence);
  if (found.structure.found) {
    found.warning = warning_of(found.structure);
    return explained;
  }
  found.bound = bound_of(evidence);
  // Harmonics that could hide are the bound's affair; a record is refused for what it tells too
  // little of.
  const double degrees = (found.bound->total - found.bound->harmonics) * 180 / pi;
  const double limit = options.gates.bound;
  Gate gate = {"bound", degrees <= limit, degrees, limit, ""};
  if (!gate.passed) {
    gate.reason = text(
        "the samples tell the angle to %.2g degrees only (at most %.2g): record more samples, more "
        "of the turn, or with less noise",
        degrees, limit);
  }
  found.gates.push_back(std::move(gate));
  return explained;
}

void assess_harmonics(Identification& found) {
  constexpr double by_median = 4;
  const Harmonics& harmonics = found.harmonics;
  const Parameters& p = harmonics.model.fundamental;
  const double error = by_median * harmonics.expected_error;
  found.bound = AngleBound{};
  found.bound->harmonics = found.bound->total = error;
  Intervals& half = found.intervals;
  for (double* width : {&half.a1, &half.b1}) *width = std::max(*width, p.a1 * error);
  for (double* width : {&half.a2, &half.b2}) *width = std::max(*width, p.a2 * error);
  half.beta = std::max(half.beta, error);
  found.warning.clear();
  if (harmonics.unbounded.empty()) return;
  found.bound.reset();
  found.warning = "no bound of the angle: " + harmonics.unbounded;
}

}  // namespace capsoc::csfn
