// Harmonics of samples in order of time, the shaft turning steadily.
#include <algorithm>
#include <cmath>
#include <complex>

#include "base/constants.h"
#include "identification/harmonics_route.h"
#include "identification/known_angles.h"
#include "identification/sentence.h"

namespace capsoc::identification {
namespace {

/// Differences of successive angles point one way this much in a record in order of time.
constexpr double smallest_order = 0.8;
/// Turns that a record at constant speed needs, for harmonics and offsets to be told apart.
constexpr double fewest_turns = 0.95;
/// Slow departure from constant speed that is put up with, radians rms (it is reported).
constexpr double largest_departure = 1e-3;

/// rms of means over blocks, and what independent scatter of neighbours would give.
struct Drift {
  double slow, expected;
};

Drift drift_of(const Eigen::ArrayXd& departure) {
  const Eigen::Index count = departure.size();
  const Eigen::Index length = std::max<Eigen::Index>(4, count / 64);
  const Eigen::Index blocks = count / length;
  double slow = 0, jumps = 0;
  for (Eigen::Index block = 0; block < blocks; ++block) {
    const double mean = departure.segment(block * length, length).mean();
    slow += mean * mean;
  }
  for (Eigen::Index i = 1; i < count; ++i) {
    const double jump = departure[i] - departure[i - 1];
    jumps += jump * jump;
  }
  const double local = jumps / static_cast<double>(count - 1) / 2;
  return {std::sqrt(slow / static_cast<double>(blocks)),
          std::sqrt(local / static_cast<double>(length))};
}

/// The order beyond those that were asked for which the channels have at these angles; 0: none that
/// noise does not explain.
int further_order(const Channel& u, const Channel& v, const SignalModel& model,
                  const Eigen::ArrayXd& theta, int highest) {
  constexpr int last = 8;
  constexpr double by_chance = 24;  // of chi^2 with 2 degrees of freedom: 6e-6 a test
  Eigen::ArrayXd rest_u(u.size()), rest_v(v.size());
  for (Eigen::Index i = 0; i < u.size(); ++i) {
    const Point at = point_at(model, theta[i]);
    rest_u[i] = u[i] - at.u;
    rest_v[i] = v[i] - at.v;
  }
  int strongest = 0;
  double most = by_chance;
  for (const Eigen::ArrayXd* rest : {&rest_u, &rest_v}) {
    const double square = rest->square().sum();
    for (int order = highest + 1; order <= last && square > 0; ++order) {
      std::complex<double> sum = 0;
      for (Eigen::Index i = 0; i < rest->size(); ++i)
        sum += std::polar((*rest)[i], -order * theta[i]);
      const double power = 2 * std::norm(sum) / square;
      if (power > most) strongest = order;
      most = std::max(most, power);
    }
  }
  return strongest;
}

}  // namespace

Attempt at_constant_speed(const Channel& u, const Channel& v, const Parameters& start,
                          int highest) {
  Attempt attempt;
  attempt.assumption = Assumption::constant_speed;
  attempt.check = "slow departure of the angle from constant speed, rms degrees";
  attempt.limit = largest_departure / radians_per_degree;
  const Eigen::Index count = u.size();
  SignalModel model;
  model.fundamental = start;
  const Eigen::ArrayXd first = angles_of(u, v, model);
  std::complex<double> sum = 0;
  for (Eigen::Index i = 1; i < count; ++i) sum += std::polar(1.0, first[i] - first[i - 1]);
  if (std::abs(sum) < smallest_order * static_cast<double>(count - 1)) {
    attempt.reason = "the samples are not in order of time, so speed tells nothing";
    return attempt;
  }
  // The angle is followed about the mean step, which may be more than a quarter turn.
  const double step = std::arg(sum);
  Eigen::ArrayXd path(count);
  path[0] = first[0];
  for (Eigen::Index i = 1; i < count; ++i) {
    path[i] = path[i - 1] + step + wrapped(first[i] - first[i - 1] - step);
  }
  const Eigen::ArrayXd place = Eigen::ArrayXd::LinSpaced(count, -1, 1);
  double half_sweep = (path * place).sum() / place.square().sum();
  const double middle = path.mean();
  const double turns = std::abs(half_sweep) / pi;
  if (turns < fewest_turns) {
    attempt.reason =
        text("the record spans %.2f turns and constant speed needs a whole one", turns);
    return attempt;
  }
  const double wander = std::sqrt((path - middle - half_sweep * place).square().mean());
  if (wander > 0.5) {
    attempt.value = wander / radians_per_degree;
    attempt.reason =
        text("the speed is not constant: the angle departs from it by %.2g degrees rms",
             wander / radians_per_degree);
    return attempt;
  }
  double origin = middle;
  for (int iteration = 0; iteration < 12; ++iteration) {
    const Eigen::ArrayXd theta = origin + half_sweep * place;
    const LinearFit fit = fit_on_angles(u, v, theta, highest, &place, model);
    model = fit.model;
    if (!plausible(model, std::max(start.a1, start.a2))) {
      attempt.reason = "constant speed leads to no sensible harmonics";
      return attempt;
    }
    half_sweep += fit.slope;
    if (std::abs(fit.slope) < 1e-13 * std::abs(half_sweep)) break;
  }
  const Eigen::ArrayXd theta = angles_of(u, v, model);
  Eigen::ArrayXd departure(count);
  std::complex<double> mean = 0;
  for (Eigen::Index i = 0; i < count; ++i) {
    mean += std::polar(1.0, theta[i] - half_sweep * place[i]);
  }
  const double constant = std::arg(mean);
  for (Eigen::Index i = 0; i < count; ++i) {
    departure[i] = wrapped(theta[i] - half_sweep * place[i] - constant);
  }
  const Drift drift = drift_of(departure);
  attempt.value = drift.slow / radians_per_degree;
  attempt.limit = std::max(largest_departure, 3 * drift.expected) / radians_per_degree;
  if (attempt.value > attempt.limit) {
    attempt.reason = text(
        "the speed is not constant: the angle departs slowly from it by %.2g degrees rms, at most "
        "%.2g would do",
        attempt.value, attempt.limit);
    return attempt;
  }
  attempt.held = true;
  attempt.model = model;
  attempt.distance = distance_of(u, v, model);
  const double excess = drift.slow * drift.slow - drift.expected * drift.expected;
  attempt.coverage_error = 2 * std::sqrt(2 * std::max(excess, 0.0));
  attempt.expected_error = std::hypot(
      attempt.coverage_error, expected_error_on_angles(model, attempt.distance, count, highest));
  if (const int further = further_order(u, v, model, half_sweep * place + constant, highest);
      further != 0)
    attempt.unbounded = text(
        "the channels have a harmonic of order %.0f, which is not among those that were asked for",
        static_cast<double>(further));
  attempt.reason = text(
      "the samples are in order of time over %.2f turns and the angle keeps constant speed within "
      "%.2g degrees rms",
      turns, attempt.value);
  return attempt;
}

}  // namespace capsoc::identification
