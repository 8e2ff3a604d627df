#include "identification/sensor_change.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
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

using EllipseVector = Eigen::Matrix<double, ellipse_terms, 1>;
using EllipseMatrix = Eigen::Matrix<double, ellipse_terms, ellipse_terms>;

/// The distances of a run's samples, as a change of the ellipse explains them.
struct Curve {
  bool found = false;
  double distance = 0;  ///< rms of the run, unit of the samples
};

Curve curve_of(const Samples& samples, const CirclePlane& plane, const Run& run) {
  EllipseMatrix information = EllipseMatrix::Zero();
  EllipseVector sum = EllipseVector::Zero();
  double square = 0;
  for (Eigen::Index i = run.first; i <= run.last; ++i) {
    const SampleScore score = score_at(plane, samples.u[i], samples.v[i]);
    const EllipseVector shape = score.shape.head<ellipse_terms>();
    information += shape * shape.transpose();
    sum += shape * score.distance;
    square += score.distance * score.distance;
  }
  const auto count = static_cast<double>(run.last - run.first + 1);
  Eigen::CompleteOrthogonalDecomposition<EllipseMatrix> solver;
  solver.setThreshold(1e-9);
  solver.compute(information);
  const double explained = sum.dot(solver.solve(sum));
  const auto terms = static_cast<double>(solver.rank());
  const double rest = std::max(square - explained, 1e-30 * square);
  Curve curve;
  curve.distance = std::sqrt(square / count);
  curve.found = count > terms && explained >= explained_part * square &&
                f_tail((explained / terms) / (rest / (count - terms)), terms, count - terms) <
                    curve_false_alarms;
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
