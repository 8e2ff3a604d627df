#include "golden/golden_angle.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "base/json.h"
#include "identification/calibration.h"

namespace capsoc::golden {
namespace {

/// Places in the record, the end exclusive.
struct Window {
  std::size_t begin = 0, end = 0;
};

bool same(const metrics::ParameterWords& a, const metrics::ParameterWords& b) {
  return a.a1 == b.a1 && a.a2 == b.a2 && a.b1 == b.b1 && a.b2 == b.b2 && a.beta == b.beta &&
         a.phi == b.phi;
}

identification::Parameters of_words(const metrics::ParameterWords& words) {
  const metrics::Parameters p = metrics::to_values(words);
  return {p.a1, p.a2, p.b1, p.b2, p.beta};
}

/// After the last sample with a result in the given mode; 0: there is none.
std::size_t end_of(const metrics::SampleRecord& record, bool demodulating) {
  for (std::size_t k = record.size(); k > 0; --k)
    if (record[k - 1].result && record[k - 1].result->demodulating == demodulating) return k;
  return 0;
}

std::size_t end_of_results(const metrics::SampleRecord& record) {
  return std::max(end_of(record, false), end_of(record, true));
}

/// Calibration mode with the words that it ended with.
Window held(const metrics::SampleRecord& record, std::size_t end) {
  const metrics::ParameterWords& words = record[end - 1].result->words;
  std::size_t k = end;
  for (; k > 0; --k) {
    const auto& result = record[k - 1].result;
    if (result && (result->demodulating || !same(result->words, words))) break;
  }
  return {k, end};
}

double csfn_angle(const identification::Parameters& p, const metrics::RecordedSample& sample) {
  return identification::angle_of(p, sample.u / q31, sample.v / q31);
}

/// The last turn of demodulation up to `end`, and as many samples as the weights need to forget.
Window last_turn(const metrics::SampleRecord& record, std::size_t end,
                 const identification::Parameters& p, double smallest_step) {
  const double memory = smallest_step > 0 ? 4 / smallest_step : 0;
  double travel = 0, after = 0;
  std::size_t k = end;
  for (; k > 0; --k) {
    const auto& result = record[k - 1].result;
    if (result && !result->demodulating) break;
    const double angle = csfn_angle(p, record[k - 1]);
    if (k < end) travel += identification::wrapped(after - angle);
    after = angle;
    if (std::fabs(travel) >= two_pi && static_cast<double>(end - k) >= memory) break;
  }
  return {k, end};
}

/// Largest difference of the angles that two sets of parameters give for one curve, radians.
double largest_difference(const identification::Parameters& one,
                          const identification::Parameters& other) {
  constexpr int points = 72;
  double largest = 0;
  for (int i = 0; i < points; ++i) {
    const double theta = two_pi * i / points;
    const identification::Point at = identification::point_at({other, {}, {}}, theta);
    largest = std::max(
        largest,
        std::fabs(identification::wrapped(identification::angle_of(one, at.u, at.v) - theta)));
  }
  return largest;
}

double wander(const metrics::SampleRecord& record, const Window& window) {
  if (window.begin == window.end) return 0;
  const identification::Parameters last = of_words(record[window.end - 1].result->words);
  double largest = 0;
  for (std::size_t k = window.begin; k < window.end; ++k)
    if (record[k].result)
      largest = std::max(largest, largest_difference(last, of_words(record[k].result->words)));
  return largest;
}

/// Six weights, one time in a thousand: the root of chi squared's quantile.
constexpr double weights_width = 4.74;

/// How much an error of both channels, full scale, turns the angle at most, radians.
double sensitivity(const identification::Parameters& p) {
  return std::hypot(1 / p.a1, 1 / p.a2) / std::cos(p.beta);
}

/// The CSFN's own. Where it found harmonics it has none of its angle against the truth; between two
/// ellipses through the same samples each may be off by what such harmonics do.
double csfn_bound(const metrics::SampleRecord& record,
                  const identification::Identification& answer) {
  if (answer.bound) return answer.bound->total;
  const double noise =
      weights_width * 2 * answer.residuals.noise / std::sqrt(static_cast<double>(record.size()));
  return 2 * identification::angle_by_amplitude * answer.structure.amplitude +
         noise * sensitivity(answer.parameters);
}

/// docs/reference/results.md derives it.
AngleTolerance tolerance(const metrics::SampleRecord& record, const Window& learnt,
                         const identification::Identification& answer,
                         const GoldenSettings& settings) {
  constexpr double last_place = 1 / q31;
  const identification::Parameters& p = answer.parameters;
  const bool learns = learnt.begin != learnt.end && settings.largest_step > 0;
  AngleTolerance bound;
  bound.csfn = csfn_bound(record, answer);
  if (learns) {
    const double step = settings.largest_step;
    const double weight = answer.residuals.noise * std::sqrt(step / (2 - step));
    bound.noise = weights_width * std::sqrt(2.0) * weight * sensitivity(p);
    bound.wander = 2 * wander(record, learnt);
  }
  double places = 8 * sensitivity(p);
  if (settings.paper) {
    // Products of 32 bits: an update below the last place is none; S, C and their sums are in Q31.
    if (learns) places += 8 / settings.smallest_step * sensitivity(p);
    places += 64 * sensitivity(p) + 16 / (p.a1 * p.a2 * std::cos(p.beta));
  }
  bound.arithmetic = places * last_place;
  // The straight lines of its table of 512 sines, in four words.
  if (settings.paper)
    bound.arithmetic += 4 * (two_pi / 512) * (two_pi / 512) / 8 / std::cos(p.beta);
  for (double* part : {&bound.csfn, &bound.noise, &bound.wander, &bound.arithmetic})
    *part *= degrees_per_radian;
  return bound;
}

/// Of the sample's place between centre (0) and ellipse (1).
double radius_of(const identification::Parameters& p, const metrics::RecordedSample& sample) {
  const double sine = (sample.u / q31 - p.b1) / p.a1;
  const double other = (sample.v / q31 - p.b2) / p.a2;
  return std::hypot(sine, (other + sine * std::sin(p.beta)) / std::cos(p.beta));
}

/// Fills in samples and difference.
void measure(const metrics::SampleRecord& record, const Window& window,
             const identification::Parameters& p, AngleCheck& check) {
  double largest = 0;
  for (std::size_t k = window.begin; k < window.end; ++k) {
    const metrics::RecordedSample& sample = record[k];
    if (!sample.result || !sample.result->angle_valid) continue;
    const bool reversed = identification::canonical(of_words(sample.result->words)).reversed;
    const double theirs = csfn_angle(p, sample);
    const double expected = reversed ? pi - theirs : theirs;
    const double difference =
        std::fabs(identification::wrapped(sample.result->angle / q32 * two_pi - expected));
    largest = std::max(largest, difference * std::min(1.0, radius_of(p, sample)));
    ++check.samples;
  }
  if (check.samples > 0) check.difference = largest * degrees_per_radian;
}

void decide(AngleCheck& check) {
  using Verdict = AngleCheck::Verdict;
  const double difference = *check.difference;
  const bool usable = check.bound->total() <= widest_bound;
  const double limit = usable ? check.bound->total() : widest_bound;
  if (difference > limit) {
    check.verdict = Verdict::disagrees;
    check.reason = fmt::format(
        "the coprocessor's angle differs by {:.3g} deg from the CSFN's of the same samples, by "
        "more than {:.3g} deg",
        difference, limit);
  } else if (usable) {
    check.verdict = Verdict::agrees;
    check.reason.clear();
  } else {
    check.reason = fmt::format("a bound of {:.3g} deg guarantees nothing: the widest is {:g} deg",
                               check.bound->total(), widest_bound);
  }
}

}  // namespace

const char* to_string(AngleCheck::Verdict verdict) {
  switch (verdict) {
    case AngleCheck::Verdict::not_compared:
      return "not compared";
    case AngleCheck::Verdict::agrees:
      return "agrees";
    case AngleCheck::Verdict::disagrees:
      return "disagrees";
  }
  return "";
}

AngleCheck compare_angles(const metrics::SampleRecord& record,
                          const identification::Identification& answer,
                          const GoldenSettings& settings) {
  AngleCheck check;
  const std::size_t end = end_of_results(record);
  if (end == 0) return check;
  const identification::Parameters& p = answer.parameters;
  check.demodulating = record[end - 1].result->demodulating;
  const std::size_t learnt_until = end_of(record, true);
  const Window learnt = last_turn(record, learnt_until, p, settings.smallest_step);
  measure(record, check.demodulating ? learnt : held(record, end), p, check);
  if (!check.difference) return check;
  check.bound = tolerance(record, learnt, answer, settings);
  decide(check);
  return check;
}

nlohmann::ordered_json to_json(const AngleCheck& check) {
  nlohmann::ordered_json j;
  j["verdict"] = to_string(check.verdict);
  j["reason"] = nullptr;
  if (!check.reason.empty()) j["reason"] = check.reason;
  j["samples"] = check.samples;
  j["mode"] = nullptr;
  if (check.samples > 0) j["mode"] = check.demodulating ? "demodulation" : "calibration";
  j["difference_deg"] = number_or_null(check.difference);
  j["bound_deg"] = nullptr;
  j["bound_parts_deg"] = nullptr;
  if (!check.bound) return j;
  const AngleTolerance& bound = *check.bound;
  j["bound_deg"] = number_or_null(bound.total());
  j["bound_parts_deg"] = {{"csfn", number_or_null(bound.csfn)},
                          {"noise", number_or_null(bound.noise)},
                          {"wander", number_or_null(bound.wander)},
                          {"arithmetic", number_or_null(bound.arithmetic)}};
  return j;
}

std::string to_table(const AngleCheck& check) {
  std::string text = "ANGLE and the CSFN's angle: ";
  if (check.difference)
    text += fmt::format("{:.3g} deg in {} samples of {}, bound {:.3g} deg: ", *check.difference,
                        check.samples, check.demodulating ? "demodulation" : "calibration mode",
                        check.bound->total());
  text += to_string(check.verdict);
  if (check.verdict == AngleCheck::Verdict::not_compared) text += ": " + check.reason;
  return text + "\n";
}

}  // namespace capsoc::golden
