#include "metrics/sample_curves.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <string>

#include "capsoc_registers.h"
#include "support/constants.h"

namespace capsoc::metrics {
namespace {

namespace cop = registers::coprocessor;

constexpr std::size_t buckets = 600;  ///< a plot is 600 pixels wide, or zoomed into
constexpr int plot_digits = 7;
constexpr int parameter_digits = 10;  ///< errors are taken from them: a word of 32 bits has no more
constexpr int harmonics = 16;

struct Bit {
  const char* name;
  uint32_t mask;
  uint32_t RecordedResult::*word;
};
constexpr std::array<Bit, 17> bits = {{
    {"status.LOCK", cop::STATUS_LOCK_mask, &RecordedResult::status},
    {"status.DIVERGED", cop::STATUS_DIVERGED_mask, &RecordedResult::status},
    {"status.MIRROR", cop::STATUS_MIRROR_mask, &RecordedResult::status},
    {"status.VALID", cop::STATUS_VALID_mask, &RecordedResult::status},
    {"status.ALARM", cop::STATUS_ALARM_mask, &RecordedResult::status},
    {"status.FROZEN", cop::STATUS_FROZEN_mask, &RecordedResult::status},
    {"flags.CLIP", cop::FLAGS_CLIP_mask, &RecordedResult::flags},
    {"flags.SAT", cop::FLAGS_SAT_mask, &RecordedResult::flags},
    {"flags.ZERO", cop::FLAGS_ZERO_mask, &RecordedResult::flags},
    {"flags.EARLY", cop::FLAGS_EARLY_mask, &RecordedResult::flags},
    {"flags.LOCKCHG", cop::FLAGS_LOCKCHG_mask, &RecordedResult::flags},
    {"flags.DIVERGED", cop::FLAGS_DIVERGED_mask, &RecordedResult::flags},
    {"flags.MIRRORCHG", cop::FLAGS_MIRRORCHG_mask, &RecordedResult::flags},
    {"flags.CONFIG", cop::FLAGS_CONFIG_mask, &RecordedResult::flags},
    {"flags.TURN", cop::FLAGS_TURN_mask, &RecordedResult::flags},
    {"flags.ALARM", cop::FLAGS_ALARM_mask, &RecordedResult::flags},
    {"flags.UNSETTLED", cop::FLAGS_UNSETTLED_mask, &RecordedResult::flags},
}};

double raw_turns(const RecordedSample& sample) {
  return std::atan2(static_cast<double>(sample.u), static_cast<double>(sample.v)) / two_pi;
}

double error_deg(double turns, const RecordedSample& sample) {
  return 360 * turn_difference(turns, sample.angle_turns);
}

bool has_error(const RecordedSample& sample) {
  return sample.has_truth && sample.result && sample.result->angle_valid;
}

Curve shown(Curve few, int digits = plot_digits) {
  // Times and angles have a step of their own; ten digits keep it.
  for (double& x : few.x) x = rounded(x, parameter_digits);
  for (double& y : few.y) y = rounded(y, digits);
  return few;
}

/// All curves over time in one pass: they are most of what a report costs a run.
void add_over_time(const SampleRecord& samples, Curves& curves) {
  std::size_t results = 0, errors = 0, truths = 0;
  for (const RecordedSample& sample : samples) {
    if (!sample.result) continue;
    ++results;
    if (sample.has_truth) ++truths;
    if (has_error(sample)) ++errors;
  }
  const auto all = [&] { return Thinner(results, buckets); };
  Thinner a1 = all(), a2 = all(), b1 = all(), b2 = all(), beta = all(), phi = all();
  Thinner err_u = all(), err_v = all(), error_average = all();
  Thinner angle_error(errors, buckets), raw_error(truths, buckets);
  for (const RecordedSample& sample : samples) {
    if (!sample.result) continue;
    const RecordedResult& result = *sample.result;
    const Parameters parameters = to_values(result.words);
    a1.add(sample.time_s, parameters.a1);
    a2.add(sample.time_s, parameters.a2);
    b1.add(sample.time_s, parameters.b1);
    b2.add(sample.time_s, parameters.b2);
    beta.add(sample.time_s, parameters.beta);
    phi.add(sample.time_s, parameters.phi);
    err_u.add(sample.time_s, result.error_u / q31);
    err_v.add(sample.time_s, result.error_v / q31);
    error_average.add(sample.time_s, result.error_average / q31);
    if (has_error(sample)) angle_error.add(sample.time_s, error_deg(result.angle / q32, sample));
    if (sample.has_truth) raw_error.add(sample.time_s, error_deg(raw_turns(sample), sample));
  }
  const auto add = [&](const char* name, Thinner& curve, int digits = plot_digits) {
    curves.emplace_back(name, shown(std::move(curve).curve(), digits));
  };
  add("a1", a1, parameter_digits);
  add("a2", a2, parameter_digits);
  add("b1", b1, parameter_digits);
  add("b2", b2, parameter_digits);
  add("beta", beta, parameter_digits);
  add("phi", phi, parameter_digits);
  add("err_u", err_u);
  add("err_v", err_v);
  add("error_average", error_average);
  add("angle_error", angle_error);
  add("raw_error", raw_error);
}

/// The first sample of the last turn by the coprocessor's angle; enough of them for a curve where
/// they come in any order.
std::size_t last_turn(const SampleRecord& samples) {
  constexpr std::size_t least = 2000;
  double turns = 0;
  std::size_t from = samples.size();
  while (from > 0 && (turns < 1 || samples.size() - from < least)) {
    --from;
    if (from + 1 == samples.size() || !samples[from].result || !samples[from + 1].result) continue;
    turns += std::abs(
        turn_difference(samples[from + 1].result->angle / q32, samples[from].result->angle / q32));
  }
  return from;
}

/// So many points, evenly taken: a figure that is no function of x has no least and greatest.
Curve some_of(const Curve& curve) {
  Curve few;
  const std::size_t step = curve.x.size() / (2 * buckets) + 1;
  for (std::size_t i = 0; i < curve.x.size(); i += step)
    few.add(rounded(curve.x[i], plot_digits), rounded(curve.y[i], plot_digits));
  return few;
}

void add_lissajous(const SampleRecord& samples, std::size_t from, const Parameters& p,
                   Curves& curves) {
  Curve before, after;
  for (std::size_t i = from; i < samples.size(); ++i) {
    const double u = samples[i].u / q31, v = samples[i].v / q31;
    before.add(u, v);
    const double sine = (u - p.b1) / p.a1;
    const double cosine = ((v - p.b2) / p.a2 + sine * std::sin(p.beta)) / std::cos(p.beta);
    if (std::isfinite(sine) && std::isfinite(cosine)) after.add(sine, cosine);
  }
  curves.emplace_back("lissajous", some_of(before));
  curves.emplace_back("calibrated", some_of(after));
}

/// Least squares of a constant and the harmonics' sines and cosines; an empty curve for angles that
/// do not tell them apart. `error`: x in degrees.
Curve spectrum_of(const Curve& error) {
  constexpr int columns = 1 + 2 * harmonics;
  const auto count = static_cast<Eigen::Index>(error.x.size());
  if (count < 4 * columns) return {};
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(columns, columns);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(columns);
  constexpr Eigen::Index block = 64;  // samples at once: a product of matrices, and no memory
  Eigen::Matrix<double, columns, block> rows;
  for (Eigen::Index first = 0; first < count; first += block) {
    const Eigen::Index here = std::min(block, count - first);
    for (Eigen::Index i = 0; i < here; ++i) {
      const double degrees = error.x[static_cast<std::size_t>(first + i)];
      const std::complex<double> one = std::polar(1.0, degrees * radians_per_degree);
      std::complex<double> power = 1;
      rows(0, i) = 1;
      for (int h = 1; h <= harmonics; ++h) {
        power *= one;
        rows(2 * h - 1, i) = power.imag();
        rows(2 * h, i) = power.real();
      }
    }
    normal.selfadjointView<Eigen::Lower>().rankUpdate(rows.leftCols(here));
    right += rows.leftCols(here) * Eigen::Map<const Eigen::VectorXd>(error.y.data() + first, here);
  }
  const Eigen::LDLT<Eigen::MatrixXd> solver(normal.selfadjointView<Eigen::Lower>());
  constexpr double worst_condition = 1e-6;
  if (!(solver.rcond() > worst_condition)) return {};
  const Eigen::VectorXd found = solver.solve(right);
  Curve spectrum;
  spectrum.add(0, rounded(std::abs(found[0]), plot_digits));
  for (int h = 1; h <= harmonics; ++h)
    spectrum.add(h, rounded(std::hypot(found[2 * h - 1], found[2 * h]), plot_digits));
  return spectrum;
}

/// In order of angle, as a plot over it has them.
Curve sorted(const Curve& curve) {
  std::vector<std::size_t> order(curve.x.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return curve.x[a] < curve.x[b]; });
  Curve in_order;
  for (const std::size_t i : order) in_order.add(curve.x[i], curve.y[i]);
  return in_order;
}

void add_by_angle(const SampleRecord& samples, std::size_t from, Curves& curves) {
  Curve error, raw;
  for (std::size_t i = from; i < samples.size(); ++i) {
    if (!has_error(samples[i])) continue;
    const double turns = samples[i].angle_turns;
    const double angle = 360 * (turns - std::floor(turns));
    error.add(angle, error_deg(samples[i].result->angle / q32, samples[i]));
    raw.add(angle, error_deg(raw_turns(samples[i]), samples[i]));
  }
  curves.emplace_back("error_by_angle", shown(thinned(sorted(error), buckets)));
  curves.emplace_back("raw_by_angle", shown(thinned(sorted(raw), buckets)));
  curves.emplace_back("spectrum", spectrum_of(error));
  curves.emplace_back("raw_spectrum", spectrum_of(raw));
}

/// A point at the start, at each change and at the end.
Curve changes_of(const SampleRecord& samples, const Bit& bit) {
  Curve curve;
  const RecordedSample* last = nullptr;
  for (const RecordedSample& sample : samples) {
    if (!sample.result) continue;
    const bool set = ((*sample.result).*bit.word & bit.mask) != 0;
    if (curve.y.empty() || (curve.y.back() != 0) != set) curve.add(sample.time_s, set ? 1 : 0);
    last = &sample;
  }
  if (last != nullptr && curve.x.back() < last->time_s) curve.add(last->time_s, curve.y.back());
  return shown(thinned(curve, buckets));
}

/// Most bits are never set; one look at the samples tells those.
void add_bits(const SampleRecord& samples, Curves& curves) {
  RecordedResult ever;
  for (const RecordedSample& sample : samples) {
    if (!sample.result) continue;
    ever.status |= sample.result->status;
    ever.flags |= sample.result->flags;
  }
  for (const Bit& bit : bits)
    if ((ever.*bit.word & bit.mask) != 0) curves.emplace_back(bit.name, changes_of(samples, bit));
}

}  // namespace

Curves curves_of(const SampleRecord& samples, const ParameterWords& end) {
  Curves curves;
  add_over_time(samples, curves);
  const std::size_t turn = last_turn(samples);
  add_lissajous(samples, turn, to_values(end), curves);
  add_by_angle(samples, turn, curves);
  add_bits(samples, curves);
  curves.erase(std::remove_if(curves.begin(), curves.end(),
                              [](const auto& curve) { return curve.second.x.empty(); }),
               curves.end());
  return curves;
}

}  // namespace capsoc::metrics
