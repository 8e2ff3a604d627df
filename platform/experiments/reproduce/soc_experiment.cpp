#include "reproduce/soc_experiment.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "csfn/calibration.h"
#include "fit/fit.h"
#include "metrics/metrics.h"
#include "reproduce/coprocessor_run.h"
#include "support/constants.h"

namespace capsoc::reproduce {
namespace {

constexpr Eigen::Index demodulated = 100000;  // 400 s
constexpr Eigen::Index turn = 4902;           // samples of a turn at 0.051 Hz

/// As the paper counts: the peak-to-peak error, and the largest deviation from the mean error.
struct Errors {
  double peak_to_peak = 0, largest = 0;  ///< degrees
};

/// `turns`: differences to the true angle in turns, any branch; less than half a turn apart.
Errors errors_of(const std::vector<double>& turns) {
  double least = 0, greatest = 0, sum = 0;
  for (const double value : turns) {
    const double difference = 360 * std::remainder(value - turns.front(), 1.0);
    least = std::min(least, difference);
    greatest = std::max(greatest, difference);
    sum += difference;
  }
  const double mean = sum / static_cast<double>(turns.size());
  return {greatest - least, std::max(greatest - mean, mean - least)};
}

void error_rows(Report& report, const std::string& what, const Errors& paper, const Errors& here,
                double relative) {
  report.row(what + ", peak to peak, deg", fixed(paper.peak_to_peak, 4),
             fixed(here.peak_to_peak, 4),
             agrees(here.peak_to_peak, paper.peak_to_peak, 4, relative));
  report.row(what + ", largest, deg", fixed(paper.largest, 4), fixed(here.largest, 4),
             agrees(here.largest, paper.largest, 4, relative));
}

/// The turntable's forward angle in turns, against which the paper's sensor counts backwards.
double forward_turns(const fit::Record& record, Eigen::Index k) {
  return -record.angle[k] / (2 * pi);
}

int32_t word(double value) {
  return static_cast<int32_t>(std::llround(value * 0x1p31));
}

/// The SoC of the paper over 400 s: its arithmetic and steps, the reference at 0.050 Hz.
struct Demodulation {
  Errors on_line;                              ///< over the last turn
  std::vector<std::array<uint32_t, 6>> words;  ///< at moments spread over the last turn
};

Demodulation demodulate(const fit::Record& record) {
  constexpr Eigen::Index stride = turn / 24;
  CoprocessorRun soc;
  soc.control(coprocessor::ctrl_demod | coprocessor::ctrl_calib);
  Demodulation result;
  std::vector<double> turns;
  for (Eigen::Index k = 0; k < demodulated; ++k) {
    soc.submit(word(record.samples.u[k]), word(record.samples.v[k]));
    if (k < demodulated - turn) continue;
    turns.push_back(soc.read(coprocessor::reg_angle) * 0x1p-32 - forward_turns(record, k));
    if ((demodulated - 1 - k) % stride == 0) result.words.push_back(soc.parameter_words());
  }
  result.on_line = errors_of(turns);
  return result;
}

/// Errors of a turn with parameters that were stored.
Errors frozen(const fit::Record& record, const std::array<uint32_t, 6>& words) {
  const metrics::Parameters p = metrics::to_values(
      {static_cast<int32_t>(words[0]), static_cast<int32_t>(words[1]),
       static_cast<int32_t>(words[2]), static_cast<int32_t>(words[3]), words[4], words[5]});
  const csfn::Parameters stored{p.a1, p.a2, p.b1, p.b2, p.beta};
  std::vector<double> turns;
  for (Eigen::Index k = 0; k < turn; ++k) {
    const double angle = csfn::angle_of(stored, record.samples.u[k], record.samples.v[k]);
    turns.push_back(angle / (2 * pi) - forward_turns(record, k));
  }
  return errors_of(turns);
}

Errors uncalibrated(const fit::Record& record) {
  std::vector<double> turns;
  for (Eigen::Index k = 0; k < turn; ++k) {
    const double angle = csfn::uncalibrated_angle(record.samples.u[k], record.samples.v[k]);
    turns.push_back((angle - record.angle[k]) / (2 * pi));
  }
  return errors_of(turns);
}

void table_9(Report& report, const fit::Record& record) {
  constexpr std::array<const char*, 6> six = {"a1", "a2", "b1", "b2", "beta", "phi"};
  constexpr std::array<double, 6> printed = {1308364580, 1336685245, 274228330,
                                             388108700,  2105078019, 3700681650};
  report.heading("figure-17");
  error_rows(report, "uncalibrated", {43.3964, 22.5154}, uncalibrated(record), 0.002);

  const Demodulation soc = demodulate(record);
  report.heading("9");
  report.sentence(
      "Here: least .. greatest within the last turn before 400 s, since the reference is");
  report.sentence("2 % slow and the steps follow the harmonics within a turn.");
  for (std::size_t i = 0; i < six.size(); ++i) {
    Spread spread;
    for (const auto& words : soc.words) spread.add(words.at(i));
    const Figure paper = fixed(printed.at(i), 0), here = spread.figure(0);
    if (i == 0) {
      report.known(six.at(i), paper, here,
                   "the trace has it, but this reference and these harmonics lower it.");
    } else if (i == 5) {
      report.known(six.at(i), paper, here, "the reference drifts by 0.4 turns in 400 s.");
    } else {
      report.row(six.at(i), paper, here, spread.admits(printed.at(i), 0));
    }
  }
  report.heading("figure-18");
  error_rows(report, "demodulation", {1.7189, 0.9814}, soc.on_line, 0.1);
  Spread peak_to_peak, largest;
  for (const auto& words : soc.words) {
    const Errors errors = frozen(record, words);
    peak_to_peak.add(errors.peak_to_peak);
    largest.add(errors.largest);
  }
  report.sentence("Calibration mode: with the parameters stored at any moment of the last turn.");
  const std::string why = "the paper's harmonics are not known, nor when it stored them.";
  report.known("calibration, peak to peak, deg", "1.8683", peak_to_peak.figure(4), why);
  report.known("calibration, largest, deg", "1.1630", largest.figure(4), why);
}

void table_10(Report& report, const std::string& trace) {
  report.heading("10");
  fit::FitOptions options;
  options.record.samples = demodulated;
  const auto fitted = fit::fit(trace, options);
  if (!fitted || !fitted.value().rejection.empty()) {
    report.failure(trace, fitted ? fitted.value().rejection : fitted.error());
    return;
  }
  const csfn::Parameters& p = fitted.value().answer.parameters;
  const auto row = [&](const char* name, double printed, double here) {
    report.row(name, fixed(printed, 4), fixed(here, 4), agrees(here, printed, 4, 0.02));
  };
  row("a1", 0.6085, p.a1);
  row("a2", 0.6221, p.a2);
  report.known("b1", "0.1323", fixed(p.b1, 4),
               "the trace was rebuilt from Table 9, and its harmonics pull the ellipse.");
  row("b2", 0.1834, p.b2);
  row("beta (pi - ours: reversed)", 3.0734, pi - p.beta);
  const fit::Record& record = fitted.value().record;
  std::vector<double> turns;
  for (Eigen::Index k = 0; k < turn; ++k) {
    const double angle = csfn::angle_of(p, record.samples.u[k], record.samples.v[k]);
    turns.push_back((angle - record.angle[k]) / (2 * pi));
  }
  error_rows(report, "after", {3.0617, 1.7284}, errors_of(turns), 0.25);
}

}  // namespace

void soc_experiment_tables(Report& report, const std::string& traces) {
  if (!report.wants({"figure-17", "9", "figure-18", "10"})) return;
  const std::string trace = traces + "/soc_experiment.toml";
  fit::RecordOptions options;
  options.samples = demodulated + turn;
  const auto record = fit::read_record(trace, options);
  if (!record) {
    report.failure(trace, record.error());
    return;
  }
  if (report.wants({"figure-17", "9", "figure-18"})) table_9(report, record.value());
  if (report.wants({"10"})) table_10(report, trace);
}

}  // namespace capsoc::reproduce
