#include "identification/identify.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "identification/assessment.h"
#include "identification/companions.h"
#include "identification/disagreement.h"
#include "identification/method.h"
#include "identification/separation.h"
#include "identification/uncertainty.h"

namespace capsoc::identification {
namespace {

std::optional<Error> check_options(const IdentifyOptions& options) {
  if (!(options.confidence > 0 && options.confidence < 1)) {
    return Error{"the confidence of the intervals must lie between 0 and 1, for instance 0.95"};
  }
  if (options.harmonics.highest < 0 || options.harmonics.highest > 3) {
    return Error{"harmonics are identified up to the third: give 0, 1, 2 or 3"};
  }
  if (auto error = identification::check_options(options.adam)) return error;
  if (options.levenberg_marquardt.iterations <= 0) {
    return Error{"Levenberg-Marquardt needs at least one iteration"};
  }
  return std::nullopt;
}

/// The order of the samples seen through the canonical angle.
Handedness handedness_of(const Scatter& scatter, Eigen::Index count) {
  // Steps of nearly half a turn tell no direction, nor do steps that scatter as widely as they are.
  const double square = scatter.step_length * scatter.step_length;
  const double error = std::sqrt(std::max(1 - square, 0.0) / (2 * static_cast<double>(count)));
  const double step = std::abs(scatter.step);
  if (scatter.step_length < 0.8 || step > 2.8 || step < 4 * error) return Handedness::unknown;
  return scatter.step > 0 ? Handedness::direct : Handedness::reversed;
}

/// Records up to this size are tried with harmonics before that is recommended.
constexpr Eigen::Index tried_with_harmonics = 200'000;

/// What to do about a harmonic that was found and not identified. --harmonics is recommended only
/// where it identifies something.
std::string advice(const Samples& samples, const Identification& found,
                   const HarmonicsOptions& asked) {
  constexpr const char* record =
      "record whole turns at constant speed for --harmonics, or a true angle for --use-angle";
  const int order = found.structure.order - 1;
  if (order < 2 || order > 3) return std::string("; record a true angle for --use-angle");
  if (asked.highest >= 2) return std::string("; ") + record;
  if (samples.u.size() > tried_with_harmonics)
    return "; use --harmonics " + std::to_string(order) + " if the shaft turned at constant speed";
  HarmonicsOptions options;
  options.highest = order;
  const auto tried = identify_harmonics(samples.u, samples.v, found.network_parameters, options);
  if (tried && tried.value().identified) return "; use --harmonics " + std::to_string(order);
  return std::string("; ") + record;
}

}  // namespace

const char* to_string(Handedness handedness) {
  switch (handedness) {
    case Handedness::direct:
      return "direct";
    case Handedness::reversed:
      return "reversed";
    case Handedness::unknown:
      break;
  }
  return "unknown";
}

std::string Identification::rejection() const {
  for (const Gate& gate : gates) {
    if (!gate.passed) return gate.reason;
  }
  return "";
}

Result<Identification> identify(const Samples& all, const IdentifyOptions& options) {
  if (auto error = check_options(options)) return *error;
  Identification found;
  found.method = options.method;
  found.gates = check_record(all.u, all.v, options.gates, options.step);
  if (found.gates.back().name == std::string("clipping"))
    confirm_clipping(all, options, found.gates.back());
  if (found.rejected()) return found;
  const double resolution = resolution_of(all, options);
  found.gates.push_back(check_plateaus(all, resolution, options));
  if (found.rejected()) return found;
  const RobustFit robust = separate(all, resolution, options, found);
  if (found.rejected()) return found;
  const Samples& samples = robust.of(all);
  found.companions = companions_of(samples);
  if (auto gate = apply_method(samples, robust.fit, options, found)) {
    found.gates.push_back(std::move(*gate));
    return found;
  }
  found.parameters = found.network_parameters;
  if (options.method != Method::distances) found.gates.push_back(check_training(found));
  for (Gate& gate : check_answer(samples.u, samples.v, found.network_parameters, options.gates)) {
    found.gates.push_back(std::move(gate));
  }
  found.gates.push_back(check_noise(robust.fit, options.gates.noise));
  const Scatter scatter = scatter_of(samples.u, samples.v, found.network_parameters);
  found.residuals = {scatter.rms, scatter.largest, robust.fit.noise};
  const Intervals explained = assess(samples, robust.fit, resolution, options, found);
  found.handedness = handedness_of(scatter, samples.u.size());
  for (Companion& companion : found.companions) {
    if (!companion.parameters) continue;
    companion.difference = difference_of(*companion.parameters, found.network_parameters);
  }
  found.disagreement = disagreement_of(samples, found, scatter, explained);
  found.harmonics.model.fundamental = found.network_parameters;
  if (found.rejected()) {
    found.harmonics.reason = "no harmonics: the fit was rejected";
    return found;
  }
  Result<Harmonics> harmonics =
      identify_harmonics(samples.u, samples.v, found.network_parameters, options.harmonics);
  if (!harmonics) return Error{harmonics.error()};
  found.harmonics = std::move(harmonics.value());
  found.parameters = found.harmonics.model.fundamental;
  if (found.harmonics.identified)
    assess_harmonics(found);
  else if (found.structure.found && found.structure.order > 0)
    found.warning += advice(samples, found, options.harmonics);
  return found;
}

}  // namespace capsoc::identification
