#include "fit/fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include "base/constants.h"
#include "identification/calibration.h"
#include "identification/fused_network.h"
#include "identification/peers.h"

namespace capsoc::fit {
namespace {

double degrees(double radians) {
  return radians * 180 / pi;
}

Eigen::ArrayXd angles_of(const identification::SignalModel& model, bool harmonics,
                         const identification::Samples& samples) {
  Eigen::ArrayXd angles(samples.u.size());
  for (Eigen::Index i = 0; i < angles.size(); ++i)
    angles[i] = harmonics ? identification::angle_of(model, samples.u[i], samples.v[i])
                          : identification::angle_of(model.fundamental, samples.u[i], samples.v[i]);
  return angles;
}

/// The samples do not tell which way the shaft turns, so either way of counting is right.
double peak_to_peak(const Eigen::ArrayXd& angles, const Eigen::ArrayXd& truth) {
  const Eigen::ArrayXd reversed = -truth;
  return degrees(std::min(identification::peak_to_peak_error(angles, truth),
                          identification::peak_to_peak_error(angles, reversed)));
}

std::optional<double> angle_error(const Record& record,
                                  const identification::Parameters& parameters) {
  if (record.angle.size() == 0) return std::nullopt;
  return peak_to_peak(angles_of({parameters}, false, record.samples), record.angle);
}

AngleErrors angle_errors(const Record& record, const identification::Identification& answer) {
  AngleErrors errors;
  if (record.angle.size() == 0) return errors;
  Eigen::ArrayXd raw(record.angle.size());
  for (Eigen::Index i = 0; i < raw.size(); ++i)
    raw[i] = identification::uncalibrated_angle(record.samples.u[i], record.samples.v[i]);
  errors.uncalibrated = peak_to_peak(raw, record.angle);
  errors.calibrated = angle_error(record, answer.parameters);
  if (answer.harmonics.identified)
    errors.with_harmonics =
        peak_to_peak(angles_of(answer.harmonics.model, true, record.samples), record.angle);
  return errors;
}

/// How well an angle turns with another, whichever way round: 1 for a constant between them.
double turning_with(const Eigen::ArrayXd& angles, const Eigen::ArrayXd& truth, double factor) {
  std::complex<double> direct = 0, reversed = 0;
  for (Eigen::Index i = 0; i < angles.size(); ++i) {
    direct += std::polar(1.0, angles[i] - factor * truth[i]);
    reversed += std::polar(1.0, angles[i] + factor * truth[i]);
  }
  return std::max(std::abs(direct), std::abs(reversed)) / static_cast<double>(angles.size());
}

/// Empty for a column of angles that turns with the signals, or none; otherwise what it seems to
/// be.
std::string reason_against_angle(const Record& record,
                                 const identification::Parameters& parameters) {
  constexpr double turns_along = 0.7, certain = 0.95;
  if (record.angle.size() == 0) return "";
  const Eigen::ArrayXd angles = angles_of({parameters}, false, record.samples);
  if (turning_with(angles, record.angle, 1) > turns_along) return "";
  struct Unit {
    double factor;
    const char* name;
  };
  std::vector<Unit> units = {{degrees_per_radian, "radians"}, {360, "turns"}, {3.6, "percent"}};
  for (int bits = 10; bits <= 24; ++bits)
    units.push_back({360 / std::ldexp(1.0, bits), "counts of an encoder"});
  for (const Unit& unit : units)
    if (turning_with(angles, record.angle, unit.factor) > certain)
      return fmt::format(
          "the column of the true angle does not turn with the signals; it seems to be {}: write "
          "degrees",
          unit.name);
  for (int pairs = 2; pairs <= 64; ++pairs) {
    if (turning_with(angles, record.angle, pairs) > certain)
      return fmt::format(
          "the column of the true angle does not turn with the signals, which turn {} times as "
          "fast: a sensor of {} pole pairs; write the electrical angle",
          pairs, pairs);
    if (turning_with(angles, record.angle, 1.0 / pairs) > certain)
      return fmt::format(
          "the column of the true angle turns {} times as fast as the signals: write the angle of "
          "one period of the signals",
          pairs);
  }
  return "the column of the true angle does not turn with the signals: it is not used; look at its "
         "unit and whether it belongs to these samples";
}

std::optional<identification::Parameters> truth_of(const sensor::Description& d) {
  if (!d.a1 || !d.a2 || !d.b1 || !d.b2 || !d.beta) return std::nullopt;
  return identification::canonical({*d.a1, *d.a2, *d.b1, *d.b2, *d.beta}).parameters;
}

double difference(const identification::Parameters& one, const identification::Parameters& other) {
  return std::max({std::fabs(one.a1 - other.a1) / other.a1, std::fabs(one.a2 - other.a2) / other.a2,
                   std::fabs(one.b1 - other.b1) / other.a1, std::fabs(one.b2 - other.b2) / other.a2,
                   std::fabs(one.beta - other.beta)});
}

Attempt training_attempt(const Record& record, const identification::Identification& found,
                         const identification::Parameters& answer) {
  Attempt attempt;
  attempt.method = identification::to_string(found.method);
  attempt.loss = found.loss;
  attempt.iterations = found.iterations;
  attempt.stopped = identification::to_string(found.stopped);
  attempt.error = found.rejection();
  if (found.rejected()) return attempt;
  attempt.parameters = found.network_parameters;
  attempt.difference = difference(found.network_parameters, answer);
  attempt.angle_error_deg = angle_error(record, found.network_parameters);
  return attempt;
}

Attempt companion_attempt(const Record& record, const identification::Companion& companion) {
  Attempt attempt;
  attempt.method = identification::to_string(companion.method);
  attempt.parameters = companion.parameters;
  attempt.error = companion.error;
  attempt.loss = companion.loss;
  attempt.difference = companion.difference;
  if (companion.parameters) attempt.angle_error_deg = angle_error(record, *companion.parameters);
  return attempt;
}

Attempt peer_attempt(const Record& record, identification::Peer peer,
                     const identification::Parameters& answer) {
  Attempt attempt;
  attempt.method = identification::to_string(peer);
  const identification::Samples& samples = record.samples;
  const auto found = identification::identify_by(peer, samples.u, samples.v);
  if (!found) {
    attempt.error = found.error();
    return attempt;
  }
  const identification::Parameters& p = found.value().parameters;
  attempt.parameters = p;
  attempt.iterations = found.value().steps;
  attempt.loss =
      identification::FusedNetwork().loss(identification::to_nodes(p), samples.u, samples.v);
  attempt.difference = difference(p, answer);
  attempt.angle_error_deg = angle_error(record, p);
  return attempt;
}

/// The answer's method, the trainings, the closed forms, and the papers' other methods.
std::vector<Attempt> all_attempts(const Fit& fit, identification::IdentifyOptions options) {
  const identification::Parameters& answer = fit.answer.network_parameters;
  std::vector<Attempt> attempts = {training_attempt(fit.record, fit.answer, answer)};
  options.harmonics = {};
  options.trace = false;
  for (const identification::Method method :
       {identification::Method::adam, identification::Method::levenberg_marquardt}) {
    options.method = method;
    if (method == fit.answer.method) continue;
    if (const auto other = identification::identify(fit.record.samples, options))
      attempts.push_back(training_attempt(fit.record, other.value(), answer));
  }
  for (const identification::Companion& companion : fit.answer.companions)
    attempts.push_back(companion_attempt(fit.record, companion));
  for (const identification::Peer peer : identification::all_peers)
    attempts.push_back(peer_attempt(fit.record, peer, answer));
  return attempts;
}

}  // namespace

Result<Fit> fit(const std::string& trace, const FitOptions& options) {
  auto record = read_record(trace, options.record);
  if (!record) return Error{record.error()};
  Fit fit;
  fit.record = std::move(record.value());
  if (options.use_angle && fit.record.angle.size() == 0)
    return Error{fmt::format(
        "{}: --use-angle needs a true angle of every sample; name its column with --columns",
        trace)};
  const identification::Samples& samples = fit.record.samples;
  if (const auto error = identification::check_samples(samples.u, samples.v)) {
    fit.rejection = error->text;
    return fit;
  }
  identification::IdentifyOptions identify = options.identify;
  identify.gates.full_scale = fit.record.full_scale;
  identify.step = fit.record.step;
  auto answer = identification::identify(fit.record.samples, identify);
  if (!answer) return Error{fmt::format("{}: {}", trace, answer.error())};
  fit.answer = std::move(answer.value());
  fit.truth = truth_of(fit.record.description);
  fit.rejection = fit.answer.rejection();
  if (!fit.rejection.empty()) return fit;

  const identification::Parameters& p = fit.answer.parameters;
  const auto words = metrics::to_words({p.a1, p.a2, p.b1, p.b2, p.beta, 0});
  if (!words) {
    fit.rejection = fmt::format(
        "amplitudes {:.6g} and {:.6g} with offsets {:.6g} and {:.6g} do not fit the registers, "
        "which end at full scale = 1: record with less gain",
        p.a1, p.a2, p.b1, p.b2);
    return fit;
  }
  fit.words = *words;
  fit.angle_column = reason_against_angle(fit.record, p);
  if (options.use_angle) {
    fit.rejection = fit.angle_column;
    if (!fit.rejection.empty()) return fit;
    fit.error_curve =
        identification::error_curve_of(samples, fit.record.angle, p, fit.answer.outliers);
  }
  // A column of something else is no truth for anything that follows.
  if (!fit.angle_column.empty()) fit.record.angle.resize(0);
  fit.errors = angle_errors(fit.record, fit.answer);
  if (options.all_methods) fit.attempts = all_attempts(fit, identify);
  return fit;
}

}  // namespace capsoc::fit
