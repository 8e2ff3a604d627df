#include "reproduce/lms_experiment.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/constants.h"
#include "sensor/described_source.h"

namespace capsoc::reproduce {
namespace {

using identification::lms::Parameters;

constexpr double window_s = 20.0;

double degrees(double radians) {
  return radians * 180.0 / pi;
}

bool within_one_percent(double value, double preset) {
  return std::abs(value - preset) <= 0.01 * std::abs(preset);
}

struct Sample {
  double u, v;
  double reference;  ///< omega k, radians
};

double angle_error(const Parameters& p, const Sample& s) {
  const double angle = identification::lms::calibrated_angle(p, s.u, s.v) - p.phi;
  return degrees(std::abs(identification::lms::wrapped(angle - s.reference)));
}

void note_first(std::optional<double>& first, bool reached, double t) {
  if (reached && !first) first = t;
}

void note_convergence(const Parameters& p, const sensor::SignalConfig& preset, double t,
                      Outcome& outcome) {
  const bool amplitudes =
      within_one_percent(p.a1, preset.a1) && within_one_percent(p.a2, preset.a2);
  const bool offsets = within_one_percent(p.b1, preset.b1) && within_one_percent(p.b2, preset.b2);
  const bool angles =
      within_one_percent(p.beta, preset.beta) && within_one_percent(p.phi, preset.phi);
  const bool all = amplitudes && offsets && angles;
  note_first(outcome.first_amplitudes_s, amplitudes, t);
  note_first(outcome.first_amplitudes_offsets_s, amplitudes && offsets, t);
  note_first(outcome.first_within_s, all, t);
  if (!all) outcome.stays_within_s.reset();
  note_first(outcome.stays_within_s, all, t);
}

void measure_frozen(const std::vector<Sample>& record, double rate, double phi, Outcome& outcome) {
  for (size_t k = 0; k < record.size(); ++k) {
    const Sample& s = record[k];
    const double raw = std::atan2(s.u, s.v);
    const double to_reference = degrees(std::abs(identification::lms::wrapped(raw - s.reference)));
    const double to_truth =
        degrees(std::abs(identification::lms::wrapped(raw - s.reference - phi)));
    const double calibrated = angle_error(outcome.parameters, s);
    outcome.uncalibrated = std::max(outcome.uncalibrated, to_reference);
    outcome.uncalibrated_to_truth = std::max(outcome.uncalibrated_to_truth, to_truth);
    outcome.calibrated = std::max(outcome.calibrated, calibrated);
    if (static_cast<double>(k) < window_s * rate) {
      outcome.calibrated_start = std::max(outcome.calibrated_start, calibrated);
    }
  }
}

}  // namespace

std::vector<Parameters> learning_curve(const Experiment& experiment,
                                       const std::vector<double>& times_s) {
  const double rate = experiment.signal.sample_rate_hz;
  sensor::DescribedSource source(experiment.signal);
  identification::lms::LmsReference lms(experiment.steps, experiment.gain);
  std::vector<Parameters> curve;
  for (uint64_t k = 0; curve.size() < times_s.size(); ++k) {
    const double t = static_cast<double>(k) / rate;
    const std::optional<sensor::SensorValue> value = source.sample(k, t);
    if (!value) break;
    const double reference = 2.0 * pi * value->reference_turns;
    lms.update(std::sin(reference), std::cos(reference), value->u, value->v);
    if (static_cast<double>(k + 1) >= times_s[curve.size()] * rate)
      curve.push_back(lms.parameters());
  }
  return curve;
}

Outcome run(const Experiment& experiment) {
  const double rate = experiment.signal.sample_rate_hz;
  const auto count = static_cast<uint64_t>(std::llround(experiment.duration_s * rate));
  sensor::DescribedSource source(experiment.signal);
  identification::lms::LmsReference lms(experiment.steps, experiment.gain);
  Outcome outcome;
  std::vector<Sample> record;
  record.reserve(count);
  for (uint64_t k = 0; k < count; ++k) {
    const double t = static_cast<double>(k) / rate;
    const std::optional<sensor::SensorValue> value = source.sample(k, t);
    if (!value) break;
    const Sample sample{value->u, value->v, 2.0 * pi * value->reference_turns};
    lms.update(std::sin(sample.reference), std::cos(sample.reference), sample.u, sample.v);
    const Parameters now = lms.parameters();
    note_convergence(now, experiment.signal, t, outcome);
    if (t >= experiment.duration_s - window_s) {
      outcome.online_end = std::max(outcome.online_end, angle_error(now, sample));
    }
    record.push_back(sample);
  }
  outcome.parameters = lms.parameters();
  measure_frozen(record, rate, experiment.signal.phi, outcome);
  return outcome;
}

}  // namespace capsoc::reproduce
