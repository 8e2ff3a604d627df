#include "identification/method.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "identification/calibration.h"
#include "identification/companions.h"
#include "identification/fused_network.h"
#include "identification/sentence.h"

namespace capsoc::identification {
namespace {

/// Adam's first steps are as long as its rate however small the gradient is: from a start that is
/// all but the answer, the paper's 0.01 would throw an amplitude of 0.02 out again.
constexpr double rate_near_minimum = 0.01;
/// Points of Adam's convergence trace.
constexpr int trace_points = 500;

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
        (best == nullptr || training.value().loss <= best->loss * worse_loss + rounding_loss);
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

}  // namespace

std::optional<Gate> apply_method(const Samples& samples, const DistanceFit& fit,
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

}  // namespace capsoc::identification
