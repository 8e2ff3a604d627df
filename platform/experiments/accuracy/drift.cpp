#include "accuracy/drift.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "accuracy/experiment.h"
#include "accuracy/following.h"
#include "base/constants.h"
#include "base/random.h"

namespace capsoc::accuracy {
namespace {

using Speeds = std::vector<sensor::SpeedPoint>;

constexpr double rate_hz = 5000;  // 50 samples in a turn of 10 ms
constexpr double drift_per_s = 1e-3;
/// Worst error of an angle if every parameter drifts by 1, with opposing signs:
/// [|cos(theta + beta)| (|sin theta| + 1) +
///  |sin theta| (|cos(theta + beta)| + 1 + |sin(theta + beta)|)] / cos(beta).
/// It is at most 3.12 for the sensor of Eq (21), and 5.75 for a beta of 0.8.
constexpr double worst_of_all = 3.12;
constexpr double worst_of_all_drawn = 5.75;
constexpr double drawn_settled_deg = 0.05;  // they start further off
/// In units of sigma / a1: the angle of a single sample is off by sqrt(1 + (a1 / a2)^2) / cos(beta)
/// times it, for five sigma.
constexpr double worst_noise = 5 * 3.2;

/// A course of the shaft. Steps of speed take half a second.
struct Case {
  const char* name;
  Speeds speeds;
  double duration_s;
  /// The longest time, turns on the way included, for which an angle has to make do with what was
  /// learnt before: two turns of the slowest, and the rest with the part turns around it.
  double unlearnt_s;
  double settled_deg = 5e-4;  ///< what the first turns leave of the start's half degree
};

const Speeds one = {{0, 1}};
const Speeds rests = {{0, 1}, {12, 1}, {12.5, 0}, {22.5, 0}, {23, 1}};
const Speeds reverses = {{0, 2}, {6, 2}, {6.5, -2}, {11, -2}, {11.5, 2}, {16, 2}, {16.5, -2}};
const Speeds runs_up = {{0, 0},  {1, 0},  {11, 100},  {13, 100},
                        {23, 0}, {25, 0}, {35, -100}, {45, 0}};
const Speeds everything = {{0, 0},     {0.5, 2},  {6, 2},    {11, 100}, {14, 100}, {16, 1},
                           {20, 1},    {20.5, 0}, {25.5, 0}, {26, -1},  {30, -1},  {31, -100},
                           {34, -100}, {35, 20},  {39, 20},  {40, 0},   {45, 0},   {46, 5}};

const std::vector<Case>& cases() {
  static const std::vector<Case> all = {
      {"0.1 turns/s", {{0, 0.1}}, 120, 20},
      {"1 turn/s", one, 40, 2},
      {"10 turns/s", {{0, 10}}, 20, 0.2},
      {"100 turns/s", {{0, 100}}, 10, 0.02, 5e-3},
      // Half a turn or less before and after the rest belongs to no whole turn.
      {"1 turn/s, 10 s at rest, 1 turn/s", rests, 40, 14},
      {"2 turns/s, reversed every 5 s", reverses, 30, 2},
      // 10 turns/s^2: the first eighth of a turn takes 0.16 s, two turns 0.65 s, before as after.
      {"0 .. 100 .. 0 .. -100 .. 0 turns/s", runs_up, 48, 4, 5e-3},
      {"0 .. 100 turns/s, reversals, 5 s at rest", everything, 55, 9},
  };
  return all;
}

sensor::SignalConfig sensor_on(const Speeds& speeds) {
  sensor::SignalConfig signal;
  signal.sample_rate_hz = rate_hz;
  signal.motion.kind = sensor::MotionKind::profile;
  signal.motion.speeds = speeds;
  return signal;
}

/// The signs with which the parts of the angle's error add up.
void drifts(sensor::SignalConfig& signal) {
  sensor::DriftConfig& drift = signal.drift;
  drift.a1 = drift.b1 = drift.beta = drift_per_s;
  drift.a2 = drift.b2 = -drift_per_s;
  drift.until_s = 200.0;
}

FollowingRun run_of(const Case& one_case, bool drifting) {
  FollowingRun run;
  run.signal = sensor_on(one_case.speeds);
  run.duration_s = one_case.duration_s;
  if (drifting) drifts(run.signal);
  return run;
}

/// A row of the data and its line; `lms` next to it, where it was run.
void add(Report& report, const std::string& name, const FollowingOutcome& outcome, double bound_deg,
         const std::optional<Comparison>& lms = std::nullopt) {
  Row row{name, "deg", degrees(outcome.error_deg), {}, bound_deg};
  row.verdict = Report::verdict(outcome.locked && outcome.error_deg <= bound_deg);
  if (outcome.clipped) row.verdict = Row::Verdict::clips;
  report.add_data(row);
  const double frozen = 100 * outcome.frozen_part;
  report.add_data({name + ": frozen", "%", {"", frozen}, {}, std::nullopt});
  std::string compared = fmt::format("{:>10} {:>10}", "-", "-");
  if (lms) {
    const Figure precise = degrees(lms->precise.error_deg), paper = degrees(lms->paper.error_deg);
    report.add_data({name + ": LMS", "deg", precise, paper, std::nullopt});
    compared = fmt::format("{:>10} {:>10}", precise.text, paper.text);
  }
  report.line("  {:<48} {:>5.1f} {:>9} {:>9.2e} {}  {}", name, frozen, row.precise.text, bound_deg,
              compared, row.verdict == Row::Verdict::holds ? "holds" : "MISSES ITS BOUND");
}

/// LMS on the same record, with a constant step that fits one turn a second. The second half is
/// compared, since LMS starts from the reset's coefficients.
Comparison lms_on(const Case& one_case) {
  Experiment e;
  e.signal = sensor_on(one_case.speeds);
  drifts(e.signal);
  e.source = coprocessor::ReferenceSource::angle;
  e.step = pi / rate_hz;
  e.duration_s = one_case.duration_s;
  e.window_s = one_case.duration_s / 2;
  return compare(e);
}

/// The worst of random sensors on one course. Amplitudes are 0.05 .. 0.85 and their ratio up to 2,
/// offsets to 0.5, beta to 0.8 rad, phi anywhere, every drift rate between -0.1 and 0.1 % a second.
/// `noise` is in units of a1, and the converter has 14 bits.
FollowingOutcome worst_drawn(const Case& one_case, double noise) {
  constexpr int sensors = 20, numbers = 12;
  const RandomSequence random(1, 0);
  FollowingOutcome worst;
  worst.locked = true;
  for (uint64_t i = 0; i < sensors; ++i) {
    FollowingRun run = run_of(one_case, false);
    sensor::SignalConfig& signal = run.signal;
    uint64_t next = i * numbers;
    const auto between = [&](double least, double greatest) {
      return least + (greatest - least) * random.uniform(next++);
    };
    signal.a1 = std::exp(between(std::log(0.05), std::log(0.85)));
    signal.a2 = std::min(0.85, signal.a1 * std::exp(between(-std::log(2), std::log(2))));
    signal.b1 = between(-1, 1) * std::min(0.5, 0.9 - signal.a1);
    signal.b2 = between(-1, 1) * std::min(0.5, 0.9 - signal.a2);
    signal.beta = between(-0.8, 0.8);
    signal.phi = between(-3, 3);
    sensor::DriftConfig& drift = signal.drift;
    for (double* rate : {&drift.a1, &drift.a2, &drift.b1, &drift.b2, &drift.beta})
      *rate = between(-drift_per_s, drift_per_s);
    drift.until_s = 200.0;
    if (noise > 0) {
      signal.adc_bits = 14;
      signal.noise.sigma = noise * signal.a1;
      signal.noise.seed = i + 1;
    }
    const FollowingOutcome outcome = follow(run);
    worst.locked = worst.locked && outcome.locked;
    worst.clipped = worst.clipped || outcome.clipped;
    worst.error_deg = std::max(worst.error_deg, outcome.error_deg);
    worst.frozen_part = std::max(worst.frozen_part, outcome.frozen_part);
  }
  return worst;
}

double moved_deg(double rates, const Case& one_case) {
  return drift_per_s * rates * one_case.unlearnt_s / radians_per_degree;
}

}  // namespace

void print_drift(Report& report) {
  report.heading(
      "drift",
      fmt::format("Parameters and speeds that move: follow at {:g} Hz, largest angle error of all "
                  "samples after its lock, deg; drift: amplitudes, offsets and beta by {:g} % a "
                  "second",
                  rate_hz, 100 * drift_per_s));
  report.line("  {:<48} {:>5} {:>9} {:>9} {:>10} {:>10}", "shaft", "rest%", "error", "bound", "LMS",
              "LMS, paper");
  for (const Case& one_case : cases())
    add(report, one_case.name, follow(run_of(one_case, false)), one_case.settled_deg);
  for (const Case& one_case : cases())
    add(report, fmt::format("drift, {}", one_case.name), follow(run_of(one_case, true)),
        one_case.settled_deg + moved_deg(worst_of_all, one_case), lms_on(one_case));
  const Case& all = cases().back();
  FollowingRun course = run_of(all, true);
  course.signal.drift.until_s.reset();
  course.signal.drift.period_s = 60;
  add(report, "the last, the drift a sine of 60 s", follow(course),
      all.settled_deg + moved_deg(worst_of_all, all));
  add(report, "the last, worst of 20 random sensors", worst_drawn(all, 0),
      drawn_settled_deg + moved_deg(worst_of_all_drawn, all));
  constexpr double noise = 2e-3;
  add(report, "the same in 14 bits with noise of 0.2 % of a1", worst_drawn(all, noise),
      drawn_settled_deg + moved_deg(worst_of_all_drawn, all) +
          noise * worst_noise / radians_per_degree);
  report.line(
      "  The bound is {:g} times the drift in the longest time without a learnt turn ({:g} for "
      "random sensors), plus what the first turns leave. They leave 5e-4 deg, 5e-3 with few "
      "samples a turn, and {:g} for random sensors. LMS continues to learn at rest, which tells it "
      "half of what moves there; its one step is a compromise everywhere else.",
      worst_of_all, worst_of_all_drawn, drawn_settled_deg);
}

}  // namespace capsoc::accuracy
