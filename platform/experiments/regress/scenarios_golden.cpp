// A random sensor, learnt and calibrated; the parameters and ANGLE against what the CSFN finds in
// the same samples.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/constants.h"
#include "base/fixed.h"
#include "coprocessor/register_map.h"
#include "golden/golden.h"
#include "regress/scenario.h"

namespace capsoc::regress {

using namespace coprocessor;

namespace {

constexpr uint32_t golden_gates = ctrl_calib | ctrl_adc;
constexpr int learning_turns = 24;

/// A sensor, and a shaft that turns by the same angle from sample to sample.
struct DrawnSensor {
  DrawnSensor(Random& random, bool paper) {
    // What the paper's square root and look-up table are made for, and more.
    const double least = paper ? 0.25 : 0.1, most = paper ? 0.75 : 0.9;
    a1 = least * std::pow(most / least, random.uniform());
    a2 = least * std::pow(most / least, random.uniform());
    b1 = (random.uniform() - 0.5) * std::min(0.4, 1.9 * (1 - a1));
    b2 = (random.uniform() - 0.5) * std::min(0.4, 1.9 * (1 - a2));
    beta = (random.uniform() - 0.5) * 2.4;
    if (!paper && random.chance(0.5)) beta = pi - beta;
    angle = random.uniform() * two_pi;
    // Samples of one turn are never those of the turn before: they cover the whole of it.
    turns = 1 / (static_cast<double>(random.between(26, 39)) + 0.382);
    if (random.chance(0.5)) turns = -turns;
    if (random.chance(0.5)) noise = 1e-4;
  }

  metrics::RecordedSample next(Random& random) {
    // Sum of four: near enough to a normal distribution, of variance 1/3.
    const auto jitter = [&] {
      double sum = -2;
      for (int i = 0; i < 4; ++i) sum += random.uniform();
      return sum * noise;
    };
    const double u = a1 * std::sin(angle) + b1 + jitter();
    const double v = a2 * std::cos(angle + beta) + b2 + jitter();
    angle += turns * two_pi;
    metrics::RecordedSample sample;
    sample.u = fixed::to_q31(u);
    sample.v = fixed::to_q31(v);
    return sample;
  }

  double a1, a2, b1, b2, beta, angle, turns, noise = 0;
};

/// The registers after a sample, over the bus; to be called when it is through.
metrics::RecordedResult read_result(Bench& bench, bool demodulating) {
  const auto word = [&](uint32_t offset) { return static_cast<int32_t>(bench.read(offset)); };
  metrics::RecordedResult result;
  result.words = {word(reg_a1), word(reg_a2),         word(reg_b1),
                  word(reg_b2), bench.read(reg_beta), bench.read(reg_phi)};
  result.status = bench.read(reg_status);
  result.angle = bench.read(reg_angle);
  result.angle_valid = (result.status & status_valid) != 0;
  result.demodulating = demodulating;
  return result;
}

void load_words(Bench& bench, const metrics::ParameterWords& words) {
  bench.write(reg_a1, static_cast<uint32_t>(words.a1));
  bench.write(reg_a2, static_cast<uint32_t>(words.a2));
  bench.write(reg_b1, static_cast<uint32_t>(words.b1));
  bench.write(reg_b2, static_cast<uint32_t>(words.b2));
  bench.write(reg_beta, words.beta);
  bench.write(reg_phi, words.phi);
  bench.write(reg_cmd, cmd_load);
  bench.drain();
}

void judge_golden(Bench& bench, const DrawnSensor& sensor, const metrics::SampleRecord& record,
                  const golden::GoldenSettings& settings) {
  const golden::Golden golden = golden::compare(record, record.back().result->words, settings);
  if (golden.angle.verdict == golden::AngleCheck::Verdict::agrees) return;
  bench.complain(golden.angle.reason,
                 fmt::format("sensor a1 {:.6f} a2 {:.6f} b1 {:.6f} b2 {:.6f} beta {:.6f}, {:.6f} "
                             "turns a sample, noise {:g}\n{}",
                             sensor.a1, sensor.a2, sensor.b1, sensor.b2, sensor.beta, sensor.turns,
                             sensor.noise, golden::to_table(golden)));
}

}  // namespace

void run_golden(Bench& bench, Random& random, const Budget&) {
  const bool paper = bench.arithmetic() == Arithmetic::paper;
  DrawnSensor sensor(random, paper);
  // Half the angle of a sample: the fastest that settles.
  const uint32_t step = static_cast<uint32_t>(std::fabs(sensor.turns) * pi * 0x1p31);
  bench.write(reg_ctrl, ctrl_srst);
  for (uint32_t offset = reg_step_au; offset <= reg_step_cv; offset += 4) bench.write(offset, step);
  bench.write_pair(reg_freq_lo, std::llround(std::ldexp(sensor.turns, 48)));
  bench.write(reg_ctrl, golden_gates | ctrl_demod);

  metrics::SampleRecord record;
  const auto turn = static_cast<int>(std::ceil(1 / std::fabs(sensor.turns)));
  const auto take = [&](bool demodulating, bool wait) {
    record.push_back(sensor.next(random));
    bench.sample(static_cast<uint32_t>(record.back().u), static_cast<uint32_t>(record.back().v));
    if (!wait) return bench.wait(bench.tick() + 1);
    bench.drain();
    record.back().result = read_result(bench, demodulating);
  };
  for (int i = 0; i < learning_turns * turn && !bench.failed(); ++i) take(true, false);
  bench.drain();
  // More than the weights remember: their wandering is part of the bound.
  for (int i = 0; i < 3 * turn && !bench.failed(); ++i) take(true, true);
  if (bench.failed()) return;
  bench.write(reg_ctrl, golden_gates);
  load_words(bench, record.back().result->words);
  for (int i = 0; i < turn && !bench.failed(); ++i) take(false, true);
  if (bench.failed()) return;
  judge_golden(bench, sensor, record, {paper, step / q31, step / q31, 0});
}

}  // namespace capsoc::regress
