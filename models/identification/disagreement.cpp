#include "identification/disagreement.h"

#include <algorithm>
#include <cmath>

#include "identification/companions.h"
#include "identification/fused_network.h"
#include "identification/linear_algebra.h"
#include "identification/sentence.h"

namespace capsoc::identification {
namespace {

/// Fits that agree to this agree, whatever the intervals say.
constexpr double agreement = 1e-9;
/// Harmonics stand out when the residual's third or fourth order has this much of the power that
/// noise would spread over all orders.
constexpr double standing_out = 30;

/// How far a full Gauss-Newton step would still move the parameters, in the units of
/// difference_of().
double unsettled(const Samples& samples, const Parameters& parameters) {
  const Nodes nodes = to_nodes(parameters);
  const auto normal = FusedNetwork().normal(nodes, samples.u, samples.v);
  const Nodes there = nodes + solve_symmetric(normal.jtj, normal.jtr);
  return difference_of(to_parameters(there), parameters);
}

/// Why fits of the same samples differ.
std::string reason_of(const Samples& samples, const Identification& found, const Scatter& scatter,
                      const Companion* best, double difference) {
  const bool trained = found.iterations > 0 && found.method != Method::distances;
  if (trained && best != nullptr && found.loss > worse_loss * best->loss + rounding_loss) {
    return text("the training is not at its end: its loss is %.2e, the ellipse fit's %.2e",
                found.loss, best->loss);
  }
  // The batches' noise keeps Adam from settling; the rest is as for the other methods.
  const double rest = unsettled(samples, found.network_parameters);
  if (found.method == Method::adam && rest > difference / 3) {
    return text(
        "the training has not settled: a full step would still move a parameter by %.1e "
        "(take more iterations, a larger batch or lm)",
        rest);
  }
  const auto count = static_cast<double>(samples.u.size());
  for (const int order : {3, 4}) {
    const double power = scatter.order[order] / std::max(scatter.rms, 1e-300);
    if (scatter.rms > 1e-11 && count * power * power > standing_out) {
      return text(
          "harmonics: the distance from the ellipse repeats %.0f times a turn with an "
          "amplitude of %.2g",
          order, 2 * scatter.order[order]);
    }
  }
  for (const Gate& gate : found.gates) {
    if (gate.name == "gap" && gate.value > 45) {
      return text(
          "partial arc: %.0f degrees of the turn have no sample, which leaves the fits to "
          "the noise",
          gate.value);
    }
  }
  return text("noise of %.1e of the amplitude, which each fit weighs in its own way", scatter.rms);
}

}  // namespace

std::string disagreement_of(const Samples& samples, const Identification& found,
                            const Scatter& scatter, const Intervals& half) {
  const Parameters& p = found.network_parameters;
  const double explained = std::max(
      {half.a1 / p.a1, half.b1 / p.a1, half.a2 / p.a2, half.b2 / p.a2, half.beta, agreement});
  const Companion* farthest = nullptr;
  for (const Companion& companion : found.companions) {
    if (!companion.parameters || companion.difference <= explained) continue;
    if (farthest == nullptr || companion.difference > farthest->difference) farthest = &companion;
  }
  if (farthest == nullptr) return "";
  return std::string(to_string(farthest->method)) +
         text(" differs by %.2e, the intervals explain %.1e: ", farthest->difference, explained) +
         reason_of(samples, found, scatter, best_of(found.companions), farthest->difference);
}

}  // namespace capsoc::identification
