// Harmonics of the curve that the samples lie on, whatever the motion.
#include <algorithm>
#include <cmath>

#include "identification/harmonics_route.h"
#include "identification/sentence.h"

namespace capsoc::identification {
namespace {

/// Noise relative to the smaller amplitude, for the curve alone.
constexpr double largest_shape_noise = 1e-5;

}  // namespace

Attempt from_the_curve(const Channel& u, const Channel& v, const SignalModel& start, int highest,
                       CurveShape shape) {
  const bool alone = shape == CurveShape::free;
  Attempt attempt;
  attempt.assumption = alone ? Assumption::shape : Assumption::symmetric;
  attempt.check = "structure that the model leaves in the distances (noise: about 3)";
  attempt.limit = largest_structure;
  const CurveFit fit = fit_curve(u, v, start, highest, shape);
  const double scale = std::min(fit.model.fundamental.a1, fit.model.fundamental.a2);
  const double noise = fit.noise / scale;
  attempt.value = noise > rounding_part ? fit.structure : 0;
  attempt.distance = std::max(fit.noise, rounding_part * scale);
  if (!fit.converged ||
      !plausible(fit.model, std::max(start.fundamental.a1, start.fundamental.a2))) {
    attempt.distance = 0;
    attempt.reason = "no curve with these harmonics fits the samples";
    return attempt;
  }
  if (attempt.value > attempt.limit) {
    attempt.reason = text(
        "the curve has more than these harmonics: what is left is no noise (structure %.3g, at "
        "most %.0f)",
        attempt.value, attempt.limit);
    return attempt;
  }
  if (alone && noise > largest_shape_noise) {
    attempt.reason = text(
        "the curve alone tells harmonics only below a noise of %.0e of the amplitude, and it is "
        "%.1e",
        largest_shape_noise, noise);
    return attempt;
  }
  attempt.held = true;
  attempt.model = fit.model;
  attempt.distance = fit.noise;
  attempt.expected_error = expected_error(fit.model, fit.covariance);
  attempt.reason =
      text(alone ? "the noise, %.1e of the amplitude, is low enough for the curve alone"
                 : "both channels have one waveform; noise %.1e of the amplitude",
           noise);
  return attempt;
}

}  // namespace capsoc::identification
