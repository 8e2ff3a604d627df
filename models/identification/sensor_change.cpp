#include "identification/sensor_change.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "identification/circle_plane.h"
#include "identification/distributions.h"
#include "identification/scores.h"
#include "identification/sentence.h"

namespace capsoc::identification {
namespace {

/// Records with disturbances of single samples in which a run is found, and runs of such
/// disturbances that seem to follow a curve.
constexpr double run_false_alarms = 1e-5, curve_false_alarms = 1e-6;
/// Part of the squared distances that the curve explains, at least.
constexpr double explained_part = 0.9;
/// Samples that scatter less than this part of the smaller half axis are one point.
constexpr double one_point = 0.05;

/// Samples first .. last of the record, most of them outliers.
struct Run {
  Eigen::Index first = 0, last = 0;
};

/// Runs that outliers at independent places make in one record of 1/run_false_alarms. The sum of
/// the log likelihood ratios, restarted at 0, exceeds ln(1/p) once in p of its starts (Wald), and
/// each sample is a start.
std::vector<Run> runs_of(const std::vector<Eigen::Index>& outliers, Eigen::Index count) {
  const double part = static_cast<double>(outliers.size()) / static_cast<double>(count);
  const double part_in_run = (1 + part) / 2;
  const double gain = std::log(part_in_run / part);
  const double loss = std::log((1 - part) / (1 - part_in_run));
  const double enough = std::log(static_cast<double>(count) / run_false_alarms);
  std::vector<Run> runs;
  Run run;
  double sum = 0, largest = 0;
  const auto close = [&] {
    if (largest >= enough) runs.push_back(run);
    sum = largest = 0;
  };
  Eigen::Index before = -1;
  for (const Eigen::Index place : outliers) {
    sum -= loss * static_cast<double>(place - before - 1);
    if (sum <= 0) {
      close();
      run.first = place;
    }
    sum += gain;
    if (sum > largest) {
      largest = sum;
      run.last = place;
    }
    before = place;
  }
  close();
  return runs;
}

/// The distances of a run's samples, as a change of the ellipse explains them.
struct Curve {
  bool found = false;
  double distance = 0;  ///< rms of the run, unit of the samples
};

/// Degrees of the polynomials in time by which the ellipse of a run may change: a step, a ramp, a
/// return to the old values.
constexpr Eigen::Index degrees = 4;
constexpr Eigen::Index all_terms = ellipse_terms * (degrees + 1);

/// Normal equations of a run: the terms of the ellipse, then the same times the Legendre
/// polynomials of degree 1, 2 and so on of the place in the run.
struct NormalEquations {
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(all_terms, all_terms);
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(all_terms);
  double square = 0, count = 0;
};

NormalEquations normal_equations(const Samples& samples, const CirclePlane& plane, const Run& run) {
  NormalEquations all;
  Eigen::VectorXd row(all_terms);
  const auto length = static_cast<double>(std::max<Eigen::Index>(run.last - run.first, 1));
  for (Eigen::Index i = run.first; i <= run.last; ++i) {
    const SampleScore score = score_at(plane, samples.u[i], samples.v[i]);
    const double x = 2 * static_cast<double>(i - run.first) / length - 1;
    double now = 1, before = 0;
    for (Eigen::Index n = 0; n <= degrees; ++n) {
      row.segment<ellipse_terms>(n * ellipse_terms) = now * score.shape.head<ellipse_terms>();
      const auto order = static_cast<double>(n);
      const double next = ((2 * order + 1) * x * now - order * before) / (order + 1);
      before = std::exchange(now, next);
    }
    all.information.selfadjointView<Eigen::Lower>().rankUpdate(row);
    all.sum += row * score.distance;
    all.square += score.distance * score.distance;
  }
  all.information = Eigen::MatrixXd(all.information.selfadjointView<Eigen::Lower>());
  all.count = static_cast<double>(run.last - run.first + 1);
  return all;
}

/// Whether the first terms explain the distances, by more than chance.
bool explained_by(const NormalEquations& all, Eigen::Index first_terms) {
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver;
  solver.setThreshold(1e-9);
  solver.compute(all.information.topLeftCorner(first_terms, first_terms));
  const Eigen::VectorXd sum = all.sum.head(first_terms);
  const double explained = sum.dot(solver.solve(sum));
  const auto terms = static_cast<double>(solver.rank());
  const double rest = std::max(all.square - explained, 1e-30 * all.square);
  return all.count > terms && explained >= explained_part * all.square &&
         f_tail((explained / terms) / (rest / (all.count - terms)), terms, all.count - terms) <
             curve_false_alarms / (degrees + 1);
}

/// Turns in a run, of the angles as they are seen: counted in quarters, so that noise adds none.
double turns_of(const Samples& samples, const CirclePlane& plane, const Run& run) {
  double quarters = 0;
  CirclePlane::Polar last = plane.at(samples.u[run.first], samples.v[run.first]);
  for (Eigen::Index i = run.first; i <= run.last; ++i) {
    const CirclePlane::Polar now = plane.at(samples.u[i], samples.v[i]);
    if (now.cosine * last.cosine + now.sine * last.sine > 0) continue;
    ++quarters;
    last = now;
  }
  return quarters / 4;
}

/// A disturbance moves the angle that is seen, too. A polynomial that can follow the motion tells
/// the true angle from the seen one, and with it any disturbance. Degree n follows n / 2 turns, so
/// it counts only from (n + 1) / 2 turns on. Within less the constant terms follow the time.
Curve curve_of(const Samples& samples, const CirclePlane& plane, const Run& run) {
  const NormalEquations all = normal_equations(samples, plane, run);
  const double turns = turns_of(samples, plane, run);
  Curve curve;
  curve.distance = std::sqrt(all.square / all.count);
  for (Eigen::Index degree = 0; degree <= degrees && !curve.found; ++degree)
    if (degree == 0 || turns >= 0.5 * static_cast<double>(degree + 1))
      curve.found = explained_by(all, ellipse_terms * (degree + 1));
  return curve;
}

bool is_one_point(const Samples& samples, const Run& run, double half_axis) {
  const Eigen::Index count = run.last - run.first + 1;
  const auto u = samples.u.segment(run.first, count), v = samples.v.segment(run.first, count);
  const double scatter = (u - u.mean()).square().mean() + (v - v.mean()).square().mean();
  return std::sqrt(scatter) < one_point * half_axis;
}

}  // namespace

Gate check_change(const Samples& samples, const RobustFit& robust) {
  Gate gate = {"change", true, 0, 0, ""};
  if (robust.outliers.empty()) return gate;
  const CirclePlane plane(robust.fit.parameters);
  for (const Run& run : runs_of(robust.outliers, samples.u.size())) {
    if (is_one_point(samples, run, 1 / plane.largest_slope())) continue;
    const Curve curve = curve_of(samples, plane, run);
    if (!curve.found) continue;
    gate.passed = false;
    gate.value = static_cast<double>(run.last - run.first + 1);
    gate.reason = text("samples %.0f to %.0f follow another curve than the others",
                       static_cast<double>(run.first), static_cast<double>(run.last)) +
                  text(
                      ", %.2g from theirs (rms): the sensor changed; cut the record there, or "
                      "find what changed",
                      curve.distance);
    break;
  }
  return gate;
}

}  // namespace capsoc::identification
