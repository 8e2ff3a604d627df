#include "metrics/sample_curves.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>

#include "capsoc_registers.h"
#include "support/constants.h"

namespace capsoc::metrics {
namespace {

namespace cop = registers::coprocessor;
using Samples = std::vector<RecordedSample>;

constexpr std::size_t buckets = 1000;
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
  return 360 * std::remainder(turns - sample.angle_turns, 1.0);
}

bool has_error(const RecordedSample& sample) {
  return sample.has_truth && sample.result && sample.result->angle_valid;
}

Curve shown(const Curve& curve, int digits = plot_digits) {
  Curve few = thinned(curve, buckets);
  // Times and angles have a step of their own; ten digits keep it.
  for (double& x : few.x) x = rounded(x, parameter_digits);
  for (double& y : few.y) y = rounded(y, digits);
  return few;
}

/// A curve over time of those samples that have a value.
template <typename Value>
Curve over_time(const Samples& samples, Value value) {
  Curve curve;
  curve.x.reserve(samples.size());
  curve.y.reserve(samples.size());
  for (const RecordedSample& sample : samples)
    if (sample.result) value(sample, curve);
  return curve;
}

void add_parameters(const Samples& samples, Curves& curves) {
  const auto add = [&](const char* name, double Parameters::*member) {
    const Curve curve = over_time(samples, [&](const RecordedSample& sample, Curve& c) {
      c.add(sample.time_s, to_values(sample.result->words).*member);
    });
    curves.emplace_back(name, shown(curve, parameter_digits));
  };
  add("a1", &Parameters::a1);
  add("a2", &Parameters::a2);
  add("b1", &Parameters::b1);
  add("b2", &Parameters::b2);
  add("beta", &Parameters::beta);
  add("phi", &Parameters::phi);
}

void add_errors(const Samples& samples, Curves& curves) {
  const auto add = [&](const char* name, auto value) {
    curves.emplace_back(name, shown(over_time(samples, value)));
  };
  add("err_u", [](const RecordedSample& s, Curve& c) { c.add(s.time_s, s.result->error_u / q31); });
  add("err_v", [](const RecordedSample& s, Curve& c) { c.add(s.time_s, s.result->error_v / q31); });
  add("error_average",
      [](const RecordedSample& s, Curve& c) { c.add(s.time_s, s.result->error_average / q31); });
  add("angle_error", [](const RecordedSample& s, Curve& c) {
    if (has_error(s)) c.add(s.time_s, error_deg(s.result->angle / q32, s));
  });
  add("raw_error", [](const RecordedSample& s, Curve& c) {
    if (s.has_truth) c.add(s.time_s, error_deg(raw_turns(s), s));
  });
}

/// The first sample of the last turn by the coprocessor's angle; enough of them for a curve where
/// they come in any order.
std::size_t last_turn(const Samples& samples) {
  constexpr std::size_t least = 2000;
  double turns = 0;
  std::size_t from = samples.size();
  while (from > 0 && (turns < 1 || samples.size() - from < least)) {
    --from;
    if (from + 1 == samples.size() || !samples[from].result || !samples[from + 1].result) continue;
    turns += std::abs(std::remainder(
        samples[from + 1].result->angle / q32 - samples[from].result->angle / q32, 1.0));
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

void add_lissajous(const Samples& samples, std::size_t from, const Parameters& p, Curves& curves) {
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
  if (error.x.size() < 4 * columns) return {};
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(columns, columns);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(columns), row(columns);
  for (std::size_t i = 0; i < error.x.size(); ++i) {
    row[0] = 1;
    for (int h = 1; h <= harmonics; ++h) {
      row[2 * h - 1] = std::sin(h * error.x[i] * radians_per_degree);
      row[2 * h] = std::cos(h * error.x[i] * radians_per_degree);
    }
    normal.selfadjointView<Eigen::Lower>().rankUpdate(row);
    right += error.y[i] * row;
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

void add_by_angle(const Samples& samples, std::size_t from, Curves& curves) {
  Curve error, raw;
  for (std::size_t i = from; i < samples.size(); ++i) {
    if (!has_error(samples[i])) continue;
    const double turns = samples[i].angle_turns;
    const double angle = 360 * (turns - std::floor(turns));
    error.add(angle, error_deg(samples[i].result->angle / q32, samples[i]));
    raw.add(angle, error_deg(raw_turns(samples[i]), samples[i]));
  }
  curves.emplace_back("error_by_angle", shown(sorted(error)));
  curves.emplace_back("raw_by_angle", shown(sorted(raw)));
  curves.emplace_back("spectrum", spectrum_of(error));
  curves.emplace_back("raw_spectrum", spectrum_of(raw));
}

/// A point at the start, at each change and at the end.
Curve changes_of(const Samples& samples, const Bit& bit) {
  Curve curve;
  const RecordedSample* last = nullptr;
  for (const RecordedSample& sample : samples) {
    if (!sample.result) continue;
    const bool set = ((*sample.result).*bit.word & bit.mask) != 0;
    if (curve.y.empty() || (curve.y.back() != 0) != set) curve.add(sample.time_s, set ? 1 : 0);
    last = &sample;
  }
  if (last != nullptr && curve.x.back() < last->time_s) curve.add(last->time_s, curve.y.back());
  return shown(curve);
}

/// Most bits are never set; one look at the samples tells those.
void add_bits(const Samples& samples, Curves& curves) {
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

Curves curves_of(const std::vector<RecordedSample>& samples, const ParameterWords& end) {
  Curves curves;
  add_parameters(samples, curves);
  add_errors(samples, curves);
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
