#include "identification/companions.h"

#include <algorithm>
#include <cmath>

#include "identification/ellipse_fit.h"
#include "identification/fused_network.h"

namespace capsoc::identification {
namespace {

Companion companion_of(Method method, const Result<Parameters>& fit, const Samples& samples) {
  Companion companion;
  companion.method = method;
  if (!fit) {
    companion.error = fit.error();
    return companion;
  }
  companion.parameters = fit.value();
  companion.loss = FusedNetwork().loss(to_nodes(fit.value()), samples.u, samples.v);
  return companion;
}

}  // namespace

double difference_of(const Parameters& one, const Parameters& other) {
  return std::max({std::abs(one.a1 - other.a1) / other.a1, std::abs(one.a2 - other.a2) / other.a2,
                   std::abs(one.b1 - other.b1) / other.a1, std::abs(one.b2 - other.b2) / other.a2,
                   std::abs(one.beta - other.beta)});
}

std::vector<Companion> companions_of(const Samples& samples) {
  const Result<Moments> moments = moments_of(samples.u, samples.v);
  if (!moments) return {};
  return {companion_of(Method::heydemann, fit_heydemann(moments.value()), samples),
          companion_of(Method::taubin, fit_taubin(moments.value()), samples),
          companion_of(Method::direct, fit_direct(moments.value()), samples)};
}

const Companion* best_of(const std::vector<Companion>& companions) {
  const Companion* best = nullptr;
  for (const Companion& companion : companions) {
    if (!companion.parameters || !std::isfinite(companion.loss)) continue;
    if (best == nullptr || companion.loss < best->loss) best = &companion;
  }
  return best;
}

double floor_of(const Companion& best) {
  return 2 * best.loss + rounding_loss;
}

}  // namespace capsoc::identification
