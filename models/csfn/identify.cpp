#include "csfn/identify.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "csfn/calibration.h"
#include "csfn/circle_plane.h"
#include "csfn/distributions.h"
#include "csfn/ellipse_fit.h"
#include "csfn/fused_network.h"
#include "csfn/linear_algebra.h"
#include "csfn/robust_fit.h"
#include "csfn/sentence.h"
#include "csfn/uncertainty.h"
#include "support/constants.h"

namespace capsoc::csfn {
namespace {

/// Adam's first steps are as long as its rate however small the gradient is: from a start that is
/// all but the answer, the paper's 0.01 would throw an amplitude of 0.02 out again.
constexpr double rate_near_minimum = 0.01;
/// Points of Adam's convergence trace.
constexpr int trace_points = 500;
/// Fits that agree to this agree, whatever the intervals say.
constexpr double agreement = 1e-9;
/// A training is not at its end when an ellipse fit has a loss this much lower.
constexpr double worse = 1.05;
/// Losses below are rounding: 1 - Y of a dozen operations, squared.
constexpr double rounding_loss = 1e-24;
/// Harmonics stand out when the residual's third or fourth order has this much of the power that
/// noise would spread over all orders.
constexpr double standing_out = 30;

std::optional<Error> check_options(const IdentifyOptions& options) {
  if (!(options.confidence > 0 && options.confidence < 1)) {
    return Error{"the confidence of the intervals must lie between 0 and 1, for instance 0.95"};
  }
  if (options.harmonics.highest < 0 || options.harmonics.highest > 3) {
    return Error{"harmonics are identified up to the third: give 0, 1, 2 or 3"};
  }
  if (auto error = csfn::check_options(options.adam)) return error;
  if (options.levenberg_marquardt.iterations <= 0) {
    return Error{"Levenberg-Marquardt needs at least one iteration"};
  }
  return std::nullopt;
}

/// The largest of the differences, in units that make them comparable.
double difference_of(const Parameters& one, const Parameters& other) {
  return std::max({std::abs(one.a1 - other.a1) / other.a1, std::abs(one.a2 - other.a2) / other.a2,
                   std::abs(one.b1 - other.b1) / other.a1, std::abs(one.b2 - other.b2) / other.a2,
                   std::abs(one.beta - other.beta)});
}

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

std::vector<Companion> companions_of(const Samples& samples) {
  const Result<Moments> moments = moments_of(samples.u, samples.v);
  if (!moments) return {};
  return {companion_of(Method::heydemann, fit_heydemann(moments.value()), samples),
          companion_of(Method::taubin, fit_taubin(moments.value()), samples),
          companion_of(Method::direct, fit_direct(moments.value()), samples)};
}

/// The companion with the smallest loss.
const Companion* best_of(const std::vector<Companion>& companions) {
  const Companion* best = nullptr;
  for (const Companion& companion : companions) {
    if (!companion.parameters || !std::isfinite(companion.loss)) continue;
    if (best == nullptr || companion.loss < best->loss) best = &companion;
  }
  return best;
}

/// A training that ended above this loss did not end in the minimum.
double floor_of(const Companion& best) {
  return 2 * best.loss + rounding_loss;
}

/// Means and standard deviations: an ellipse with its axes along the channels.
Parameters moment_start(const Samples& samples) {
  const double mean_u = samples.u.mean(), mean_v = samples.v.mean();
  const double a1 = std::sqrt(2 * (samples.u - mean_u).square().mean());
  const double a2 = std::sqrt(2 * (samples.v - mean_v).square().mean());
  const double correlation = ((samples.u - mean_u) / a1 * ((samples.v - mean_v) / a2)).mean() * 2;
  return {a1, a2, mean_u, mean_v, -std::asin(std::clamp(correlation, -0.99, 0.99))};
}

struct Trained {
  Result<Training> training = Error{"no training"};
  Start start = Start::ellipse;
};

bool settled(const Result<Training>& training) {
  return training && (training.value().stopped == StopReason::converged ||
                      training.value().stopped == StopReason::loss_reached);
}

/// From the ellipse fits, then from the moments, then from the paper's start; the first that ends
/// in a minimum no worse than the ellipse fits, else the one with the smallest loss.
Trained second_order(const Samples& samples, const std::vector<Companion>& companions,
                     const LevenbergMarquardtOptions& options) {
  std::vector<std::pair<Start, Parameters>> starts;
  const Companion* best = best_of(companions);
  if (best != nullptr) starts.emplace_back(Start::ellipse, *best->parameters);
  starts.emplace_back(Start::ellipse, moment_start(samples));
  starts.emplace_back(Start::paper, paper_start(samples.u, samples.v));
  Trained answer;
  for (const auto& [start, from] : starts) {
    Result<Training> training = train_levenberg_marquardt(samples.u, samples.v, from, options);
    const bool done =
        settled(training) &&
        (best == nullptr || training.value().loss <= best->loss * worse + rounding_loss);
    const bool better =
        training && (!answer.training || training.value().loss < answer.training.value().loss);
    if (better || (!answer.training && !training)) answer = {std::move(training), start};
    if (done) break;
  }
  return answer;
}

Trained by_first_order(const Samples& samples, const std::vector<Companion>& companions,
                       const IdentifyOptions& options) {
  AdamOptions adam = options.adam;
  if (options.trace && adam.trace_points == 0) adam.trace_points = trace_points;
  const Companion* best = best_of(companions);
  if (options.start != Start::ellipse) {
    Trained trained = {train_adam(samples.u, samples.v, paper_start(samples.u, samples.v), adam),
                       Start::paper};
    const bool reached =
        trained.training && (best == nullptr || trained.training.value().loss <= floor_of(*best) ||
                             trained.training.value().stopped == StopReason::loss_reached);
    if (reached || options.start == Start::paper) return trained;
  }
  const Parameters start = best != nullptr ? *best->parameters : moment_start(samples);
  if (options.start == Start::automatic) adam.rate *= rate_near_minimum;
  return {train_adam(samples.u, samples.v, start, adam), Start::ellipse};
}

Gate failed_gate(const char* name, std::string reason) {
  return {name, false, 0, 0, std::move(reason)};
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
  if (trained && best != nullptr && found.loss > worse * best->loss + rounding_loss) {
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

/// half: what noise explains, without the difference itself.
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

/// Whether the training got where an ellipse fit shows that there is something to get to.
Gate check_training(const Identification& found) {
  Gate gate = {"training", true, found.loss, HUGE_VAL, ""};
  const Companion* best = best_of(found.companions);
  if (best == nullptr) {
    gate.passed =
        found.stopped == StopReason::converged || found.stopped == StopReason::loss_reached;
    if (!gate.passed) {
      gate.reason = std::string("the training ended with \"") + to_string(found.stopped) +
                    "\" and no ellipse fit confirms it: allow more iterations";
    }
    return gate;
  }
  // A loss on the floor of rounding still means a difference that can be seen: the network's valley
  // is flat for large |beta|.
  gate.limit = floor_of(*best);
  gate.passed = found.loss <= gate.limit;
  if (found.stopped == StopReason::loss_reached) gate.passed = true;
  if (!gate.passed) {
    gate.reason = text("the training ended at a loss of %.2e where an ellipse has %.2e (",
                       found.loss, best->loss) +
                  to_string(found.stopped) +
                  "): start from the ellipse, allow more iterations or use lm";
  }
  return gate;
}

/// Rounding of the samples' last digits, in units of the record's largest value.
constexpr double arithmetic = 1e-14;

/// Distances that say nothing: the converter's step, or the arithmetic.
double resolution_of(const Samples& samples, const IdentifyOptions& options) {
  const double largest = std::max(samples.u.abs().maxCoeff(), samples.v.abs().maxCoeff());
  return std::max(options.step, arithmetic * largest);
}

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

/// The failed gate of a plateau that lies inside the ellipse of the other samples; otherwise the
/// last one passed.
Gate check_plateaus(const Samples& samples, double resolution, const IdentifyOptions& options) {
  Gate gate = {"plateau", true, 0, 0, ""};
  for (const Plateau& plateau : plateaus_of(samples.u, samples.v, options.step)) {
    const Samples others = without(samples, plateau.places);
    if (others.u.size() < 12 || check_samples(others.u, others.v)) continue;
    const auto start = robust_start(others.u, others.v);
    if (!start) continue;
    const RobustFit robust = fit_robustly(others.u, others.v, *start, resolution);
    if (!robust.fit.converged) continue;
    gate = check_plateau(samples.u, samples.v, plateau, robust.fit.parameters, robust.fit.noise,
                         resolution);
    if (!gate.passed) break;
  }
  return gate;
}

/// Gates of what belongs to the ellipse; fills in the outliers. `kept`: the others.
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
  Gate distances = {"distances", robust.fit.converged, robust.fit.noise, HUGE_VAL, ""};
  if (!robust.fit.converged) {
    distances.reason =
        "no ellipse fits the samples by their distances: record more samples, more of the turn, or "
        "with less noise";
  }
  found.gates.push_back(std::move(distances));
  return robust;
}

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

/// What the answer vouches for. Returns what noise alone explains.
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

/// With harmonics the angle's expected error is the harmonics' own (a median).
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
}

/// Fills in the method's parameters; a gate when there are none.
std::optional<Gate> train(const Samples& samples, const DistanceFit& fit,
                          const IdentifyOptions& options, Identification& found) {
  if (options.method == Method::distances) {
    found.network_parameters = fit.parameters;
    found.iterations = fit.iterations;
    found.start = Start::ellipse;
    found.loss = FusedNetwork().loss(to_nodes(fit.parameters), samples.u, samples.v);
    return std::nullopt;
  }
  if (options.method != Method::adam && options.method != Method::levenberg_marquardt) {
    for (const Companion& companion : found.companions) {
      if (companion.method != options.method) continue;
      if (!companion.parameters) return failed_gate("fit", companion.error);
      found.network_parameters = *companion.parameters;
      found.loss = companion.loss;
    }
    return std::nullopt;
  }
  LevenbergMarquardtOptions second = options.levenberg_marquardt;
  second.trace = options.trace;
  Trained trained = options.method == Method::adam
                        ? by_first_order(samples, found.companions, options)
                        : second_order(samples, found.companions, second);
  found.start = trained.start;
  found.seed = options.method == Method::adam ? options.adam.seed : 0;
  if (!trained.training) return failed_gate("training", trained.training.error());
  Training& training = trained.training.value();
  found.network_parameters = training.parameters;
  found.loss = training.loss;
  found.iterations = training.iterations;
  found.stopped = training.stopped;
  found.convergence = std::move(training.trace);
  return std::nullopt;
}

}  // namespace

const char* to_string(Method method) {
  switch (method) {
    case Method::distances:
      return "ml";
    case Method::adam:
      return "adam";
    case Method::levenberg_marquardt:
      return "lm";
    case Method::heydemann:
      return "heydemann";
    case Method::taubin:
      return "taubin";
    case Method::direct:
      break;
  }
  return "direct";
}

std::optional<Method> method_from(const std::string& name) {
  for (const Method method : {Method::distances, Method::adam, Method::levenberg_marquardt,
                              Method::heydemann, Method::taubin, Method::direct}) {
    if (name == to_string(method)) return method;
  }
  return std::nullopt;
}

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
  if (found.rejected()) return found;
  const double resolution = resolution_of(all, options);
  found.gates.push_back(check_plateaus(all, resolution, options));
  if (found.rejected()) return found;
  const RobustFit robust = separate(all, resolution, options, found);
  if (found.rejected()) return found;
  const Samples& samples = robust.kept;
  found.companions = companions_of(samples);
  if (auto gate = train(samples, robust.fit, options, found)) {
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
  found.structure = structure_of(samples.u, samples.v, robust.fit, resolution);
  const Intervals explained = assess(samples, robust.fit, options, found);
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
  if (found.harmonics.identified) assess_harmonics(found);
  return found;
}

}  // namespace capsoc::csfn
