#include "identification/assessment.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "base/constants.h"
#include "identification/circle_plane.h"
#include "identification/sentence.h"

namespace capsoc::identification {
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
  if (structure.order == 0)
    return text(
        "the intervals do not hold: the distance from the ellipse depends on the angle, by %.2g %% "
        "of the amplitude: harmonics, or a sensor that is no ellipse; "
        "record more of the turn to tell which",
        100 * structure.amplitude);
  // Harmonics of the same size in both channels, at any phases, leave an amplitude of h/sqrt(2).
  return text(
             "the intervals do not hold: the samples' distance from the ellipse repeats %.0f times "
             "a turn, as a harmonic of %.2g %% of the amplitude leaves it",
             structure.order, 100 * std::sqrt(2.0) * structure.amplitude) +
         (structure.order <= 4
              ? " (order " + std::to_string(structure.order - 1) + " or " +
                    std::to_string(structure.order + 1) + ")"
              : " (order " + std::to_string(structure.order - 1) + " or " +
                    std::to_string(structure.order + 1) + ", beyond what --harmonics identifies)");
}

/// Noise that continues between samples makes this many independent ones of a record, at least, for
/// intervals to hold.
constexpr double fewest_independent = 25;
/// How far slow noise strays from its mean, in standard deviations.
constexpr double slow_reach = 3;
/// Intervals are taken from derivatives at the answer: beyond this relative error of an amplitude,
/// or of the circle's place in radii, they no longer describe the samples.
constexpr double largest_relative_error = 0.03;

double largest_ratio(const Eigen::Matrix<double, 5, 5>& one,
                     const Eigen::Matrix<double, 5, 5>& other) {
  return (one.diagonal().array() / other.diagonal().array()).maxCoeff();
}

/// Third powers of noise remember less than noise does.
double memory_of_cubes(const NoiseCorrelation& noise) {
  double all = noise.white, memory = 0;
  for (const auto& part : noise.parts) all += part.variance;
  for (const auto& part : noise.parts) memory += part.variance / all * part.samples;
  return 1 + 2 * memory;
}

/// A sensor that settles can look like noise that wanders.
bool wanders(const Identification& found) {
  return found.drift.found || found.correlation.slow > 0;
}

/// Tests what the fit leaves, and what they say of the covariance.
Evidence evidence_of(const Samples& samples, const DistanceFit& fit, double resolution,
                     Identification& found) {
  Evidence evidence;
  evidence.answer = found.network_parameters;
  evidence.fit = fit;
  evidence.count = static_cast<double>(samples.u.size());
  evidence.covariance = fit.covariance;
  evidence.freedom = evidence.count - 5;
  found.coverage = coverage_of(samples.u, samples.v, found.network_parameters);
  found.positions = positions_of(samples.u, samples.v, fit);
  Scores scores = scores_of(samples.u, samples.v, fit);
  DistanceFit seen = fit;
  const ScoreMatrix* covariance = nullptr;
  ScoreMatrix of_sums;
  if (found.positions.scattered()) {
    scores = of_means(scores, found.positions);
    evidence.freedom = scores.count - 5;
    seen.noise = std::sqrt(scores.square / evidence.freedom);
    const double share = evidence.count / scores.count;
    evidence.covariance = fit.unit_covariance * (seen.noise * seen.noise * share);
  }
  found.structure = structure_of(scores, seen, resolution);
  if (!found.positions.scattered())
    found.correlation = correlation_of(samples.u, samples.v, fit, scores, found.structure);
  if (found.correlation.found) {
    of_sums =
        covariance_of_sums(samples.u, samples.v, CirclePlane(fit.parameters), found.correlation);
    covariance = &of_sums;
    found.structure = structure_of(scores, seen, resolution, covariance);
    const Eigen::Matrix<double, 5, 5> excess =
        of_sums.topLeftCorner<5, 5>() -
        fit.noise * fit.noise * scores.information.topLeftCorner<5, 5>();
    evidence.covariance += fit.unit_covariance * excess * fit.unit_covariance;
    const double widening = largest_ratio(evidence.covariance, fit.covariance);
    found.widening = std::sqrt(widening);
    evidence.freedom = std::max(evidence.count / std::max(widening, 1.0) - 5, 1.0);
  }
  found.drift = sensor_drift_of(scores, seen, found.structure, covariance);
  if (wanders(found)) follow_drift(scores, seen, found.structure, found.drift);
  // What wanders slower than the shaft turns looks like a harmonic; as an amplitude it stays in the
  // bound.
  if (wanders(found)) found.structure.found = false;
  if (!found.positions.scattered() && !found.structure.found)
    found.one_sided = one_sided(
        scores, memory_of_cubes(found.correlation) * std::max(found.positions.lack_of_fit, 1.0),
        fit.noise * CirclePlane(fit.parameters).largest_slope());
  evidence.structure = found.structure;
  evidence.coverage = found.coverage;
  evidence.drift = found.drift.angle + slow_reach * std::sqrt(found.correlation.slow) *
                                           CirclePlane(fit.parameters).largest_slope();
  return evidence;
}

/// Lack of fit beyond that is of samples that are the same, not of samples that scatter.
constexpr double repeats_are_equal = 1e6;

void note(Identification& found) {
  const Positions& positions = found.positions;
  if (positions.count > 0 && found.structure.last_order == 0)
    found.notes.push_back(
        text("the samples are of %.0f angles, which leave nothing to test for harmonics: "
             "record more angles",
             positions.count));
  else if (positions.scattered() && positions.lack_of_fit > repeats_are_equal)
    found.notes.push_back(
        text("the samples are of %.0f angles and repeat there to the last digit: the "
             "intervals count each angle once",
             positions.count));
  else if (positions.scattered())
    found.notes.push_back(text(
        "the samples are of %.0f angles, which lie %.2g times as far from the ellipse as their "
        "repeats explain: the intervals count each angle once",
        positions.count, std::sqrt(positions.lack_of_fit)));
  else if (positions.count > 0)
    found.notes.push_back(text("the samples are of %.0f angles", positions.count));
  if (found.correlation.found)
    found.notes.push_back(text(
        "the noise is correlated, %.2g from one sample to the next: the intervals are up to %.2g "
        "times as wide as those of independent noise",
        found.correlation.of_neighbours(), std::max(found.widening, 1.0)));
}

std::string sentence_of(const SensorDrift& drift, const Parameters& p) {
  const std::pair<double, const char*> changes[] = {{drift.change.a1 / p.a1, "a1"},
                                                    {drift.change.a2 / p.a2, "a2"},
                                                    {drift.change.b1 / p.a1, "b1"},
                                                    {drift.change.b2 / p.a2, "b2"},
                                                    {drift.change.beta, "beta"}};
  const auto& [largest, name] = *std::max_element(std::begin(changes), std::end(changes));
  const bool angle = std::string(name) == "beta";
  return "the sensor or its noise drifts during the record: " + std::string(name) +
         (angle ? text(" changes by %.2g rad", largest)
                : text(" changes by %.2g %% of the amplitude", 100 * largest)) +
         "; record for a shorter time, or when it has warmed up";
}

std::string reason_against_intervals(const Evidence& evidence, const Identification& found) {
  if (found.drift.found) return sentence_of(found.drift, found.network_parameters);
  if (found.one_sided.found)
    return text(
        "the noise reaches farther to one side than to the other (skewness %.2g): outliers "
        "within the noise pull the ellipse; find what disturbs the samples",
        found.one_sided.skewness);
  if (found.correlation.found && evidence.freedom + 5 < fewest_independent)
    return text(
        "the noise is correlated over too much of the record: it is worth %.0f independent "
        "samples; record for longer",
        evidence.freedom + 5);
  // What harmonics leave beyond the highest order looks like that as well; a warning names them.
  if (found.correlation.of_all_memories && !found.structure.found)
    return text(
        "the noise is of short and long memory alike, like 1/f noise (%.2g from one sample to the "
        "next), and may hide errors of offsets; record for ten "
        "times as long, or filter the supply",
        found.correlation.of_neighbours());
  if (found.correlation.slow > 0)
    return text(
        "the noise wanders as slowly as the record is long, by %.2g %% of the amplitude: the "
        "offsets may be further off than it tells; record for ten times as long, or filter "
        "the supply",
        100 * std::sqrt(found.correlation.slow) *
            CirclePlane(evidence.fit.parameters).largest_slope());
  const double relative = std::sqrt(evidence.covariance.diagonal().maxCoeff());
  if (relative > largest_relative_error)
    return text(
        "the samples cover %.0f degrees, too little of the turn for their noise: the ellipse is "
        "uncertain by %.2g %%",
        360 * found.coverage.part, 100 * relative);
  return "";
}

/// Refuses a record that determines the angle too poorly. Hidden harmonics are part of the bound
/// and refuse no record.
void check_bound(double limit, Identification& found) {
  const double turn = found.bound->parameters * 180 / pi;
  const double arc = found.bound->arc.parameters * 180 / pi;
  Gate gate = {"bound", arc <= limit, arc, limit, ""};
  if (!gate.passed) {
    gate.reason =
        text(
            "the samples cover %.0f degrees of the turn and tell the angle there to %.2g degrees "
            "only",
            found.bound->arc_degrees, arc) +
        text(" (at most %.2g): record more samples, more of the turn, or with less noise", limit);
  } else if (turn > limit) {
    found.notes.push_back(text(
        "the answer is for the %.0f degrees that the samples cover: over the whole turn the angle "
        "is uncertain by %.2g degrees",
        found.bound->arc_degrees, std::min(turn, 180.0)));
  }
  found.gates.push_back(std::move(gate));
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

Intervals assess(const Samples& samples, const DistanceFit& fit, double resolution,
                 const IdentifyOptions& options, Identification& found) {
  Evidence evidence = evidence_of(samples, fit, resolution, found);
  evidence.resolution = options.step / std::sqrt(12.0);
  if (fit.noise < 2 * options.step) evidence.repeated = repeated_part(samples);
  found.intervals = intervals_of(evidence, options.confidence);
  Evidence of_noise = evidence;
  of_noise.answer = fit.parameters;
  of_noise.structure = {};
  const Intervals explained = intervals_of(of_noise, options.confidence);
  note(found);
  found.no_intervals = reason_against_intervals(evidence, found);
  if (found.structure.found) {
    found.warning = warning_of(found.structure);
    return explained;
  }
  found.bound = bound_of(evidence);
  check_bound(options.gates.bound, found);
  if (wanders(found) && !found.drift.followed) {
    found.bound.reset();
    found.warning =
        "the sensor changes too much in too small a part of the record, so the record does not "
        "show how far off the angle is; record when it has settled";
  }
  return explained;
}

void assess_harmonics(Identification& found) {
  constexpr double by_median = 4;
  const Harmonics& harmonics = found.harmonics;
  const Parameters& p = harmonics.model.fundamental;
  const double error = by_median * harmonics.expected_error;
  found.bound = AngleBound{};
  found.bound->harmonics = found.bound->total = error;
  found.bound->arc = *found.bound;
  Intervals& half = found.intervals;
  for (double* width : {&half.a1, &half.b1}) *width = std::max(*width, p.a1 * error);
  for (double* width : {&half.a2, &half.b2}) *width = std::max(*width, p.a2 * error);
  half.beta = std::max(half.beta, error);
  found.warning.clear();
  if (harmonics.unbounded.empty()) return;
  found.bound.reset();
  found.warning = "no bound of the angle: " + harmonics.unbounded;
}

}  // namespace capsoc::identification
