#include "accuracy/peers.h"

#include <cmath>
#include <string>
#include <vector>

#include "accuracy/experiment.h"
#include "base/constants.h"
#include "fit/contenders.h"
#include "identification/calibration.h"
#include "peripherals/quantiser.h"
#include "sensor/described_source.h"

namespace capsoc::accuracy {
namespace {

/// One record and the experiment of the coprocessor on it; LMS and, where there is a turn of the
/// reference, blocks.
struct PeerRecord {
  const char* name;
  Experiment experiment;
  double lms_deg;                    ///< bound of `precise`
  std::optional<double> blocks_deg;  ///< absent: no blocks
};

std::vector<PeerRecord> records() {
  std::vector<PeerRecord> all;
  const auto add = [&](const char* name, double lms_deg, std::optional<double> blocks_deg) {
    return &all.emplace_back(PeerRecord{name, {}, lms_deg, blocks_deg}).experiment;
  };
  all.reserve(8);  // the pointers stay
  add("Eq (21)", 1e-6, 1e-6);
  add("12 bit", 3e-3, 3e-3)->signal.adc_bits = 12;
  Experiment* e = add("noise", 0.02, 0.02);
  e->signal.noise.sigma = 1e-3;
  e->signal.noise.seed = 1;
  e = add("3rd 1 %", 1.4, 1.25);
  e->signal.harmonics = {{sensor::Channel::u, 3, 0.01, 0}, {sensor::Channel::v, 3, 0.01, 0}};
  add("beta 1", 1e-6, 1e-6)->signal.beta = 1.0;
  e = add("ripple", 1e-3, 2);
  e->signal.motion.kind = sensor::MotionKind::ripple;
  e->signal.motion.ripple_amplitude = 0.01;
  e->signal.motion.ripple_hz = 0.01;
  e->source = coprocessor::ReferenceSource::tracking;
  e = add("random", 1e-6, std::nullopt);
  e->signal.motion.kind = sensor::MotionKind::shuffled;
  e->signal.motion.seed = 1;
  e->source = coprocessor::ReferenceSource::angle;
  e->reference_hz = 0.0;
  e->step = 0.01;
  e = add("drift", 0.3, 0.6);
  sensor::DriftConfig& drift = e->signal.drift;
  drift.a1 = drift.b1 = drift.beta = 1e-4;
  drift.a2 = drift.b2 = -1e-4;
  drift.until_s = 1000.0;
  return all;
}

/// What the methods on the host see.
identification::Samples samples_of(const Experiment& e) {
  sensor::DescribedSource source(e.signal);
  const auto count = std::llround(e.duration_s * e.signal.sample_rate_hz);
  identification::Samples samples{Eigen::ArrayXd(count), Eigen::ArrayXd(count)};
  for (long long k = 0; k < count; ++k) {
    const auto value =
        source.sample(static_cast<uint64_t>(k), static_cast<double>(k) / e.signal.sample_rate_hz);
    const auto bits = static_cast<unsigned>(e.signal.adc_bits);
    samples.u[k] = peripherals::quantise(value->u, bits).word * 0x1p-31;
    samples.v[k] = peripherals::quantise(value->v, bits).word * 0x1p-31;
  }
  return samples;
}

/// The record's last turn without noise, and its angles.
struct LastTurn {
  Eigen::ArrayXd u, v, theta;

  explicit LastTurn(const Experiment& e) {
    sensor::SignalConfig clean = e.signal;
    clean.noise = {};
    sensor::DescribedSource source(clean);
    const auto count = std::llround(e.duration_s * clean.sample_rate_hz);
    const auto length = std::llround(e.window_s * clean.sample_rate_hz);
    u = v = theta = Eigen::ArrayXd(length);
    for (long long i = 0; i < length; ++i) {
      const long long k = count - length + i;
      const auto value =
          source.sample(static_cast<uint64_t>(k), static_cast<double>(k) / clean.sample_rate_hz);
      u[i] = value->u;
      v[i] = value->v;
      theta[i] = value->angle_turns * two_pi;
    }
  }

  Figure error(const identification::Parameters& parameters) const {
    return degrees(identification::peak_to_peak_error(
                       identification::canonical(parameters).parameters, u, v, theta) /
                   radians_per_degree);
  }
};

/// One line of the matrix: a method's errors on all records.
struct Line {
  std::string method;
  std::vector<std::string> cells;
  bool misses = false;
};

void print_line(Report& report, const Line& line) {
  std::string text = fmt::format("  {:<12}", line.method);
  for (const std::string& cell : line.cells) text += fmt::format(" {:>9}", cell);
  report.line("{}{}", text, line.misses ? "  MISSES ITS BOUND" : "");
}

/// A row of the data, and its cell.
void add(Report& report, Line& line, const PeerRecord& record, const Figure& precise,
         const Figure& paper = {}, std::optional<double> bound = std::nullopt) {
  Row row{fmt::format("{}: {}", record.name, line.method), "deg", precise, paper, bound};
  if (bound) row.verdict = Report::verdict(precise.value.value_or(HUGE_VAL) <= *bound);
  line.misses = line.misses || row.verdict == Row::Verdict::misses;
  line.cells.push_back(precise.text);
  report.add_data(row);
}

}  // namespace

void print_peers(Report& report) {
  report.heading(
      "peers",
      "The methods that the papers name on the records of these tables (400 s, 100,000 samples): "
      "angle error of the last turn by the parameters of the end, degrees peak to peak");
  const std::vector<PeerRecord> all = records();
  Line names{"", {}};
  Line lms{"LMS", {}}, paper{"LMS, paper", {}}, blocks{"blocks", {}};
  std::vector<Line> others;
  const std::vector<fit::Contender> contenders = fit::contenders();
  others.reserve(contenders.size());
  for (const fit::Contender& method : contenders) others.push_back({method.name, {}});
  for (const PeerRecord& record : all) {
    names.cells.emplace_back(record.name);
    const LastTurn turn(record.experiment);
    const Comparison learnt = compare(record.experiment);
    const Figure in_paper = turn.error(learnt.paper.parameters);
    add(report, lms, record, turn.error(learnt.precise.parameters), in_paper, record.lms_deg);
    paper.cells.push_back(in_paper.text);
    if (record.blocks_deg) {
      Experiment by_blocks = record.experiment;
      by_blocks.blocks = true;
      by_blocks.source = coprocessor::ReferenceSource::numeric;
      const Outcome outcome = run(by_blocks, coprocessor::Arithmetic::precise);
      add(report, blocks, record, turn.error(outcome.parameters), {}, record.blocks_deg);
    } else {
      blocks.cells.emplace_back("-");
    }
    const identification::Samples samples = samples_of(record.experiment);
    for (std::size_t i = 0; i < contenders.size(); ++i) {
      const auto found = contenders[i].identify(samples);
      add(report, others[i], record, found ? turn.error(found.value()) : Figure{"refuses", {}});
    }
  }
  for (const Line& line : {names, lms, paper, blocks}) print_line(report, line);
  for (const Line& line : others) print_line(report, line);
  report.line(
      "  12 bit: of the converter; noise: 1e-3 of full scale; 3rd 1 %: a harmonic in both "
      "channels; "
      "ripple: 1 % of the speed at 0.01 Hz; random: angles in any order; drift: 0.01 % a second. "
      "LMS has the source that the table of its record has, blocks the numeric one. 360: found "
      "another "
      "ellipse.");
}

}  // namespace capsoc::accuracy
