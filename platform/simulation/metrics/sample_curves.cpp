#include "metrics/sample_curves.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <string>

#include "base/constants.h"
#include "capsoc_registers.h"

namespace capsoc::metrics {
namespace {

namespace cop = registers::coprocessor;

constexpr std::size_t buckets = 600;  ///< a plot is 600 pixels wide, or zoomed into
constexpr int plot_digits = 7;
constexpr int parameter_digits = 10;  ///< errors are taken from them: a word of 32 bits has no more
constexpr int harmonics = 16;

constexpr std::array<std::pair<const char*, int>, 9> quantities = {
    {{"a1", parameter_digits},
     {"a2", parameter_digits},
     {"b1", parameter_digits},
     {"b2", parameter_digits},
     {"beta", parameter_digits},
     {"phi", parameter_digits},
     {"err_u", plot_digits},
     {"err_v", plot_digits},
     {"error_average", plot_digits}}};

struct Bit {
  const char* name;
  uint32_t mask;
  uint32_t RecordedResult::*word;
};
constexpr std::array<Bit, 21> bits = {{
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
    {"flags.PARITY", cop::FLAGS_PARITY_mask, &RecordedResult::flags},
    {"flags.MISFIT", cop::FLAGS_MISFIT_mask, &RecordedResult::flags},
    {"flags.JUMP", cop::FLAGS_JUMP_mask, &RecordedResult::flags},
    {"flags.MISSED", cop::FLAGS_MISSED_mask, &RecordedResult::flags},
}};

/// Those of a word that are drawn.
constexpr uint32_t bits_of(uint32_t RecordedResult::*word) {
  uint32_t all = 0;
  for (const Bit& bit : bits)
    if (bit.word == word) all |= bit.mask;
  return all;
}
constexpr uint32_t status_bits = bits_of(&RecordedResult::status);
constexpr uint32_t flags_bits = bits_of(&RecordedResult::flags);

/// Of atan2(U, V).
double raw_error_deg(int32_t u, int32_t v, double angle_turns) {
  const double raw = std::atan2(static_cast<double>(u), static_cast<double>(v)) / two_pi;
  return 360 * turn_difference(raw, angle_turns);
}

double error_deg(uint32_t angle, double angle_turns) {
  return 360 * turn_difference(angle / q32, angle_turns);
}

Curve shown(Curve few, int digits = plot_digits) {
  // Ten digits keep the step of times and angles.
  for (double& x : few.x) x = rounded(x, parameter_digits);
  for (double& y : few.y) y = rounded(y, digits);
  return few;
}

/// At most 2 * buckets points, evenly taken: a curve that is no function of x has no least and
/// greatest value in a bucket.
Curve some_of(const Curve& curve) {
  Curve few;
  const std::size_t step = curve.x.size() / (2 * buckets) + 1;
  for (std::size_t i = 0; i < curve.x.size(); i += step)
    few.add(rounded(curve.x[i], plot_digits), rounded(curve.y[i], plot_digits));
  return few;
}

void add_lissajous(const std::vector<TurnSample>& turn, const Parameters& p, Curves& curves) {
  Curve before, after;
  for (const TurnSample& sample : turn) {
    const double u = sample.u / q31, v = sample.v / q31;
    before.add(u, v);
    const double sine = (u - p.b1) / p.a1;
    const double cosine = ((v - p.b2) / p.a2 + sine * std::sin(p.beta)) / std::cos(p.beta);
    if (std::isfinite(sine) && std::isfinite(cosine)) after.add(sine, cosine);
  }
  curves.emplace_back("lissajous", some_of(before));
  curves.emplace_back("calibrated", some_of(after));
}

/// Least squares of a constant and the harmonics' sines and cosines: the spectra of two errors at
/// the same angles, x in degrees. Empty curves for angles that do not tell them apart.
std::array<Curve, 2> spectra_of(const Curve& error, const Curve& raw) {
  constexpr int columns = 1 + 2 * harmonics;
  const auto count = static_cast<Eigen::Index>(error.x.size());
  if (count < 4 * columns) return {};
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(columns, columns);
  Eigen::MatrixX2d right = Eigen::MatrixX2d::Zero(columns, 2);
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
    const auto part = [&](const Curve& curve) {
      return rows.leftCols(here) * Eigen::Map<const Eigen::VectorXd>(curve.y.data() + first, here);
    };
    right.col(0) += part(error);
    right.col(1) += part(raw);
  }
  const Eigen::LDLT<Eigen::MatrixXd> solver(normal.selfadjointView<Eigen::Lower>());
  constexpr double worst_condition = 1e-6;
  if (!(solver.rcond() > worst_condition)) return {};
  const Eigen::MatrixX2d found = solver.solve(right);
  std::array<Curve, 2> spectra;
  for (Eigen::Index i = 0; i < found.cols(); ++i) {
    Curve& spectrum = spectra[static_cast<std::size_t>(i)];
    spectrum.add(0, rounded(std::abs(found(0, i)), plot_digits));
    for (int h = 1; h <= harmonics; ++h)
      spectrum.add(h, rounded(std::hypot(found(2 * h - 1, i), found(2 * h, i)), plot_digits));
  }
  return spectra;
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

void add_by_angle(const std::vector<TurnSample>& turn, Curves& curves) {
  Curve error, raw;
  for (const TurnSample& sample : turn) {
    if (!sample.has_error) continue;
    const double turns = sample.angle_turns;
    const double angle = 360 * (turns - std::floor(turns));
    error.add(angle, error_deg(sample.angle, turns));
    raw.add(angle, raw_error_deg(sample.u, sample.v, turns));
  }
  curves.emplace_back("error_by_angle", shown(thinned(sorted(error), buckets)));
  curves.emplace_back("raw_by_angle", shown(thinned(sorted(raw), buckets)));
  auto [spectrum, raw_spectrum] = spectra_of(error, raw);
  curves.emplace_back("spectrum", std::move(spectrum));
  curves.emplace_back("raw_spectrum", std::move(raw_spectrum));
}

}  // namespace

SampleCurves::SampleCurves()
    : values_(buckets, quantities.size()),
      angle_error_(buckets),
      raw_error_(buckets),
      changes_(bits.size(), Thinner(buckets)) {}

void SampleCurves::add(const RecordedSample& sample) {
  turn_.add(sample);
  if (!sample.result) return;
  const RecordedResult& result = *sample.result;
  const Parameters p = to_values(result.words);
  const std::array<double, quantities.size()> now = {
      p.a1,
      p.a2,
      p.b1,
      p.b2,
      p.beta,
      p.phi,
      result.error_u / q31,
      result.error_v / q31,
      result.error_average / q31,
  };
  values_.add(sample.time_s, now.data());
  if (has_error(sample))
    angle_error_.add(sample.time_s, error_deg(result.angle, sample.angle_turns));
  if (sample.has_truth)
    raw_error_.add(sample.time_s, raw_error_deg(sample.u, sample.v, sample.angle_turns));
  add_bits(sample.time_s, result);
  last_s_ = sample.time_s;
}

/// A point at the start and at each change.
void SampleCurves::add_bits(double time_s, const RecordedResult& result) {
  if (change_ && ((result.status ^ change_->status) & status_bits) == 0 &&
      ((result.flags ^ change_->flags) & flags_bits) == 0)
    return;
  for (std::size_t i = 0; i < bits.size(); ++i) {
    const auto [name, mask, word] = bits[i];
    const uint32_t now = result.*word & mask;
    if (!change_ || now != ((*change_).*word & mask)) changes_[i].add(time_s, now != 0 ? 1 : 0);
  }
  change_ = result;
}

void SampleCurves::visit(Archive& archive) {
  archive("values", values_);
  archive("angle_error", angle_error_);
  archive("raw_error", raw_error_);
  archive("turn", turn_);
  for (Thinner& change : changes_) archive("changes", change);
  archive("change", change_);
  archive("last_s", last_s_);
}

Curves SampleCurves::curves(const ParameterWords& end) const {
  Curves curves;
  for (std::size_t i = 0; i < quantities.size(); ++i)
    curves.emplace_back(quantities[i].first, shown(values_.curve(i), quantities[i].second));
  curves.emplace_back("angle_error", shown(angle_error_.curve()));
  curves.emplace_back("raw_error", shown(raw_error_.curve()));
  const std::vector<TurnSample> turn = turn_.samples();
  add_lissajous(turn, to_values(end), curves);
  add_by_angle(turn, curves);
  for (std::size_t i = 0; i < bits.size(); ++i) {
    Curve changes = changes_[i].curve();
    if (std::count(changes.y.begin(), changes.y.end(), 1) == 0)
      continue;  // most bits are never set
    // And a point at the end.
    if (changes.x.back() < last_s_) changes.add(last_s_, changes.y.back());
    curves.emplace_back(bits[i].name, shown(std::move(changes)));
  }
  curves.erase(std::remove_if(curves.begin(), curves.end(),
                              [](const auto& curve) { return curve.second.x.empty(); }),
               curves.end());
  return curves;
}

}  // namespace capsoc::metrics
