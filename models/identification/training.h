// Training of the network: Adam as in the CSFN paper, and Levenberg-Marquardt on the same residual.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/result.h"
#include "identification/network.h"
#include "identification/samples.h"

namespace capsoc::identification {

enum class StopReason {
  converged,        ///< the parameters no longer move
  loss_reached,     ///< the mean loss fell to loss_target
  stalled,          ///< the steps have become small, but this is no minimum: start elsewhere
  iteration_limit,  ///< neither, in all the iterations that were allowed
};

/// "converged", "loss reached", "stalled" or "iteration limit".
const char* to_string(StopReason reason);

/// The state after a number of iterations.
struct TracePoint {
  int iteration = 0;
  double loss =
      0;  ///< mean over the batches since the last point (Levenberg-Marquardt: all samples)
  Parameters parameters;
};

struct Training {
  Parameters parameters;
  double loss = 0;     ///< mean of (1 - Y)^2 over all samples, Eq (15)
  int iterations = 0;  ///< updates of the parameters (Levenberg-Marquardt: attempted ones)
  StopReason stopped = StopReason::iteration_limit;
  uint64_t seed = 0;              ///< of the shuffling; 0 for Levenberg-Marquardt
  std::vector<TracePoint> trace;  ///< empty unless the options ask for it
};

enum class Schedule {
  constant,  ///< the paper's
  decaying,  ///< falls exponentially to 1e-4 of the rate at the iteration limit
};

/// Eq (17) with the rate and batch of the paper's section 4.1.
struct AdamOptions {
  double rate = 0.01;
  double beta1 = 0.9, beta2 = 0.999, epsilon = 1e-8;
  Schedule schedule = Schedule::constant;
  int64_t batch = 100;  ///< samples; more than there are means all
  int iterations = 20000;
  uint64_t seed = 1;
  /// Stop when no node moved by more than this in one pass over the samples (and at least 100
  /// iterations); offsets and amplitudes relative to the channel's amplitude. 0: never.
  double convergence = 1e-14;
  /// Stop when the mean loss of one such pass is at most this. 0: never.
  double loss_target = 0;
  int trace_points = 0;  ///< Training::trace has at most this many, evenly spaced
};

/// The paper's options with the rate decaying, which reaches machine precision on clean samples.
AdamOptions decaying_adam();

/// The update of Eq (18): m_hat = m/(1 - beta1^k), v_hat = v/(1 - beta2^k).
class Adam {
 public:
  /// The options must outlive it.
  explicit Adam(const AdamOptions& options) : options_(options) {}

  void update(Nodes& nodes, const Nodes& gradient, double rate);

 private:
  const AdamOptions& options_;
  Nodes m_ = Nodes::Zero();
  Nodes v_ = Nodes::Zero();
  double power1_ = 1, power2_ = 1;
};

struct LevenbergMarquardtOptions {
  int iterations = 100;
  double convergence = 1e-14;  ///< largest step, measured as in AdamOptions
  double loss_target = 0;      ///< 0: never
  bool trace = false;          ///< Training::trace has a point for every accepted step
};

/// The paper's initialisation (section 4.1): amplitudes max|U| and max|V|, the rest 0.
Parameters paper_start(const Channel& u, const Channel& v);

/// Nothing when train_adam() takes the options.
std::optional<Error> check_options(const AdamOptions& options);

/// Adam, Eq (18). Batches are drawn without replacement; the rest of a pass that does not fill a
/// batch is left out and shuffled in again. Errors: those of check_samples(), options or a start
/// out of range, and a training that diverged or ran away to an ellipse
/// more than 100 times as large as the samples.
Result<Training> train_adam(const Channel& u, const Channel& v, const Parameters& start,
                            const AdamOptions& options = {});

/// Levenberg-Marquardt on the residuals 1 - Y of all samples, with Marquardt's scaling. Errors as
/// for train_adam().
Result<Training> train_levenberg_marquardt(const Channel& u, const Channel& v,
                                           const Parameters& start,
                                           const LevenbergMarquardtOptions& options = {});

}  // namespace capsoc::identification
