#include "identification/harmonics.h"

#include <algorithm>
#include <utility>

#include "identification/harmonics_route.h"

namespace capsoc::identification {
namespace {

/// The curve contradicts an assumption that leaves the distances this much larger, in units of
/// their variance: eight harmonics' worth of noise is 8 +- 4.
constexpr double contradiction = 50;

/// Whether the samples are significantly nearer to the curve that was fitted to their shape.
bool contradicts(const Attempt& curve, const Attempt& motion, double count) {
  // What more harmonics leave over is no verdict on the motion.
  if (curve.distance <= 0 || curve.value > curve.limit) return false;
  const double ratio = motion.distance / curve.distance;
  return count * (ratio * ratio - 1) > contradiction;
}

/// What contradicts a bound of the angle: distances that a curve with these harmonics leaves and
/// noise does not explain. "": nothing.
std::string unbounded_by(const Attempt& curve) {
  return curve.distance > 0 && curve.value > curve.limit ? curve.reason : "";
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
  harmonics.unbounded = attempt.unbounded;
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
  if (best.held && best.distance <= rounding_part * scale) return answer(best, failures);
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
  } else if (best.unbounded.empty()) {
    best.unbounded = unbounded_by(curve);
  }
  // Orders 1 to 3 of the spread cannot be distinguished from harmonics: the user has to guarantee
  // them.
  if (best.held && best.assumption == Assumption::even_coverage)
    best.unbounded =
        "samples that are not in order cover the turn evenly or do not, and the samples alone do "
        "not tell; say --assume coverage where you know it";
  return best.held ? answer(best, failures) : fallen_back(best, failures, start);
}

/// Even with an assumption that the user guarantees, noise has to explain the distances that
/// remain.
Harmonics as_asked(const Channel& u, const Channel& v, const Attempt& attempt, int highest) {
  Harmonics harmonics = answer(attempt, "");
  const double scale = std::min(attempt.model.fundamental.a1, attempt.model.fundamental.a2);
  if (harmonics.unbounded.empty() && attempt.distance > rounding_part * scale)
    harmonics.unbounded =
        unbounded_by(from_the_curve(u, v, attempt.model, highest, CurveShape::free));
  return harmonics;
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
  return attempt.held ? as_asked(u, v, attempt, options.highest)
                      : fallen_back(attempt, attempt.reason, start);
}

}  // namespace capsoc::identification
