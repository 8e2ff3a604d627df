#include "csfn/harmonics.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numeric>
#include <vector>

#include "csfn/curve_fit.h"
#include "csfn/linear_algebra.h"
#include "csfn/random.h"
#include "csfn/sentence.h"
#include "support/constants.h"

namespace capsoc::csfn {
namespace {

/// Differences of successive angles point one way this much in a record in order of time.
constexpr double smallest_order = 0.8;
/// Turns that a record at constant speed needs, for harmonics and offsets to be told apart.
constexpr double fewest_turns = 0.95;
/// Slow departure from constant speed that is put up with, radians rms (it is reported).
constexpr double largest_departure = 1e-3;
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
/// The curve contradicts an assumption that leaves the distances this much larger, in units of
/// their variance: eight harmonics' worth of noise is 8 +- 4.
constexpr double contradiction = 50;
/// Noise relative to the smaller amplitude, and what the model may leave, for the curve alone.
constexpr double largest_shape_noise = 1e-5;
constexpr double largest_structure = 14;
/// Where a residual is rounding.
constexpr double rounding = 1e-12;

/// One route's outcome; holds with a false `held` why it does not.
struct Attempt {
  Assumption assumption = Assumption::none;
  bool held = false;
  std::string reason;
  std::string check;
  double value = 0, limit = 0;
  SignalModel model;
  double distance = 0;        ///< rms distance of the samples from the curve
  double expected_error = 0;  ///< radians, peak to peak
  double coverage_error = 0;
};

using Coefficients = Eigen::Matrix<double, 7, 1>;  // 1, sin, cos, sin 2, cos 2, sin 3, cos 3

Coefficients basis(double theta) {
  Coefficients row;
  row << 1, std::sin(theta), std::cos(theta), std::sin(2 * theta), std::cos(2 * theta),
      std::sin(3 * theta), std::cos(3 * theta);
  return row;
}

HarmonicTerm turned(double sine, double cosine, double shift, double amplitude) {
  return {(sine * std::cos(shift) + cosine * std::sin(shift)) / amplitude,
          (cosine * std::cos(shift) - sine * std::sin(shift)) / amplitude};
}

/// Both channels by one angle whose origin is then moved to where U's fundamental is a pure sine.
SignalModel model_of(const Coefficients& u, const Coefficients& v) {
  SignalModel model;
  Parameters& p = model.fundamental;
  p.a1 = std::hypot(u[1], u[2]);
  p.a2 = std::hypot(v[1], v[2]);
  p.b1 = u[0];
  p.b2 = v[0];
  const double origin = std::atan2(u[2], u[1]);  // the new angle is the old one plus this
  p.beta = wrapped(std::atan2(-v[1], v[2]) - origin);
  for (int k = 0; k < 2; ++k) {
    const double shift = (k + 2) * origin;
    model.u[k] = turned(u[3 + 2 * k], u[4 + 2 * k], shift, p.a1);
    model.v[k] = turned(v[3 + 2 * k], v[4 + 2 * k], shift, p.a2);
  }
  return model;
}

/// Least squares of both channels on known angles; with `speed` also the correction of the angle's
/// slope over `place` (-1 .. 1), one Gauss-Newton step.
struct LinearFit {
  SignalModel model;
  double slope = 0;
};

LinearFit fit_on_angles(const Channel& u, const Channel& v, const Eigen::ArrayXd& theta,
                        int highest, const Eigen::ArrayXd* place, const SignalModel& last) {
  const int terms = 1 + 2 * highest;
  const int size = 2 * terms + (place != nullptr ? 1 : 0);
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(size, size);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(size);
  Eigen::MatrixXd block = Eigen::MatrixXd::Zero(terms, terms);
  Eigen::VectorXd by_slope_u = Eigen::VectorXd::Zero(terms);
  Eigen::VectorXd by_slope_v = Eigen::VectorXd::Zero(terms);
  for (Eigen::Index i = 0; i < u.size(); ++i) {
    const Coefficients all = basis(theta[i]);
    const Eigen::VectorXd row = all.head(terms);
    block += row * row.transpose();
    right.head(terms) += u[i] * row;
    right.segment(terms, terms) += v[i] * row;
    if (place == nullptr) continue;
    const Point slope = tangent_at(last, angle_of(last, u[i], v[i]));
    const double at = (*place)[i];
    by_slope_u += slope.u * at * row;
    by_slope_v += slope.v * at * row;
    normal(size - 1, size - 1) += (slope.u * slope.u + slope.v * slope.v) * at * at;
    right[size - 1] += (u[i] * slope.u + v[i] * slope.v) * at;
  }
  normal.topLeftCorner(terms, terms) = block;
  normal.block(terms, terms, terms, terms) = block;
  if (place != nullptr) {
    normal.block(0, size - 1, terms, 1) = by_slope_u;
    normal.block(terms, size - 1, terms, 1) = by_slope_v;
    normal.block(size - 1, 0, 1, terms) = by_slope_u.transpose();
    normal.block(size - 1, terms, 1, terms) = by_slope_v.transpose();
  }
  const Eigen::VectorXd x = solve_symmetric(normal, right);
  Coefficients cu = Coefficients::Zero(), cv = Coefficients::Zero();
  cu.head(terms) = x.head(terms);
  cv.head(terms) = x.segment(terms, terms);
  return {model_of(cu, cv), place != nullptr ? x[size - 1] : 0};
}

double distance_of(const Channel& u, const Channel& v, const SignalModel& model) {
  double square = 0;
  for (Eigen::Index i = 0; i < u.size(); ++i) {
    const double distance = foot_of(model, u[i], v[i]).distance;
    square += distance * distance;
  }
  return std::sqrt(square / static_cast<double>(u.size()));
}

/// Median peak-to-peak error of the angle when the model's terms scatter with that covariance.
double expected_error(const SignalModel& model, const Eigen::MatrixXd& covariance) {
  constexpr int draws = 63, angles = 90;
  const SymmetricEigen eigen = eigen_of_symmetric(covariance);
  const Eigen::MatrixXd root = eigen.vectors * eigen.values.cwiseMax(0).cwiseSqrt().asDiagonal();
  Eigen::MatrixXd sensitivity(angles, curve_terms);
  for (int i = 0; i < angles; ++i) {
    const double theta = 2 * pi * i / angles;
    const Point along = tangent_at(model, theta);
    const PointDerivatives d = derivatives_at(model, theta);
    const double square = along.u * along.u + along.v * along.v;
    sensitivity.row(i) = (along.u * d.u + along.v * d.v).transpose() / square;
  }
  const Eigen::MatrixXd from_normal = sensitivity * root;
  Random random(1);
  std::vector<double> errors;
  for (int draw = 0; draw < draws; ++draw) {
    Eigen::VectorXd normal(curve_terms);
    for (double& x : normal) {  // twelve uniform numbers are near enough to a normal one
      x = -6;
      for (int k = 0; k < 12; ++k) x += random.uniform();
    }
    const Eigen::VectorXd error = from_normal * normal;
    errors.push_back(error.maxCoeff() - error.minCoeff());
  }
  std::nth_element(errors.begin(), errors.begin() + draws / 2, errors.end());
  return errors[draws / 2];
}

/// For least squares on angles spread over whole turns: the basis is orthogonal.
double expected_error_on_angles(const SignalModel& model, double noise, double count, int highest) {
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(curve_terms, curve_terms);
  const double variance = noise * noise / count;
  const Parameters& p = model.fundamental;
  covariance.diagonal().head(4) << 2 * variance, 2 * variance, variance, variance;
  covariance(4, 4) = 2 * variance * (1 / (p.a1 * p.a1) + 1 / (p.a2 * p.a2));
  for (int k = 0; k < 4; ++k) {
    if (k / 2 + 2 > highest) continue;
    covariance(5 + k, 5 + k) = 2 * variance / (p.a1 * p.a1);
    covariance(9 + k, 9 + k) = 2 * variance / (p.a2 * p.a2);
  }
  return expected_error(model, covariance);
}

Eigen::ArrayXd angles_of(const Channel& u, const Channel& v, const SignalModel& model) {
  Eigen::ArrayXd theta(u.size());
  for (Eigen::Index i = 0; i < u.size(); ++i) theta[i] = angle_of(model, u[i], v[i]);
  return theta;
}

bool plausible(const SignalModel& model, double scale) {
  const CurveVector terms = to_vector(model);
  return terms.allFinite() && terms.tail(8).cwiseAbs().maxCoeff() < 0.3 &&
         terms.head(2).minCoeff() > 0 && terms.head(4).cwiseAbs().maxCoeff() < 100 * scale &&
         std::abs(terms[4]) < pi / 2;
}

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
  attempt.reason = text(
      "the samples are in order of time over %.2f turns and the angle keeps constant speed within "
      "%.2g degrees rms",
      turns, attempt.value);
  return attempt;
}

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
  if (alone.noise > rounding * scale && alone.structure > largest_structure) return;
  const CurveFit both =
      fit_curve(u, v, attempt.model, highest, CurveShape::free, std::max(alone.noise, 1e-300));
  if (!both.converged) return;
  attempt.model = both.model;
  attempt.distance = both.noise;
  attempt.expected_error = expected_error(both.model, both.covariance);
  attempt.coverage_error = attempt.expected_error;
}

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

Attempt from_the_curve(const Channel& u, const Channel& v, const SignalModel& start, int highest,
                       CurveShape shape) {
  const bool alone = shape == CurveShape::free;
  Attempt attempt;
  attempt.assumption = alone ? Assumption::shape : Assumption::symmetric;
  attempt.check = "structure that the model leaves in the distances (noise: about 3)";
  attempt.limit = largest_structure;
  const CurveFit fit = fit_curve(u, v, start, highest, shape);
  const double scale = std::min(fit.model.fundamental.a1, fit.model.fundamental.a2);
  const double noise = fit.noise / scale;
  attempt.value = noise > rounding ? fit.structure : 0;
  attempt.distance = std::max(fit.noise, rounding * scale);
  if (!fit.converged ||
      !plausible(fit.model, std::max(start.fundamental.a1, start.fundamental.a2))) {
    attempt.distance = 0;
    attempt.reason = "no curve with these harmonics fits the samples";
    return attempt;
  }
  if (attempt.value > attempt.limit) {
    attempt.reason = text(
        "the curve has more than these harmonics: what is left is no noise (structure %.3g, at "
        "most %.0f)",
        attempt.value, attempt.limit);
    return attempt;
  }
  if (alone && noise > largest_shape_noise) {
    attempt.reason = text(
        "the curve alone tells harmonics only below a noise of %.0e of the amplitude, and it is "
        "%.1e",
        largest_shape_noise, noise);
    return attempt;
  }
  attempt.held = true;
  attempt.model = fit.model;
  attempt.distance = fit.noise;
  attempt.expected_error = expected_error(fit.model, fit.covariance);
  attempt.reason =
      text(alone ? "the noise, %.1e of the amplitude, is low enough for the curve alone"
                 : "both channels have one waveform; noise %.1e of the amplitude",
           noise);
  return attempt;
}

/// Whether the samples are significantly nearer to the curve that was fitted to their shape.
bool contradicts(const Attempt& curve, const Attempt& motion, double count) {
  // What more harmonics leave over is no verdict on the motion.
  if (curve.distance <= 0 || curve.value > curve.limit) return false;
  const double ratio = motion.distance / curve.distance;
  return count * (ratio * ratio - 1) > contradiction;
}

void join(std::string& text, const std::string& more) {
  if (!text.empty()) text += "; ";
  text += more;
}

Harmonics answer(const Attempt& attempt, const std::string& failures) {
  Harmonics harmonics;
  harmonics.identified = true;
  harmonics.used = attempt.assumption;
  harmonics.reason = attempt.reason;
  if (!failures.empty()) join(harmonics.reason, failures);
  harmonics.model = attempt.model;
  harmonics.check = attempt.check;
  harmonics.check_value = attempt.value;
  harmonics.check_limit = attempt.limit;
  harmonics.noise = attempt.distance;
  harmonics.expected_error = attempt.expected_error;
  harmonics.coverage_error = attempt.coverage_error;
  return harmonics;
}

Harmonics fallen_back(const Attempt& last, const std::string& failures, const Parameters& start) {
  Harmonics harmonics;
  harmonics.reason = "no harmonics: " + failures;
  harmonics.model.fundamental = start;
  harmonics.check = last.check;
  harmonics.check_value = last.value;
  harmonics.check_limit = last.limit;
  return harmonics;
}

Harmonics automatic(const Channel& u, const Channel& v, const Parameters& start, int highest) {
  std::string failures;
  Attempt best = at_constant_speed(u, v, start, highest);
  if (!best.held) {
    join(failures, best.reason);
    Attempt even = at_even_coverage(u, v, start, highest);
    if (!even.held) join(failures, even.reason);
    best = std::move(even);
  }
  // The curve alone is asked where the motion says nothing, and where it is exact enough to
  // contradict the motion: an unevenness that repeats every turn passes the checks above.
  SignalModel from = best.model;
  if (!best.held) from.fundamental = start;
  const double scale = std::min(from.fundamental.a1, from.fundamental.a2);
  if (best.held && best.distance <= rounding * scale) return answer(best, failures);
  Attempt curve = from_the_curve(u, v, from, highest, CurveShape::free);
  if (!best.held) {
    if (!curve.held) join(failures, curve.reason);
    best = std::move(curve);
  } else if (contradicts(curve, best, static_cast<double>(u.size()))) {
    join(failures, std::string("the curve contradicts the assumption of ") +
                       to_string(best.assumption) +
                       ": the motion repeats an unevenness every turn");
    if (!curve.held) join(failures, curve.reason);
    best = std::move(curve);
  }
  return best.held ? answer(best, failures) : fallen_back(best, failures, start);
}

}  // namespace

const char* to_string(Assumption assumption) {
  switch (assumption) {
    case Assumption::automatic:
      return "automatic";
    case Assumption::constant_speed:
      return "constant speed";
    case Assumption::even_coverage:
      return "even coverage";
    case Assumption::symmetric:
      return "symmetric channels";
    case Assumption::shape:
      return "shape alone";
    case Assumption::none:
      break;
  }
  return "none";
}

Result<Harmonics> identify_harmonics(const Channel& u, const Channel& v, const Parameters& start,
                                     const HarmonicsOptions& options) {
  if (options.highest < 0 || options.highest > 3) {
    return Error{"harmonics are identified up to the third: give 0, 1, 2 or 3"};
  }
  if (auto error = check_samples(u, v)) return *error;
  SignalModel ellipse;
  ellipse.fundamental = start;
  if (options.highest < 2 || options.assumption == Assumption::none) {
    Harmonics harmonics;
    harmonics.reason = "no harmonics were asked for";
    harmonics.model = ellipse;
    return harmonics;
  }
  Attempt attempt;
  switch (options.assumption) {
    case Assumption::constant_speed:
      attempt = at_constant_speed(u, v, start, options.highest);
      break;
    case Assumption::even_coverage:
      attempt = at_even_coverage(u, v, start, options.highest);
      break;
    case Assumption::symmetric:
      attempt = from_the_curve(u, v, ellipse, options.highest, CurveShape::symmetric);
      break;
    case Assumption::shape:
      attempt = from_the_curve(u, v, ellipse, options.highest, CurveShape::free);
      break;
    default:
      return automatic(u, v, start, options.highest);
  }
  return attempt.held ? answer(attempt, "") : fallen_back(attempt, attempt.reason, start);
}

}  // namespace capsoc::csfn
