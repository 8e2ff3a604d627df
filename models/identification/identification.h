// Options and result of an identification.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "identification/certainty.h"
#include "identification/correlation.h"
#include "identification/gates.h"
#include "identification/harmonics.h"
#include "identification/positions.h"
#include "identification/samples.h"
#include "identification/steadiness.h"
#include "identification/training.h"

namespace capsoc::identification {

enum class Method {
  distances,  ///< maximum likelihood with the bias of noise taken off (distance_fit.h)
  adam,
  levenberg_marquardt,
  heydemann,
  taubin,
  direct
};

/// "ml", "adam", "lm", "heydemann", "taubin", "direct": as on the command line.
const char* to_string(Method method);
std::optional<Method> method_from(const std::string& name);

enum class Start {
  /// The paper's; when that does not reach the minimum again from the ellipse, with a hundredth
  /// of the rate.
  automatic,
  paper,    ///< amplitudes max|U| and max|V|, the rest 0
  ellipse,  ///< Taubin's fit, or what comes nearest to it
};

struct IdentifyOptions {
  Method method = Method::distances;
  /// Where Adam starts. From the paper's start it does not reach every beta beyond 1 rad, nor
  /// amplitudes far below the offset. Levenberg-Marquardt always starts from the ellipse and tries
  /// the paper's start when that fails.
  Start start = Start::automatic;
  /// The paper's rate, batch and 20,000 iterations, the rate decaying: without the decay Adam is
  /// thrown out of the minimum now and then.
  AdamOptions adam = decaying_adam();
  LevenbergMarquardtOptions levenberg_marquardt;
  HarmonicsOptions harmonics;
  GateLimits gates;
  double confidence = 0.95;  ///< of the intervals, 0..1 exclusive
  double step = 0;           ///< of the converter, unit of the samples; 0: not known
  bool trace = false;        ///< fill Identification::convergence
};

/// How far the samples are from the identified curve.
struct Residuals {
  double rms = 0;      ///< of 1 - Y, Eq (15): relative to the size of the ellipse
  double largest = 0;  ///< of |1 - Y|
  double noise = 0;    ///< standard deviation of each channel in the unit of the samples
};

/// A closed-form fit of the same samples.
struct Companion {
  Method method = Method::taubin;
  std::optional<Parameters> parameters;  ///< nothing: see error
  std::string error;
  double loss = 0;        ///< mean of (1 - Y)^2
  double difference = 0;  ///< from the answer: largest of the amplitudes' and offsets' relative to
                          ///< the channel's amplitude and of beta's in radians
};

/// How the angle of the canonical parameters runs with the order of the samples.
enum class Handedness { direct, reversed, unknown };
/// "direct", "reversed", "unknown".
const char* to_string(Handedness handedness);

struct Identification {
  /// The answer, canonical (see Parameters): the fundamentals of `harmonics.model` when harmonics
  /// were identified, otherwise the network's. Meaningless when rejected() and no training ended.
  Parameters parameters;
  Parameters network_parameters;  ///< what the five-parameter network (or closed form) found
  /// Of network_parameters, by any method about its own answer; of `parameters` when harmonics were
  /// identified.
  Intervals intervals;
  /// Of the angle over the whole turn. Nothing when harmonics were found and not identified: what
  /// they do to the angle is not in the samples' distances alone.
  std::optional<AngleBound> bound;
  /// One sentence when harmonics were found that were not asked for. Empty otherwise.
  std::string warning;
  /// Why `intervals` is not to be used: a drift, one-sided noise, noise that is correlated over too
  /// much of the record, or an arc that is too short. Empty: it is.
  std::string no_intervals;
  /// Sentences on what the samples are: correlated noise, few angles, a part of the turn.
  std::vector<std::string> notes;
  Structure structure;
  Coverage coverage;
  Positions positions;
  NoiseCorrelation correlation;
  /// By how much correlated noise widens the widest interval; 1 without.
  double widening = 1;
  SensorDrift drift;
  OneSided one_sided;
  /// Samples left out, places in the record, and how far they are from the ellipse in units of the
  /// noise.
  std::vector<Eigen::Index> outliers;
  double nearest_outlier = 0, farthest_outlier = 0;
  /// Reversed: with this order of samples beta of Eq (3) is pi - beta and the angle falls, as with
  /// the SoC paper's 3.0796. Unknown: the order tells nothing (shuffled samples).
  Handedness handedness = Handedness::unknown;

  Method method = Method::distances;
  Start start = Start::paper;  ///< paper or ellipse: where the training that gave the answer began
  int iterations = 0;          ///< 0 for the closed forms
  StopReason stopped = StopReason::converged;
  uint64_t seed = 0;
  double loss = 0;  ///< mean of (1 - Y)^2 of network_parameters, Eq (15)
  Residuals residuals;

  std::vector<Gate> gates;            ///< in the order they were applied
  std::vector<Companion> companions;  ///< Heydemann, Taubin, direct, whatever the method
  /// One sentence when the answer and a companion differ by more than the intervals explain: by how
  /// much and why (training not at its end, harmonics, partial arc, noise). Empty when they agree.
  std::string disagreement;
  Harmonics harmonics;
  std::vector<TracePoint> convergence;  ///< empty without IdentifyOptions::trace

  /// The first failed gate's reason; empty when the identification may be used.
  std::string rejection() const;
  bool rejected() const { return !rejection().empty(); }
};

}  // namespace capsoc::identification
