#include "reproduce/drawn.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>

#include "base/constants.h"
#include "fit/drawn.h"
#include "fit/fit.h"
#include "identification/calibration.h"
#include "identification/lms_reference.h"
#include "reproduce/figures.h"
#include "reproduce/lms_experiment.h"
#include "reproduce/paper_words.h"
#include "reproduce/rtl_experiment.h"
#include "reproduce/soc_experiment.h"
#include "sensor/described_source.h"

namespace capsoc::reproduce {
namespace {

constexpr std::size_t buckets = 400;
constexpr int digits = 7;
constexpr std::array<const char*, 6> six = {"a1", "a2", "b1", "b2", "beta", "phi"};
using Points = std::vector<std::pair<double, double>>;

class Drawing {
 public:
  explicit Drawing(const std::vector<std::string>& chosen) : chosen_(chosen) {}

  bool wants(const char* table) const {
    return chosen_.empty() || std::count(chosen_.begin(), chosen_.end(), table) != 0;
  }

  void add(const std::string& figure, const std::string& line, const Curve& curve) {
    Curve few = thinned(curve, buckets);
    for (double& x : few.x) x = rounded(x, digits);
    for (double& y : few.y) y = rounded(y, digits);
    curves_.emplace_back(figure + "." + line, std::move(few));
  }

  /// Evenly taken: no function of x.
  void add_points(const std::string& figure, const std::string& line, const Curve& curve) {
    Curve some;
    const std::size_t step = curve.x.size() / (2 * buckets) + 1;
    for (std::size_t i = 0; i < curve.x.size(); i += step) some.add(curve.x[i], curve.y[i]);
    add(figure, line, some);
  }

  Curves take() { return std::move(curves_); }

 private:
  const std::vector<std::string>& chosen_;
  Curves curves_;
};

Curve sorted(Points points) {
  std::sort(points.begin(), points.end());
  Curve curve;
  for (const auto& [x, y] : points) curve.add(x, y);
  return curve;
}

double in_degrees(double radians) {
  return radians * degrees_per_radian;
}

/// 0 .. 360.
double turn_of(double radians) {
  return 360 * (radians / two_pi - std::floor(radians / two_pi));
}

/// A run of the LMSED with what Figure 7 draws of it.
struct Learning {
  std::array<Curve, 6> parameters;
  Curve error_u, error_v, before, after, raw, calibrated, sine, cosine;
};

Learning learn(const Experiment& experiment) {
  const double rate = experiment.signal.sample_rate_hz;
  const auto count = static_cast<uint64_t>(std::llround(experiment.duration_s * rate));
  sensor::DescribedSource source(experiment.signal);
  identification::lms::LmsReference lms(experiment.steps, experiment.gain);
  Learning drawn;
  std::vector<std::array<double, 3>> samples;
  for (uint64_t k = 0; k < count; ++k) {
    const double t = static_cast<double>(k) / rate;
    const auto value = source.sample(k, t);
    if (!value) break;
    const double reference = two_pi * value->reference_turns;
    lms.update(std::sin(reference), std::cos(reference), value->u, value->v);
    const identification::lms::Parameters p = lms.parameters();
    const std::array<double, 6> now = {p.a1, p.a2, p.b1, p.b2, p.beta, p.phi};
    for (std::size_t i = 0; i < now.size(); ++i) drawn.parameters.at(i).add(t, now.at(i));
    drawn.error_u.add(t, lms.error_u());
    drawn.error_v.add(t, lms.error_v());
    samples.push_back({value->u, value->v, reference});
  }
  // As the paper's Table 1: the parameters of the end for the whole record, against omega k.
  const identification::lms::Parameters end = lms.parameters();
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const auto& [u, v, reference] = samples[k];
    const double t = static_cast<double>(k) / rate;
    const double angle = identification::lms::calibrated_angle(end, u, v);
    drawn.raw.add(t, in_degrees(identification::lms::wrapped(std::atan2(u, v) - reference)));
    drawn.calibrated.add(t, in_degrees(identification::lms::wrapped(angle - end.phi - reference)));
    if (t > 40) continue;  // two turns
    drawn.before.add(t, u);
    drawn.after.add(t, v);
    drawn.sine.add(t, std::sin(angle));
    drawn.cosine.add(t, std::cos(angle));
  }
  return drawn;
}

Curve over(const Curve& x, const Curve& y) {
  return {x.y, y.y};
}

void soc_figures_6_to_8(Drawing& drawing) {
  if (!drawing.wants("1") && !drawing.wants("figure-7")) return;
  Experiment experiment;
  experiment.steps = {{3e-4, 3e-4, 3e-4}, {5e-4, 3e-4, 1e-4}};
  const Learning run = learn(experiment);
  if (drawing.wants("1")) {
    drawing.add_points("soc-6-a", "U, V", over(run.before, run.after));
    drawing.add("soc-6-b", "U", run.before);
    drawing.add("soc-6-b", "V", run.after);
    drawing.add("soc-8", "without calibration", run.raw);
    drawing.add("soc-8", "with calibration", run.calibrated);
  }
  if (!drawing.wants("figure-7")) return;
  for (std::size_t i = 0; i < six.size(); ++i)
    drawing.add(fmt::format("soc-7-{}", six.at(i)), six.at(i), run.parameters.at(i));
  drawing.add("soc-7-error", "U", run.error_u);
  drawing.add("soc-7-error", "V", run.error_v);
  drawing.add("soc-7-signals", "sine", run.sine);
  drawing.add("soc-7-signals", "cosine", run.cosine);
}

void soc_figure_9(Drawing& drawing) {
  if (!drawing.wants("figure-9")) return;
  Experiment experiment;
  experiment.signal.motion.frequency_hz = 100.0;
  experiment.steps = {{0.2, 0.2, 0.2}, {0.5, 0.3, 0.1}};
  experiment.duration_s = 1.0;
  const Learning run = learn(experiment);
  for (std::size_t i = 0; i < six.size(); ++i)
    drawing.add(fmt::format("soc-9-{}", six.at(i)), six.at(i), run.parameters.at(i));
}

void soc_figure_10(Drawing& drawing) {
  if (!drawing.wants("figure-10")) return;
  for (const int m : {1, 2, 3, 4})
    drawing.add(fmt::format("soc-10-{}", m), "gain", gain_curve(std::pow(10.0, -m)));
}

void soc_figure_12(Drawing& drawing) {
  if (!drawing.wants("figure-12")) return;
  constexpr int points = 800;
  std::vector<double> times;
  for (int i = 1; i <= points; ++i) times.push_back(400.0 * i / points);
  const auto curve = rtl_learning_curve(times);
  for (std::size_t i = 0; i < six.size(); ++i) {
    Curve one;
    for (std::size_t k = 0; k < curve.size(); ++k)
      one.add(times[k], value_of_word(i, static_cast<int32_t>(curve[k].at(i))));
    drawing.add(fmt::format("soc-12-{}", six.at(i)), six.at(i), one);
  }
}

void soc_figures_13_and_14(Drawing& drawing) {
  if (!drawing.wants("figure-13")) return;
  drawing.add("soc-13", "calibrated", rtl_angle_error());
  for (const double magnitude : {1.0, 0.6}) {
    Curve error;
    arctangent_error(magnitude, &error);
    drawing.add("soc-14", fmt::format("magnitude {:g}", magnitude), error);
  }
}

/// Amplitude over frequency of a record at constant speed.
Curve spectrum_of(const Eigen::ArrayXd& signal, double rate_hz) {
  constexpr double step_hz = 0.001;
  constexpr unsigned steps = 300;
  const Eigen::ArrayXd pure = signal - signal.mean();
  Curve spectrum;
  for (unsigned step = 1; step < steps; ++step) {
    const double hz = step * step_hz;
    std::complex<double> sum = 0, at = 1;
    const std::complex<double> turn = std::polar(1.0, -two_pi * hz / rate_hz);
    for (Eigen::Index k = 0; k < pure.size(); ++k, at *= turn) sum += pure[k] * at;
    spectrum.add(hz, 2 * std::abs(sum) / static_cast<double>(pure.size()));
  }
  return spectrum;
}

void single(Drawing& drawing, const std::string& figure, const std::string& line, double x,
            double y) {
  Curve point;
  point.add(x, y);
  drawing.add(figure, line, point);
}

std::optional<Error> soc_experiment(Drawing& drawing, const std::string& traces) {
  if (drawing.wants("figure-17") || drawing.wants("figure-19")) {
    fit::RecordOptions options;
    options.samples = 100000;
    const auto record = fit::read_record(traces + "/soc_experiment.toml", options);
    if (!record) return Error{record.error()};
    const identification::Samples& samples = record.value().samples;
    for (const auto& [name, signal, letter] :
         {std::tuple{"U", &samples.u, 'a'}, std::tuple{"V", &samples.v, 'b'}}) {
      Curve wave;
      constexpr Eigen::Index drawn = 10000;  // 40 s, two turns
      for (Eigen::Index k = 0; k < drawn; ++k) wave.add(static_cast<double>(k) / 250, (*signal)[k]);
      if (drawing.wants("figure-17")) drawing.add("soc-16", name, wave);
      if (!drawing.wants("figure-19")) continue;
      const std::string figure = fmt::format("soc-19-{}", letter);
      const Curve spectrum = spectrum_of(*signal, 250);
      drawing.add(figure, name, spectrum);
      single(drawing, figure, "paper: fundamental at 0.051 Hz", 0.051,
             *std::max_element(spectrum.y.begin(), spectrum.y.end()));
    }
  }
  if (!drawing.wants("figure-17") && !drawing.wants("figure-18")) return std::nullopt;
  const auto errors = soc_experiment_errors(traces);
  if (!errors) return Error{errors.error()};
  if (drawing.wants("figure-17"))
    drawing.add("soc-17", "without calibration", errors.value().uncalibrated);
  if (!drawing.wants("figure-18")) return std::nullopt;
  drawing.add("soc-18", "demodulation mode", errors.value().demodulation);
  drawing.add("soc-18", "calibration mode", errors.value().calibration);
  drawing.add("soc-18", "CSFN, the method of [9]", errors.value().csfn);
  return std::nullopt;
}

/// The names of a CSFN experiment's figures in the paper; "": it has none.
struct CsfnNames {
  std::string by_sample, by_angle, lissajous, learning, calibrated, calibrated_lissajous, before,
      after;
};

void csfn_signals(Drawing& drawing, const fit::Record& record, const CsfnNames& called) {
  const identification::Samples& samples = record.samples;
  for (const auto& [name, signal] : {std::pair{"U", &samples.u}, std::pair{"V", &samples.v}}) {
    Curve by_sample;
    Points by_angle;
    for (Eigen::Index k = 0; k < signal->size(); ++k) {
      by_sample.add(static_cast<double>(k), (*signal)[k]);
      by_angle.emplace_back(turn_of(record.angle[k]), (*signal)[k]);
    }
    if (!called.by_sample.empty()) drawing.add(called.by_sample, name, by_sample);
    if (!called.by_angle.empty()) drawing.add(called.by_angle, name, sorted(std::move(by_angle)));
  }
  drawing.add_points(called.lissajous, "U, V",
                     {{samples.u.begin(), samples.u.end()}, {samples.v.begin(), samples.v.end()}});
}

void csfn_learning(Drawing& drawing, const fit::Fit& fit, const CsfnNames& called) {
  std::array<Curve, 5> parameters;
  Curve loss;
  for (const identification::TracePoint& point : fit.answer.convergence) {
    const identification::Parameters& p = point.parameters;
    const std::array<double, 5> now = {p.a1, p.a2, p.b1, p.b2, p.beta};
    for (std::size_t i = 0; i < now.size(); ++i) parameters.at(i).add(point.iteration, now.at(i));
    loss.add(point.iteration, point.loss);
  }
  for (std::size_t i = 0; i < parameters.size(); ++i)
    drawing.add(fmt::format("{}-{}", called.learning, six.at(i)), six.at(i), parameters.at(i));
  drawing.add(called.learning + "-loss", "loss", loss);
}

void csfn_calibrated(Drawing& drawing, const fit::Fit& fit, const CsfnNames& called) {
  const identification::Samples& samples = fit.record.samples;
  Eigen::ArrayXd raw(samples.u.size()), found(samples.u.size());
  Points sine, cosine;
  Curve circle;
  for (Eigen::Index k = 0; k < raw.size(); ++k) {
    const identification::Parameters& p = fit.answer.parameters;
    raw[k] = identification::uncalibrated_angle(samples.u[k], samples.v[k]);
    found[k] = identification::angle_of(p, samples.u[k], samples.v[k]);
    const double s = (samples.u[k] - p.b1) / p.a1;
    const double c = ((samples.v[k] - p.b2) / p.a2 + s * std::sin(p.beta)) / std::cos(p.beta);
    const double angle = turn_of(fit.record.angle[k]);
    sine.emplace_back(angle, s);
    cosine.emplace_back(angle, c);
    circle.add(s, c);
  }
  drawing.add(called.before, "before calibration", fit::angle_error_curve(raw, fit.record.angle));
  drawing.add(called.after, "after calibration", fit::angle_error_curve(found, fit.record.angle));
  if (called.calibrated.empty()) return;
  drawing.add_points(called.calibrated_lissajous, "calibrated", circle);
  drawing.add(called.calibrated, "sine", sorted(std::move(sine)));
  drawing.add(called.calibrated, "cosine", sorted(std::move(cosine)));
}

std::optional<Error> csfn_experiment(Drawing& drawing, const std::string& trace,
                                     const CsfnNames& called, int batch) {
  fit::FitOptions options;
  options.identify.method = identification::Method::adam;
  options.identify.trace = true;
  if (batch != 0) options.identify.adam.batch = batch;
  const auto fit = fit::fit(trace, options);
  if (!fit) return Error{fit.error()};
  if (!fit.value().rejection.empty()) return Error{trace + ": " + fit.value().rejection};
  csfn_signals(drawing, fit.value().record, called);
  if (!called.learning.empty()) csfn_learning(drawing, fit.value(), called);
  csfn_calibrated(drawing, fit.value(), called);
  return std::nullopt;
}

std::optional<Error> csfn_spectrum(Drawing& drawing, const std::string& traces) {
  if (!drawing.wants("csfn-figure-23")) return std::nullopt;
  const auto record = fit::read_record(traces + "/csfn_experiment.toml");
  if (!record) return Error{record.error()};
  // By least squares at the true angles: the record is shuffled, so there is no time.
  const identification::Samples& samples = record.value().samples;
  for (const auto& [name, signal] : {std::pair{"U", &samples.u}, std::pair{"V", &samples.v}}) {
    const std::vector<double> amplitudes = order_amplitudes(record.value().angle, *signal, 8);
    Curve orders;
    for (std::size_t h = 0; h < amplitudes.size(); ++h)
      orders.add(static_cast<double>(h), amplitudes[h]);
    drawing.add("csfn-23", name, orders);
  }
  return std::nullopt;
}

std::optional<Error> csfn_figures(Drawing& drawing, const std::string& traces) {
  constexpr int papers_batch = 1000;  // section 4.2
  if (drawing.wants("csfn-1") || drawing.wants("csfn-figure-8"))
    if (auto error = csfn_experiment(drawing, traces + "/csfn_eq.toml",
                                     {"csfn-7-a", "csfn-7-c", "csfn-7-d", "csfn-8", "csfn-11-b",
                                      "csfn-11-a", "csfn-12-a", "csfn-12-b"},
                                     0))
      return error;
  if (drawing.wants("csfn-figure-14"))
    if (auto error = csfn_experiment(
            drawing, traces + "/csfn_h3.toml",
            {"", "csfn-13-a", "csfn-13-b", "", "", "", "csfn-14-a", "csfn-14-b"}, 0))
      return error;
  if (drawing.wants("csfn-2") || drawing.wants("csfn-figure-18"))
    if (auto error = csfn_experiment(drawing, traces + "/csfn_experiment.toml",
                                     {"csfn-17", "csfn-16-a", "csfn-16-b", "csfn-18", "csfn-21-b",
                                      "csfn-21-a", "csfn-22-a", "csfn-22-b"},
                                     papers_batch))
      return error;
  return csfn_spectrum(drawing, traces);
}

}  // namespace

Result<Curves> drawn_figures(const std::string& traces, const std::vector<std::string>& chosen) {
  Drawing drawing(chosen);
  soc_figures_6_to_8(drawing);
  soc_figure_9(drawing);
  soc_figure_10(drawing);
  soc_figure_12(drawing);
  soc_figures_13_and_14(drawing);
  if (auto error = soc_experiment(drawing, traces)) return *error;
  if (auto error = csfn_figures(drawing, traces)) return *error;
  return drawing.take();
}

}  // namespace capsoc::reproduce
