// Harmonics of samples in any order that cover the turn evenly or at random.
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numeric>
#include <vector>

#include "base/constants.h"
#include "identification/harmonics_route.h"
#include "identification/known_angles.h"
#include "identification/sentence.h"

namespace capsoc::identification {
namespace {

/// Samples below which even coverage cannot be checked.
constexpr Eigen::Index fewest_for_coverage = 64;
/// Orders of the angle's spread that two channels with three harmonics leave alone to first order.
constexpr int first_order = 4, last_order = 15;
/// Mean power of those orders times the number of samples: about 0 for an even sweep, 1 (+- 0.3)
/// for randomly drawn angles, N times the square of the unevenness for anything else.
constexpr double largest_unevenness = 3;
constexpr double random_from = 0.1;
/// Noise of the angle adds its variance times the order's square to the unevenness: the mean of
/// 4^2 .. 15^2 is 102. Half as much again for sensitivity that varies over the turn.
constexpr double mean_square_order = 1.5 * 102;

/// Angles 2 pi rank/N, in the order of the given angles.
Eigen::ArrayXd ranked(const Eigen::ArrayXd& theta) {
  std::vector<Eigen::Index> order(theta.size());
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::sort(order.begin(), order.end(),
            [&](Eigen::Index a, Eigen::Index b) { return theta[a] < theta[b]; });
  Eigen::ArrayXd even(theta.size());
  const double spacing = 2 * pi / static_cast<double>(theta.size());
  for (std::size_t rank = 0; rank < order.size(); ++rank) {
    even[order[rank]] = spacing * static_cast<double>(rank) - pi;
  }
  return even;
}

std::complex<double> mean_direction(const Eigen::ArrayXd& theta) {
  std::complex<double> sum = 0;
  for (const double angle : theta) sum += std::polar(1.0, angle);
  return sum / static_cast<double>(theta.size());
}

/// Whether the angles continue from one sample to the next more than those of shuffled ones do: by
/// steps that are alike, or that change slowly. Then a part of a turn that is there twice, or the
/// speed, makes the spread uneven at low orders, and that looks like harmonics.
bool keeps_order(const Eigen::ArrayXd& theta) {
  // Of a resultant's square times the number of samples: exp(-16) of all shuffled records.
  constexpr double by_chance = 16;
  const Eigen::Index count = theta.size();
  if (count < 3) return false;
  const auto goes_on = [&](const Eigen::ArrayXd& steps, std::complex<double> independent) {
    return std::norm(mean_direction(steps) - independent) * static_cast<double>(steps.size()) >
           by_chance;
  };
  const std::complex<double> once = mean_direction(theta), twice = mean_direction(2 * theta);
  const Eigen::ArrayXd steps = theta.tail(count - 1) - theta.head(count - 1);
  const Eigen::ArrayXd changes = steps.tail(count - 2) - steps.head(count - 2);
  return goes_on(steps, std::norm(once)) || goes_on(changes, once * once * std::conj(twice));
}

/// Root of the mean power of the spread's orders 4 .. 15.
double unevenness_of(const Eigen::ArrayXd& theta) {
  std::array<std::complex<double>, last_order + 1> order{};
  for (const double angle : theta) {
    const std::complex<double> direction = std::polar(1.0, angle);
    std::complex<double> power = 1;
    for (auto& sum : order) {
      sum += power;
      power *= direction;
    }
  }
  double square = 0;
  for (int m = first_order; m <= last_order; ++m) square += std::norm(order[m]);
  return std::sqrt(square / (last_order - first_order + 1)) / static_cast<double>(theta.size());
}

/// Random angles say less about a rank than the curve says about the angle: both are weighed, with
/// the noise that the curve alone leaves.
void refine_on_random_angles(const Channel& u, const Channel& v, int highest, Attempt& attempt) {
  const CurveFit alone = fit_curve(u, v, attempt.model, highest, CurveShape::free);
  const double scale = std::min(attempt.model.fundamental.a1, attempt.model.fundamental.a2);
  if (!alone.converged) return;
  if (alone.noise > rounding_part * scale && alone.structure > largest_structure) return;
  const CurveFit both =
      fit_curve(u, v, attempt.model, highest, CurveShape::free, std::max(alone.noise, 1e-300));
  if (!both.converged) return;
  attempt.model = both.model;
  attempt.distance = both.noise;
  attempt.expected_error = expected_error(both.model, both.covariance);
  attempt.coverage_error = attempt.expected_error;
}

}  // namespace

Attempt at_even_coverage(const Channel& u, const Channel& v, const Parameters& start, int highest) {
  Attempt attempt;
  attempt.assumption = Assumption::even_coverage;
  attempt.check = "unevenness of the angles' spread (0: even sweep, 1: random angles)";
  attempt.limit = largest_unevenness;
  if (u.size() < fewest_for_coverage) {
    attempt.reason = text("%.0f samples are too few to see that they cover the turn evenly",
                          static_cast<double>(u.size()));
    return attempt;
  }
  const auto count = static_cast<double>(u.size());
  SignalModel model;
  model.fundamental = start;
  Eigen::ArrayXd theta = angles_of(u, v, model);
  if (keeps_order(theta)) {
    attempt.reason =
        "the samples are in order: their angles are no independent draws, and only constant speed "
        "over whole turns would cover the turn evenly";
    return attempt;
  }
  for (int iteration = 0; iteration < 3; ++iteration) {
    model = fit_on_angles(u, v, ranked(theta), highest, nullptr, model).model;
    if (!plausible(model, std::max(start.a1, start.a2))) {
      attempt.reason = "the samples do not cover the turn evenly: no sensible harmonics result";
      return attempt;
    }
    theta = angles_of(u, v, model);
  }
  const double unevenness = unevenness_of(theta);
  attempt.value = count * unevenness * unevenness;
  if (attempt.value > attempt.limit) {
    attempt.reason = text(
        "the samples do not cover the turn evenly: the unevenness of their spread is %.3g, random "
        "angles give 1 and at most %.0f would do",
        attempt.value, attempt.limit);
    return attempt;
  }
  attempt.held = true;
  attempt.model = model;
  attempt.distance = distance_of(u, v, model);
  // The samples' noise makes the spread uneven too, which is not the sweep's fault.
  const double angle_noise =
      attempt.distance / std::min(model.fundamental.a1, model.fundamental.a2);
  const double excess = attempt.value - mean_square_order * angle_noise * angle_noise;
  attempt.coverage_error = 4 * std::sqrt(std::max(excess, 0.0) / count);
  attempt.expected_error = std::hypot(
      attempt.coverage_error, expected_error_on_angles(model, attempt.distance, count, highest));
  if (attempt.value > random_from) {
    refine_on_random_angles(u, v, highest, attempt);
    attempt.reason = text(
        "the angles are spread like %.0f random ones, which limits the answer to "
        "%.2g degrees peak to peak",
        count, attempt.expected_error / radians_per_degree);
  } else {
    attempt.reason = text(
        "the samples cover the turn evenly (unevenness %.2g, random angles give "
        "1)",
        attempt.value);
  }
  return attempt;
}

}  // namespace capsoc::identification
