// The harmonic correction (CTRL.CORRECT, CORRECTION): the table's nodes and lines against numbers
// in double, what it takes off a sensor with harmonics, and the rules of its registers.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "bench.h"
#include "coprocessor/harmonic_correction.h"

namespace capsoc::coprocessor::test {
namespace {

constexpr uint32_t calibrating = ctrl_calib | ctrl_adc;

uint32_t node_word(unsigned node, int32_t value) {
  return node << description::CORRECTION_NODE_shift |
         (static_cast<uint32_t>(value) & correction_value_mask);
}

void write_everywhere(Bench& bench, int32_t value) {
  for (unsigned node = 0; node < correction_nodes; ++node)
    bench.write(reg_correction, node_word(node, value));
}

void load(Bench& bench, const Sensor& s) {
  const auto turn_word = [](double radians) {
    return static_cast<uint32_t>(static_cast<int64_t>(std::llround(radians / tau * 0x1p32)));
  };
  bench.write(reg_a1, static_cast<uint32_t>(fixed::to_q31(s.a1)));
  bench.write(reg_a2, static_cast<uint32_t>(fixed::to_q31(s.a2)));
  bench.write(reg_b1, static_cast<uint32_t>(fixed::to_q31(s.b1)));
  bench.write(reg_b2, static_cast<uint32_t>(fixed::to_q31(s.b2)));
  bench.write(reg_beta, turn_word(s.beta));
  bench.write(reg_phi, turn_word(s.phi));
  bench.write(reg_cmd, cmd_load);
  bench.cycle += 200;
  bench.dut.advance(bench.cycle);
}

TEST(HarmonicCorrection, IsTheLineBetweenTwoNodes) {
  std::mt19937_64 random(5);
  std::uniform_int_distribution<int32_t> value(-(1 << 19), (1 << 19) - 1);
  CorrectionTable table;
  for (int32_t& node : table) node = value(random);
  double worst = 0;
  for (int i = 0; i < 100000; ++i) {
    const auto relative = static_cast<uint32_t>(random()), phi = static_cast<uint32_t>(random());
    // The unit of a position, 2^-23 turn, is floored in both angles.
    const double place =
        std::fmod((std::floor(relative * 0x1p-9) + std::floor(phi * 0x1p-9)) * 0x1p-16, 128);
    const auto left = static_cast<unsigned>(place);
    const double share = place - left;
    const double wanted = table[left] * (1 - share) + table[(left + 1) % 128] * share;
    const double error = wanted - correction_at(table, relative, phi);
    worst = std::max(worst, error);
    ASSERT_GE(error, 0);
    ASSERT_EQ(corrected_angle(table, relative, phi),
              relative - static_cast<uint32_t>(256 * correction_at(table, relative, phi)));
  }
  EXPECT_LT(worst, 1);
  EXPECT_GT(worst, 0.99);
}

TEST(HarmonicCorrection, TakesAKnownErrorOffTheAngle) {
  const Sensor sensor;
  Bench bench;
  bench.write(reg_ctrl, ctrl_calib);
  load(bench, sensor);
  // An angle error of second and fifth order, 2 degrees at most.
  const auto error_turns = [](double angle) {
    return (1.2 * std::sin(2 * angle + 0.3) + 0.8 * std::cos(5 * angle)) / 360;
  };
  for (unsigned node = 0; node < correction_nodes; ++node)
    bench.write(
        reg_correction,
        node_word(node, static_cast<int32_t>(std::lround(error_turns(tau * node / 128) * 0x1p24))));
  EXPECT_EQ(bench.read(reg_flags) & flag_config, 0u);
  double before = 0, after = 0;
  for (uint32_t ctrl : {calibrating, calibrating | ctrl_correct}) {
    bench.write(reg_ctrl, ctrl);
    double& worst = ctrl == calibrating ? before : after;
    for (int k = 0; k < 2000; ++k) {
      const double truth = tau * k / 2000;
      // What a sensor shows whose angle is wrong by that; to be seen at the wrong angle.
      double shown = truth;
      for (int i = 0; i < 20; ++i) shown = truth + tau * error_turns(shown);
      bench.sample(sensor, shown - sensor.phi);
      worst = std::max(worst, distance_degrees(bench.angle(), truth));
    }
  }
  std::printf("angle error before %.3f, after %.2g degrees\n", before, after);
  EXPECT_GT(before, 1.8);
  // A chord of the fifth order: 0.8 (5 pi / 128)^2 / 2, and the second's share.
  EXPECT_LT(after, 0.0085);
  EXPECT_GT(after, 0.004);
}

TEST(HarmonicCorrection, EveryStageBehindWorksWithTheCorrectedAngle) {
  const Sensor sensor;
  Bench bench;
  bench.write(reg_ctrl, ctrl_calib);
  load(bench, sensor);
  write_everywhere(bench, 1000);  // 2^-24 turn
  bench.write(reg_ctrl, calibrating);
  bench.sample(sensor, 0.25);
  const Nodes plain = bench.dut.nodes();
  bench.write(reg_ctrl, calibrating | ctrl_correct);
  bench.sample(sensor, 0.25);
  const Nodes corrected = bench.dut.nodes();
  EXPECT_EQ(static_cast<uint32_t>(plain.angle - corrected.angle), 256000u);
  EXPECT_EQ(plain.residue - corrected.residue, 256000);
  EXPECT_EQ(plain.amplitude, corrected.amplitude);
}

TEST(HarmonicCorrection, TakesANodeOnlyWhileThePipelineIsEmpty) {
  const Sensor sensor;
  Bench bench;
  bench.write(reg_ctrl, calibrating | ctrl_correct);
  bench.sample(sensor, 0);
  const auto angle = [&] {
    bench.sample(sensor, 0);
    return static_cast<uint32_t>(bench.dut.nodes().angle);
  };
  const uint32_t before = angle();
  const uint64_t latched = bench.cycle + bench.period;
  // From the edge that latches the sample to the one before its commit.
  for (uint64_t at : {latched, latched + 1, latched + 100, latched + latency_cycles - 1}) {
    bench.dut.submit(latched, 0, 0, false);
    bench.dut.write(at, reg_flags, flags_all);
    for (unsigned node = 0; node < correction_nodes; ++node)
      bench.dut.write(at, reg_correction, node_word(node, 77));
    EXPECT_TRUE(bench.dut.read(at, reg_flags, true).value & flag_config) << at - latched;
    bench.dut.soft_reset();
    bench.dut.write(at, reg_ctrl, calibrating | ctrl_correct);
    bench.dut.advance(latched + latency_cycles);
  }
  bench.cycle = latched + 1000;
  EXPECT_EQ(angle(), before);
  bench.write(reg_flags, flags_all);
  write_everywhere(bench, 77);
  EXPECT_EQ(bench.read(reg_flags) & flag_config, 0u);
  EXPECT_EQ(before - angle(), 77u * 256);
  // The edge of the commit is free again.
  bench.dut.submit(bench.cycle + 1000, 0, 0, false);
  bench.dut.write(bench.cycle + 1000 + latency_cycles, reg_flags, flags_all);
  bench.dut.write(bench.cycle + 1000 + latency_cycles, reg_correction, node_word(0, 0));
  EXPECT_EQ(bench.dut.read(bench.cycle + 1000 + latency_cycles, reg_flags, true).value, 0u);
}

TEST(HarmonicCorrection, OutlivesAResetAndTheStateOfADevice) {
  const Sensor sensor;
  Bench bench;
  write_everywhere(bench, -5);
  bench.write(reg_ctrl, ctrl_srst);
  EXPECT_EQ(bench.read(reg_ctrl), 0u);
  bench.write(reg_ctrl, calibrating);
  bench.sample(sensor, 1);
  const auto plain = static_cast<uint32_t>(bench.dut.nodes().angle);
  bench.write(reg_ctrl, calibrating | ctrl_correct);
  bench.sample(sensor, 1);
  EXPECT_EQ(static_cast<uint32_t>(bench.dut.nodes().angle) - plain, 5u * 256);
  IdleState state;
  ASSERT_TRUE(bench.dut.save_idle(state));
  Bench other;
  ASSERT_TRUE(other.dut.load_idle(state));
  other.cycle = bench.cycle;
  other.sample(sensor, 1);
  EXPECT_EQ(static_cast<uint32_t>(other.dut.nodes().angle) - plain, 5u * 256);
}

TEST(HarmonicCorrection, IsRefusedWhereTheUnitIsLeftOut) {
  Options paper, without;
  paper.arithmetic = Arithmetic::paper;
  without.harmonic_correction = false;
  for (const Options& options : {paper, without}) {
    Bench bench(options);
    bench.write(reg_ctrl, ctrl_correct | ctrl_calib);
    EXPECT_EQ(bench.read(reg_ctrl), ctrl_calib);
    EXPECT_EQ(bench.read(reg_flags), flag_config);
    bench.write(reg_flags, flags_all);
    bench.write(reg_correction, node_word(3, 5));
    EXPECT_EQ(bench.read(reg_flags), flag_config);
    EXPECT_EQ(bench.read(reg_correction), 0u);
  }
}

}  // namespace
}  // namespace capsoc::coprocessor::test
