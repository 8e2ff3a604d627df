// Time at the register level: ticks, the holding register, early samples, LOAD, next_event().
#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "bench.h"

namespace capsoc::coprocessor::test {
namespace {

constexpr uint32_t cu_hi = reg_au_lo + 0x14;

class Timing : public testing::Test {
 protected:
  Timing() : dut({}) { dut.write(0, reg_ctrl, ctrl_adc | ctrl_demod | ctrl_calib); }

  uint32_t read(uint64_t cycle, uint32_t offset) { return dut.read(cycle, offset, false).value; }
  bool submit(uint64_t cycle) { return dut.submit(cycle, 1 << 29, 1 << 28, false); }

  Coprocessor dut;
};

TEST_F(Timing, AResultIsVisible161CyclesAfterItsSampleWasLatched) {
  EXPECT_TRUE(dut.idle());
  EXPECT_FALSE(dut.next_event());
  EXPECT_TRUE(submit(1000));
  EXPECT_FALSE(dut.idle());
  EXPECT_EQ(dut.next_event(), 1161u);
  EXPECT_EQ(read(1160, reg_samples), 0u);
  EXPECT_EQ(read(1160, reg_status) & status_busy, status_busy);
  EXPECT_EQ(read(1160, reg_raw_u), 0u);
  EXPECT_EQ(dut.next_event(), 1161u);
  EXPECT_EQ(read(1161, reg_samples), 1u);
  EXPECT_EQ(read(1161, reg_raw_u), 1u << 29);
  EXPECT_EQ(read(1161, reg_status) & status_busy, 0u);
  EXPECT_EQ(read(1161, reg_flags), flag_result);
  EXPECT_EQ(read(1161, reg_latency), 161u);
  EXPECT_FALSE(dut.next_event());
}

TEST_F(Timing, StagesWriteAtTheEndOfTheirTicks) {
  submit(100);
  dut.write(100, reg_freq_hi, 1);
  EXPECT_EQ(read(100 + 1 + 95, reg_phase_hi), 0u);
  EXPECT_EQ(read(100 + 1 + 96, reg_phase_hi), 1u) << "T2 ends after three ticks";
  const uint32_t start = read(100 + 1 + 127, cu_hi);
  EXPECT_EQ(start, 0u);
  EXPECT_NE(read(100 + 1 + 128, cu_hi), start) << "T3 ends after four ticks";
}

TEST_F(Timing, SamplesEvery32CyclesAreAllTaken) {
  for (uint64_t i = 0; i < 1000; ++i) {
    ASSERT_TRUE(submit(10 + 32 * i)) << i;
    // Each is committed 161 cycles after it was latched, though five are in flight.
    const uint64_t done = i < 4 ? 0 : i - 4;
    ASSERT_EQ(read(10 + 32 * i + 33 - 32, reg_samples), done) << i;
  }
  EXPECT_EQ(read(10 + 32 * 999 + 160, reg_samples), 999u);
  EXPECT_EQ(read(10 + 32 * 999 + 161, reg_samples), 1000u);
  EXPECT_EQ(read(100000, reg_early_count), 0u);
}

TEST_F(Timing, ASampleThatFindsTheHoldingRegisterFullIsDroppedAndCounted) {
  EXPECT_TRUE(submit(10));  // enters at 11
  EXPECT_TRUE(submit(11));  // takes the register that was freed at this edge, enters at 43
  EXPECT_FALSE(submit(12));
  EXPECT_FALSE(submit(42));
  EXPECT_EQ(read(42, reg_early_count), 2u);
  EXPECT_EQ(read(42, reg_flags), flag_early);
  EXPECT_TRUE(submit(43));  // freed at this edge
  EXPECT_EQ(read(10000, reg_samples), 3u);
  EXPECT_EQ(read(10000, reg_early_count), 2u);
}

TEST_F(Timing, ASampleInMidTickWaitsForTheBoundary) {
  submit(10);
  EXPECT_TRUE(submit(10 + 1 + 50));  // ticks begin at 11, 43, 75
  EXPECT_EQ(read(75 + 159, reg_samples), 1u);
  EXPECT_EQ(read(75 + 160, reg_samples), 2u);
}

TEST_F(Timing, TheAdcStreamIsIgnoredWhileItsGateIsClosed) {
  dut.write(0, reg_ctrl, ctrl_demod);
  EXPECT_FALSE(submit(10));
  EXPECT_TRUE(dut.idle());
  EXPECT_EQ(read(10, reg_early_count), 0u);
}

TEST_F(Timing, LoadTakesThreeTicks) {
  dut.write(500, reg_b1, 1000);
  dut.write(500, reg_cmd, cmd_load);
  EXPECT_EQ(dut.next_event(), 597u);
  EXPECT_EQ(read(596, reg_status) & status_busy, status_busy);
  EXPECT_EQ(read(597, cu_hi), 1000u);
  EXPECT_TRUE(dut.idle());
}

TEST_F(Timing, LoadWaitsForThePipelineAndHoldsSamplesBack) {
  submit(10);                        // T0 from 11, done at 171
  dut.write(20, reg_cmd, cmd_load);  // from 171 to 267
  EXPECT_TRUE(submit(100));          // held until 267
  EXPECT_EQ(read(171, reg_samples), 1u);
  EXPECT_EQ(dut.next_event(), 267u);
  EXPECT_EQ(read(267 + 159, reg_samples), 1u);
  EXPECT_EQ(read(267 + 160, reg_samples), 2u);
  EXPECT_TRUE(dut.idle());
}

TEST_F(Timing, SoftResetDropsWhatIsInFlight) {
  submit(10);
  submit(50);
  dut.write(60, reg_ctrl, ctrl_srst);
  EXPECT_TRUE(dut.idle());
  EXPECT_EQ(read(1000, reg_samples), 0u);
  dut.write(1000, reg_ctrl, ctrl_adc);
  EXPECT_TRUE(submit(1001));
  EXPECT_EQ(dut.next_event(), 1162u);
}

// Two clocks an iteration of the paper's arctangent: ticks of 64 cycles.
class TwoClocks : public testing::Test {
 protected:
  static Options options(int clocks) {
    Options out;
    out.arithmetic = Arithmetic::paper;
    out.paper_iteration_clocks = clocks;
    return out;
  }

  TwoClocks() : dut(options(2)) { dut.write(0, reg_ctrl, ctrl_adc | ctrl_demod | ctrl_calib); }

  uint32_t read(uint64_t cycle, uint32_t offset) { return dut.read(cycle, offset, false).value; }
  bool submit(uint64_t cycle) { return dut.submit(cycle, 1 << 29, 1 << 28, false); }

  Coprocessor dut;
};

TEST_F(TwoClocks, AResultIsVisible321CyclesAfterItsSampleWasLatched) {
  EXPECT_EQ(dut.tick(), 64u);
  EXPECT_TRUE(submit(1000));
  EXPECT_EQ(dut.next_event(), 1321u);
  EXPECT_EQ(read(1320, reg_samples), 0u);
  EXPECT_EQ(read(1321, reg_samples), 1u);
  EXPECT_EQ(read(1321, reg_status) & status_busy, 0u);
  EXPECT_EQ(read(1321, reg_latency), 321u);
}

TEST_F(TwoClocks, SamplesEvery64CyclesAreAllTaken) {
  for (uint64_t i = 0; i < 1000; ++i) ASSERT_TRUE(submit(10 + 64 * i)) << i;
  EXPECT_EQ(read(10 + 64 * 999 + 320, reg_samples), 999u);
  EXPECT_EQ(read(10 + 64 * 999 + 321, reg_samples), 1000u);
  EXPECT_EQ(read(200000, reg_early_count), 0u);
}

TEST_F(TwoClocks, ASampleThatFindsTheHoldingRegisterFullIsDropped) {
  EXPECT_TRUE(submit(10));  // enters at 11
  EXPECT_TRUE(submit(11));  // enters at 75
  EXPECT_FALSE(submit(43));
  EXPECT_FALSE(submit(74));
  EXPECT_TRUE(submit(75));  // freed at this edge
  EXPECT_EQ(read(10000, reg_samples), 3u);
  EXPECT_EQ(read(10000, reg_early_count), 2u);
}

TEST_F(TwoClocks, LoadTakesThreeTicksAndAResetKeepsTheirLength) {
  dut.write(400, reg_ctrl, ctrl_srst);
  dut.write(500, reg_b1, 1000);
  dut.write(500, reg_cmd, cmd_load);
  EXPECT_EQ(dut.next_event(), 693u);
  EXPECT_EQ(read(692, reg_status) & status_busy, status_busy);
  EXPECT_EQ(read(693, cu_hi), 1000u);
  EXPECT_TRUE(dut.idle());
}

// Samples of one kind, two and one ticks apart: what each leaves is the same, at another edge.
TEST_F(TwoClocks, TheWordsAreThoseOfOne) {
  Coprocessor one(options(1));
  std::mt19937 random(3);
  for (Coprocessor* each : {&dut, &one}) {
    each->write(1, reg_ctrl, ctrl_adc | ctrl_demod | ctrl_calib | 2u << ctrl_ref_shift);
    each->write(1, reg_freq_hi, 1 << 25);
  }
  for (uint64_t i = 1; i < 3000; ++i) {
    const auto u = static_cast<int32_t>(random()) >> 1, v = static_cast<int32_t>(random()) >> 1;
    const uint64_t ticks = 1 + random() % 2;  // until the next sample
    ASSERT_TRUE(dut.submit(1000 * i, u, v, false));
    ASSERT_TRUE(one.submit(1000 * i, u, v, false));
    ASSERT_TRUE(dut.submit(1000 * i + 64 * ticks, v, u, false));
    ASSERT_TRUE(one.submit(1000 * i + 32 * ticks, v, u, false));
    dut.advance(1000 * i + 900);
    one.advance(1000 * i + 900);
    for (const NamedNode& node : node_names())
      ASSERT_EQ(dut.nodes().*node.value, one.nodes().*node.value) << node.name << " of pair " << i;
  }
}

TEST(TwoClocksOfPrecise, AreNone) {
  Options options;
  options.paper_iteration_clocks = 2;
  EXPECT_EQ(Coprocessor(options).tick(), 32u);
}

// The order of calls, not their number, is all that counts: advancing cycle by cycle, event by
// event or not at all gives the same machine.
TEST(Advance, GivesTheSameResultsInAnyStride) {
  std::vector<std::array<int64_t, node_count>> outcomes;
  for (int stride : {0, 1, 7, -1}) {
    Coprocessor dut({});
    dut.write(0, reg_ctrl, ctrl_adc | ctrl_demod | ctrl_calib | (1u << ctrl_ref_shift));
    dut.write(0, reg_freq_hi, 12345678);
    std::mt19937 random(5);
    uint64_t cycle = 0;
    for (int i = 0; i < 300; ++i) {
      const uint64_t next = cycle + random() % 60;
      if (stride > 0)
        for (uint64_t c = cycle; c < next; c += static_cast<uint64_t>(stride)) dut.advance(c);
      if (stride < 0)
        while (dut.next_event() && *dut.next_event() <= next) dut.advance(*dut.next_event());
      cycle = next;
      dut.submit(cycle, static_cast<int32_t>(random()), static_cast<int32_t>(random()), false);
    }
    dut.advance(cycle + 1000);
    std::array<int64_t, node_count> values{};
    for (size_t i = 0; i < values.size(); ++i) values[i] = dut.nodes().*node_names()[i].value;
    outcomes.push_back(values);
  }
  for (const auto& outcome : outcomes) EXPECT_EQ(outcome, outcomes.front());
}

}  // namespace
}  // namespace capsoc::coprocessor::test
