#include "identification/training.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "base/random.h"
#include "identification/fused_network.h"
#include "identification/linear_algebra.h"

namespace capsoc::identification {
namespace {

using Matrix5 = Eigen::Matrix<double, 5, 5>;

/// The largest movement of a node; a1, b1 in units of a1, a2, b2 in units of a2.
double movement(const Nodes& from, const Nodes& to) {
  Nodes unit;
  unit << to[0], to[1], to[0], to[1], 1;
  return (to - from).cwiseQuotient(unit).cwiseAbs().maxCoeff();
}

bool within_range(const Nodes& nodes) {
  return nodes.allFinite() && nodes[0] > 0 && nodes[1] > 0 && std::abs(nodes[4]) < 1;
}

std::optional<Error> check_start(const Parameters& start) {
  if (within_range(to_nodes(start))) return std::nullopt;
  return Error{"the training cannot start there: amplitudes must be positive, |beta| below 90 deg"};
}

/// The samples in random order, batch by batch. They are shuffled as pairs, one place in
/// memory each: with two arrays the swaps were a quarter of a training on 100,000 samples.
class Batches {
 public:
  Batches(const Channel& u, const Channel& v, int64_t batch, uint64_t seed)
      : samples_(u.size()),
        batch_(std::min<int64_t>(batch, u.size())),
        next_(u.size()),
        u_(batch_),
        v_(batch_),
        random_(seed) {
    for (Eigen::Index i = 0; i < u.size(); ++i) samples_[i] = {u[i], v[i]};
  }

  Eigen::Index size() const { return batch_; }
  Eigen::Index in_a_pass() const { return count() / batch_; }

  void advance() {
    next_ += batch_;
    if (next_ + batch_ > count()) {
      shuffle();
      next_ = 0;
    }
    for (Eigen::Index i = 0; i < batch_; ++i) {
      u_[i] = samples_[next_ + i].u;
      v_[i] = samples_[next_ + i].v;
    }
  }
  const Eigen::ArrayXd& u() const { return u_; }
  const Eigen::ArrayXd& v() const { return v_; }

 private:
  struct Pair {
    double u, v;
  };

  Eigen::Index count() const { return static_cast<Eigen::Index>(samples_.size()); }

  void shuffle() {
    for (Eigen::Index i = count() - 1; i > 0; --i)
      std::swap(samples_[i], samples_[random_.index(i + 1)]);
  }

  std::vector<Pair> samples_;
  Eigen::Index batch_, next_;
  Eigen::ArrayXd u_, v_;  // the present batch
  Random random_;
};

/// Samples on 25 degrees around a turning point span 1/100 of the amplitude.
constexpr double largest_magnification = 100;

double half_range(const Channel& channel) {
  return (channel.maxCoeff() - channel.minCoeff()) / 2;
}

Result<Training> finish(const Channel& u, const Channel& v, const Nodes& nodes, Training training) {
  training.parameters = to_parameters(nodes);
  training.loss = FusedNetwork().loss(to_nodes(training.parameters), u, v);
  if (!std::isfinite(training.loss) || !within_range(to_nodes(training.parameters))) {
    return Error{
        "the training diverged: start from an ellipse fit, or use a smaller rate or decay it"};
  }
  // A small arc of a huge ellipse looks like a point: its loss is near 0 wherever the samples are.
  // A start too far from the answer (|beta| from about 1.3 on) can run away along that valley.
  const bool too_large_u = training.parameters.a1 > largest_magnification * half_range(u);
  const bool too_large_v = training.parameters.a2 > largest_magnification * half_range(v);
  if (too_large_u || too_large_v) {
    return Error{
        "the training ran away to an ellipse far larger than the samples: start from an ellipse "
        "fit"};
  }
  return training;
}

/// Trace points of a training whose number of updates is known.
class Tracer {
 public:
  Tracer(const AdamOptions& options, std::vector<TracePoint>& trace)
      : trace_(trace), stride_(0), next_(0) {
    if (options.trace_points <= 0) return;
    trace_.reserve(options.trace_points + 1);
    stride_ = (options.iterations + options.trace_points - 1) / options.trace_points;
    next_ = stride_;
  }

  void add(int iteration, double loss, const Nodes& nodes) {
    if (stride_ == 0) return;
    loss_ += loss;
    ++losses_;
    if (iteration != next_) return;
    trace_.push_back({iteration, loss_ / losses_, to_parameters(nodes)});
    loss_ = losses_ = 0;
    next_ += stride_;
  }

 private:
  std::vector<TracePoint>& trace_;
  int stride_, next_;
  double loss_ = 0, losses_ = 0;
};

/// Whether the undamped step would move anything. Damping alone can make a step small, at the wall
/// |t| = 1 for instance. In a minimum the undamped step vanishes too, but for what the rounding of
/// the loss hides (1e-8).
StopReason judged(const FusedNetwork::Normal& normal, const Nodes& nodes) {
  const double undamped = movement(nodes, nodes + solve_symmetric(normal.jtj, normal.jtr));
  return undamped < 1e-6 ? StopReason::converged : StopReason::stalled;
}

}  // namespace

std::optional<Error> check_options(const AdamOptions& options) {
  const bool good = std::isfinite(options.rate) && options.rate > 0 && options.batch > 0 &&
                    options.iterations > 0 && options.beta1 >= 0 && options.beta1 < 1 &&
                    options.beta2 >= 0 && options.beta2 < 1 && options.epsilon > 0;
  if (good) return std::nullopt;
  return Error{
      "Adam's options are out of range: rate, batch, iterations and epsilon must be positive, "
      "beta1 "
      "and beta2 in [0, 1)"};
}

const char* to_string(StopReason reason) {
  switch (reason) {
    case StopReason::converged:
      return "converged";
    case StopReason::loss_reached:
      return "loss reached";
    case StopReason::stalled:
      return "stalled";
    case StopReason::iteration_limit:
      break;
  }
  return "iteration limit";
}

Parameters paper_start(const Channel& u, const Channel& v) {
  if (u.size() == 0 || v.size() == 0) return {};
  return {u.abs().maxCoeff(), v.abs().maxCoeff(), 0, 0, 0};
}

void Adam::update(Nodes& nodes, const Nodes& gradient, double rate) {
  power1_ *= options_.beta1;
  power2_ *= options_.beta2;
  const double step = rate / (1 - power1_);
  const double correction = 1 / (1 - power2_);
  for (int i = 0; i < 5; ++i) {
    m_[i] = options_.beta1 * m_[i] + (1 - options_.beta1) * gradient[i];
    v_[i] = options_.beta2 * v_[i] + (1 - options_.beta2) * (gradient[i] * gradient[i]);
    nodes[i] -= step * m_[i] / (std::sqrt(v_[i] * correction) + options_.epsilon);
  }
}

AdamOptions decaying_adam() {
  AdamOptions options;
  options.schedule = Schedule::decaying;
  return options;
}

Result<Training> train_adam(const Channel& u, const Channel& v, const Parameters& start,
                            const AdamOptions& options) {
  if (auto error = check_samples(u, v)) return *error;
  if (auto error = check_start(start)) return *error;
  if (auto error = check_options(options)) return *error;
  Batches batches(u, v, options.batch, options.seed);
  const FusedNetwork network;
  Adam adam(options);
  Nodes nodes = to_nodes(start);
  Nodes before = nodes;
  double loss_sum = 0;
  const int64_t period = std::max<int64_t>(batches.in_a_pass(), 100);
  const double decay =
      options.schedule == Schedule::decaying ? std::pow(1e-4, 1.0 / options.iterations) : 1.0;
  double rate = options.rate;
  Training training;
  training.seed = options.seed;
  Tracer tracer(options, training.trace);
  while (training.iterations < options.iterations) {
    batches.advance();
    const FusedNetwork::Gradient gradient = network.gradient(nodes, batches.u(), batches.v());
    loss_sum += gradient.loss;
    adam.update(nodes, gradient.by_nodes, rate);
    rate *= decay;
    ++training.iterations;
    if (!nodes.allFinite()) break;
    tracer.add(training.iterations, gradient.loss, nodes);
    if (training.iterations % period != 0) continue;
    // Both are judged over a whole pass: a single batch may be good by chance.
    const double loss = loss_sum / static_cast<double>(period);
    if (options.loss_target > 0 && loss <= options.loss_target) {
      training.stopped = StopReason::loss_reached;
      break;
    }
    if (movement(before, nodes) < options.convergence) {
      training.stopped = StopReason::converged;
      break;
    }
    before = nodes;
    loss_sum = 0;
  }
  return finish(u, v, nodes, std::move(training));
}

Result<Training> train_levenberg_marquardt(const Channel& u, const Channel& v,
                                           const Parameters& start,
                                           const LevenbergMarquardtOptions& options) {
  if (auto error = check_samples(u, v)) return *error;
  if (auto error = check_start(start)) return *error;
  const FusedNetwork network;
  Nodes nodes = to_nodes(start);
  FusedNetwork::Normal normal = network.normal(nodes, u, v);
  double damping = 1e-3;
  Training training;
  const auto record = [&] {
    if (options.trace) {
      training.trace.push_back({training.iterations, normal.loss, to_parameters(nodes)});
    }
  };
  record();
  while (training.iterations < options.iterations) {
    ++training.iterations;
    Matrix5 damped = normal.jtj;
    damped.diagonal() *= 1 + damping;
    const Nodes candidate = nodes + solve_symmetric(damped, normal.jtr);
    const double moved = movement(nodes, candidate);
    bool accepted = false;
    if (within_range(candidate)) {
      const FusedNetwork::Normal there = network.normal(candidate, u, v);
      accepted = there.loss <= normal.loss;
      if (accepted) {
        nodes = candidate;
        normal = there;
      }
    }
    damping *= accepted ? 0.1 : 10;
    if (accepted) record();
    if (options.loss_target > 0 && normal.loss <= options.loss_target) {
      training.stopped = StopReason::loss_reached;
      break;
    }
    if (!(moved >= options.convergence)) {
      training.stopped = judged(normal, nodes);
      break;
    }
  }
  return finish(u, v, nodes, std::move(training));
}

}  // namespace capsoc::identification
