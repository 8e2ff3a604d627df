#include "accuracy/accuracy.h"

#include <fmt/format.h>

#include <algorithm>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "accuracy/drift.h"
#include "accuracy/experiment.h"
#include "accuracy/peers.h"
#include "accuracy/report.h"

namespace capsoc::accuracy {
namespace {

using coprocessor::ReferenceSource;
using sensor::SignalConfig;

constexpr double sensor_bound_deg = 1e-5;
constexpr double tracking_bound_deg = 1e-3;
constexpr double angle_bound_deg = 1e-6;
constexpr double angle_bound_s = 20.0;
constexpr double paper_useful_deg = 0.1;  // above: the arithmetic has failed, not just rounded

SignalConfig sensor_of(double a1, double a2, double b1, double b2) {
  SignalConfig signal;
  signal.a1 = a1;
  signal.a2 = a2;
  signal.b1 = b1;
  signal.b2 = b2;
  return signal;
}

/// The sensors of the first table. Amplitude and offset together stay below full scale.
std::vector<SignalConfig> sensors() {
  std::vector<SignalConfig> all(1);  // Eq (21), for comparison
  for (double a : {0.01, 0.02, 0.05, 0.1, 0.2, 0.3, 0.6, 0.9, 0.95}) {
    all.push_back(sensor_of(a, a, 0.03, -0.02));
  }
  all.push_back(sensor_of(0.9, 0.1, 0.05, 0.05));
  all.push_back(sensor_of(0.65, 0.65, 0.3, -0.3));
  all.push_back(sensor_of(0.65, 0.65, -0.3, 0.3));
  for (double beta : {-1.0, -0.5, 0.5, 0.9032, 1.0, 1.4, 1.5, 3.08, -3.08}) {
    all.emplace_back().beta = beta;
  }
  for (double phi : {0.8, 1.6, 2.4, 3.1, -3.0, -1.5, -0.5}) all.emplace_back().phi = phi;
  all.emplace_back().motion.frequency_hz = -0.05;
  return all;
}

void print_sensors(Report& report) {
  report.heading(
      "sensors",
      fmt::format("Sensors beyond the paper: largest angle error in the last revolution of 600 s, "
                  "bound for precise {:g} deg",
                  sensor_bound_deg),
      fmt::format("{:>6} {:>6} {:>6} {:>6} {:>8} {:>7} {:>8}", "a1", "a2", "b1", "b2", "beta rad",
                  "phi rad", "speed Hz"));
  double worst = 0.0;
  int rows = 0, paper_fails = 0;
  for (const SignalConfig& s : sensors()) {
    Experiment e;
    e.signal = s;
    e.reference_hz = s.motion.frequency_hz;
    e.duration_s = 600.0;
    const Comparison c = compare(e);
    ++rows;
    worst = std::max(worst, c.precise.error_deg);
    if (c.paper.error_deg > paper_useful_deg) ++paper_fails;
    report.row(fmt::format("{:>6g} {:>6g} {:>6g} {:>6g} {:>8g} {:>7g} {:>8g}", s.a1, s.a2, s.b1,
                           s.b2, s.beta, s.phi, s.motion.frequency_hz),
               c, sensor_bound_deg);
  }
  // Measured: the PI arctangent alone, at amplitude a1 a2 cos(beta), gives the errors of these
  // rows: 2.54 deg at beta = 0.9032, 18.8 deg at 1, 177.6 deg at a1 = a2 = 0.3.
  report.line(
      "  Precise is within {:.1e} deg for all {} sensors. Paper is off by more than {:g} deg for "
      "{} of them: Eq (12) gives its PI arctangent the amplitude a1 a2 cos(beta). For 30 "
      "iterations to suffice, that has to be well above zero.",
      worst, rows, paper_useful_deg, paper_fails);
}

void print_widths(Report& report) {
  report.heading("widths", "Converter width: sensor of Eq (21), last revolution of 400 s",
                 "ADC bit");
  for (int bits : {12, 16, 20, 24, 32}) {
    Experiment e;
    e.signal.adc_bits = bits;
    report.row(fmt::format("{}", bits), compare(e));
  }
  report.line(
      "  The converter decides up to 24 bits, where precise gains a factor of 16 with every 4 "
      "bits; paper reaches the limit of its own arithmetic between 16 and 20 bits.");
}

Figure seconds(const Outcome& o) {
  return {o.settled_s ? fmt::format("{:.2f}", *o.settled_s) : "not", o.settled_s};
}

void print_ripple(Report& report) {
  report.heading(
      "ripple",
      fmt::format("Moving speed: 1 % ripple at 0.01 Hz, tracking source, last ripple period "
                  "(100 s) of 1000 s, bound for precise {:g} deg",
                  tracking_bound_deg),
      "reference");
  Experiment e;
  e.signal.motion.kind = sensor::MotionKind::ripple;
  e.signal.motion.ripple_amplitude = 0.01;
  e.signal.motion.ripple_hz = 0.01;
  e.source = ReferenceSource::tracking;
  e.duration_s = 1000.0;
  e.window_s = 100.0;
  report.row("tracking, 0.05 Hz", compare(e), tracking_bound_deg);
  report.line(
      "  The tracking source follows a speed that moves, so that the fixed frequency word is only "
      "its start.");
}

void print_shuffled(Report& report) {
  report.heading(
      "shuffled",
      fmt::format("Random angles: angle source, 2mu = 0.01, last 20 s of 400 s, bounds for precise "
                  "{:g} deg and {:g} s",
                  angle_bound_deg, angle_bound_s),
      "figure", "");
  Experiment e;
  e.signal.motion.kind = sensor::MotionKind::shuffled;
  e.signal.motion.seed = 1;
  e.source = ReferenceSource::angle;
  e.reference_hz = 0.0;
  e.step = 0.01;
  const Comparison c = compare(e);
  report.row("angle error, deg", c, angle_bound_deg);
  report.add({"a1, a2, b1, b2, beta within 1 % for good after, s", "s", seconds(c.precise),
              seconds(c.paper), angle_bound_s,
              Report::verdict(c.precise.settled_s && *c.precise.settled_s <= angle_bound_s)});
  report.line(
      "  Calibration needs no rotation: angles in random order identify the sensor without a "
      "frequency, phi apart, which is not observable there.");
}

void print_wrong_reference(Report& report) {
  report.heading("reference", "Wrong reference: last revolution of 400 s, no correction",
                 "shaft, reference");
  Experiment e;
  e.signal.motion.frequency_hz = 0.051;
  e.reference_hz = 0.05;
  report.row("0.051 Hz, numeric 0.050 Hz", compare(e));
  report.line(
      "  A reference that is 2 % slow leaves an error that stays, as the weights have to turn with "
      "the difference; the tracking source is the remedy.");
}

}  // namespace

int print_accuracy(std::ostream& out, const std::vector<std::string>& chosen,
                   std::vector<DataTable>* tables) {
  Report report(out, chosen);
  report.line(
      "Angle errors of the coprocessor model against the sensor's true angle, 250 Hz, shaft 0.05 "
      "Hz and sensor of Eq (21) unless stated; amplitudes and offsets in units of full scale.");
  if (report.wants("sensors")) print_sensors(report);
  if (report.wants("widths")) print_widths(report);
  if (report.wants("ripple")) print_ripple(report);
  if (report.wants("shuffled")) print_shuffled(report);
  if (report.wants("reference")) print_wrong_reference(report);
  if (report.wants("drift")) print_drift(report);
  if (report.wants("peers")) print_peers(report);
  report.line("\nRows that miss their bound: {}.", report.missed());
  if (tables != nullptr) *tables = report.tables();
  return report.missed();
}

}  // namespace capsoc::accuracy
