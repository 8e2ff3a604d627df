#include <gtest/gtest.h>

#include <vector>

#include "../../peripherals/test_bench.h"

namespace {

using namespace capsoc::registers::coprocessor;
using capsoc::coprocessor::Nodes;
using capsoc::peripherals::AdcInput;

class CoprocessorTlm : public capsoc::test::DeviceTest {
 protected:
  // A real bus needs two cycles for an access; here each takes the interval that it gets.
  void write(uint32_t offset, uint32_t value) {
    EXPECT_OK(bus.write(offset, value));
    bench.run(2);
  }
  // Returns at the edge that latches the sample.
  void submit(uint32_t u, uint32_t v) {
    write(SOFT_U_offset, u);
    EXPECT_OK(bus.write(SOFT_V_offset, v));
    bench.run(1);
  }
  bool interrupt() const { return bench.coprocessor.interrupt.level(); }

  capsoc::test::BusAccess& bus = coprocessor;
};

TEST_F(CoprocessorTlm, SaysWhoItIs) {
  EXPECT_EQ(bus.value_at(ID_offset), 0x43415053u);
  EXPECT_EQ(bus.value_at(VERSION_offset), 0x00010005u);
}

TEST_F(CoprocessorTlm, InterruptsExactlyLatencyCyclesAfterTheSample) {
  write(CTRL_offset, CTRL_CALIB_mask | CTRL_IE_RESULT_mask);
  const uint64_t latency = bus.value_at(LATENCY_offset);
  bench.run(1);
  submit(0x10000000, 0x20000000);
  bench.run(latency - 1);
  EXPECT_FALSE(interrupt());
  EXPECT_EQ(bus.value_at(SAMPLES_offset), 0u);
  bench.run(1);
  EXPECT_TRUE(interrupt());
  EXPECT_EQ(bus.value_at(SAMPLES_offset), 1u);
  bench.run(1);
  EXPECT_EQ(bus.value_at(RAW_U_offset), 0x10000000u);
  bench.run(1);
  EXPECT_OK(bus.write(FLAGS_offset, FLAGS_RESULT_mask));
  EXPECT_TRUE(interrupt()) << "the write acts at the next edge";
  bench.run(1);
  EXPECT_FALSE(interrupt());
}

TEST_F(CoprocessorTlm, NeedsNoAccessToComeToItsResult) {
  std::vector<uint64_t> cycles;
  const auto listening = bench.coprocessor.results.listen(
      [&](uint64_t cycle, const Nodes&, uint64_t) { cycles.push_back(cycle); });
  submit(0x10000000, 0x20000000);
  const uint64_t latched = bench.cycle();
  bench.run(1000);
  EXPECT_EQ(cycles, std::vector<uint64_t>{latched + LATENCY_reset});
}

TEST_F(CoprocessorTlm, FollowsTheSamplesOfTheAdcWhileTheGateIsOpen) {
  namespace front_end = capsoc::registers::adc;
  bench.adc.set_source([](uint64_t k, double) {
    return AdcInput{0.001 * double(k), 0.5, 0, false};
  });
  std::vector<int64_t> seen;
  const auto listening = bench.coprocessor.results.listen(
      [&](uint64_t, const Nodes& nodes, uint64_t) { seen.push_back(nodes.u); });
  EXPECT_OK(adc.write(front_end::PERIOD_offset, 32));
  EXPECT_OK(adc.write(front_end::CTRL_offset, front_end::CTRL_RUN_mask));
  bench.run(32 * 5);
  EXPECT_EQ(bus.value_at(STATUS_offset) & STATUS_BUSY_mask, 0u);
  EXPECT_OK(bus.write(CTRL_offset, CTRL_ADC_mask));
  bench.run(32 * 20);
  EXPECT_OK(adc.write(front_end::CTRL_offset, 0));
  bench.run(200);
  ASSERT_EQ(seen.size(), 20u) << "one sample a tick is sustained";
  for (std::size_t k = 1; k < seen.size(); ++k) EXPECT_GT(seen[k], seen[k - 1]);
  EXPECT_EQ(bus.value_at(EARLY_COUNT_offset), 0u);
  EXPECT_EQ(bus.value_at(SAMPLES_offset), 20u);
}

TEST_F(CoprocessorTlm, AClippedSampleIsAnError) {
  write(CTRL_offset, CTRL_ADC_mask | CTRL_IE_ERROR_mask);
  bench.coprocessor.sample({0x7FFFFFFF, 0, true});
  bench.run(1 + LATENCY_reset);
  EXPECT_NE(bus.value_at(FLAGS_offset) & FLAGS_CLIP_mask, 0u);
  EXPECT_TRUE(interrupt());
}

TEST_F(CoprocessorTlm, TooManySamplesAreDroppedAndCounted) {
  write(CTRL_offset, CTRL_ADC_mask | CTRL_IE_ERROR_mask);
  // Samples of one instant take one edge each: the first is latched, at the next edge it enters T0
  // and makes room for the second.
  for (int i = 0; i < 4; ++i) bench.coprocessor.sample({1 << 20, 1 << 20, false});
  bench.run(4);
  EXPECT_TRUE(interrupt());
  EXPECT_EQ(bus.value_at(EARLY_COUNT_offset), 2u);
  bench.run(1000);
  EXPECT_EQ(bus.value_at(SAMPLES_offset), 2u);
}

TEST_F(CoprocessorTlm, AFrequencySwitchKeepsTheLatencyInCycles) {
  namespace pll = capsoc::registers::clockctrl;
  EXPECT_OK(clock_controller.write(pll::LOCK_TIME_offset, 0));
  EXPECT_OK(clock_controller.write(pll::PLL_offset, 8 | 1 << pll::PLL_DIV_shift));
  write(CTRL_offset, CTRL_IE_RESULT_mask);
  submit(0x10000000, 0x20000000);
  bench.run(80);
  EXPECT_OK(
      clock_controller.write(pll::CTRL_offset, pll::CTRL_PLL_EN_mask | pll::CTRL_SELECT_mask));
  bench.run(LATENCY_reset - 81);
  EXPECT_FALSE(interrupt());
  bench.run(1);
  EXPECT_TRUE(interrupt());
}

TEST_F(CoprocessorTlm, AnythingButAWordAtARegisterIsABusError) {
  uint32_t value = 0;
  EXPECT_ADDRESS_ERROR(bus.read(0x0E8, value));
  EXPECT_ADDRESS_ERROR(bus.write(0x0E8, 0));
  EXPECT_ADDRESS_ERROR(bus.read(0xFFC, value));
  EXPECT_ADDRESS_ERROR(bus.read(0x1000, value));
  EXPECT_ADDRESS_ERROR(bus.read(ID_offset, value, 1));
  EXPECT_ADDRESS_ERROR(bus.write(CTRL_offset, 1, 2));
  EXPECT_OK(bus.write(ID_offset, 0)) << "a write to a read-only register is ignored";
  EXPECT_EQ(bus.value_at(ID_offset), 0x43415053u);
}

TEST_F(CoprocessorTlm, TheDebuggerDoesNotLatchTheLowWord) {
  write(FREQ_LO_offset, 0x1111);
  write(FREQ_HI_offset, 1);
  EXPECT_EQ(bus.value_at(FREQ_HI_offset), 1u);
  bench.run(1);
  write(FREQ_LO_offset, 0x2222);
  write(FREQ_HI_offset, 2);
  EXPECT_EQ(bus.debug_value_at(FREQ_HI_offset), 2u);
  EXPECT_EQ(bus.value_at(FREQ_LO_offset), 0x1111u) << "as the guest latched it";
  EXPECT_EQ(bus.debug_value_at(FREQ_LO_offset), 0x2222u);
  EXPECT_EQ(bus.debug_write(FREQ_HI_offset, 7), 0u);
}

TEST_F(CoprocessorTlm, SoftResetLowersTheInterruptAndDropsTheSample) {
  write(CTRL_offset, CTRL_IE_RESULT_mask);
  submit(0x10000000, 0x20000000);
  bench.run(LATENCY_reset);
  ASSERT_TRUE(interrupt());
  submit(0x10000000, 0x20000000);
  write(CTRL_offset, CTRL_SRST_mask);
  EXPECT_FALSE(interrupt());
  bench.run(1000);
  EXPECT_EQ(bus.value_at(SAMPLES_offset), 0u);
  EXPECT_EQ(bus.value_at(CTRL_offset), 0u);
}

TEST_F(CoprocessorTlm, ASampleAndAWriteOfOneInstantActAtTheNextEdgeInTheirOrder) {
  for (bool write_first : {false, true}) {
    bench.reset();
    std::vector<bool> latched;
    const auto listening = bench.coprocessor.samples.listen(
        [&](uint64_t, bool taken, uint64_t) { latched.push_back(taken); });
    if (write_first) {
      EXPECT_OK(bus.write(CTRL_offset, CTRL_ADC_mask));
    }
    bench.coprocessor.sample({1 << 20, 1 << 20, false});
    if (!write_first) {
      EXPECT_OK(bus.write(CTRL_offset, CTRL_ADC_mask));
    }
    bench.run(1);
    EXPECT_EQ(latched, std::vector<bool>{false}) << "the sample comes first, the gate opens after";
    bench.coprocessor.sample({1 << 20, 1 << 20, false});
    EXPECT_EQ(bus.value_at(STATUS_offset) & STATUS_BUSY_mask, 0u) << "a read sees the last edge";
    bench.run(1);
    EXPECT_EQ(latched, (std::vector<bool>{false, true}));
    EXPECT_EQ(bus.value_at(STATUS_offset) & STATUS_BUSY_mask, STATUS_BUSY_mask);
  }
}

TEST_F(CoprocessorTlm, EqualSamplesKeepTheirNumbersOverASoftReset) {
  std::vector<uint64_t> numbers;
  const auto listening = bench.coprocessor.results.listen(
      [&](uint64_t, const Nodes&, uint64_t number) { numbers.push_back(number); });
  const auto feed = [&](uint64_t number) {
    bench.coprocessor.sample({1 << 20, 1 << 20, false, number});
    bench.run(40);
  };
  write(CTRL_offset, CTRL_ADC_mask);
  for (uint64_t number = 10; number < 18; ++number) feed(number);
  EXPECT_EQ(numbers, (std::vector<uint64_t>{10, 11, 12, 13}));
  write(CTRL_offset, CTRL_SRST_mask);  // loses 14 to 17
  write(CTRL_offset, CTRL_ADC_mask);
  for (uint64_t number = 20; number < 23; ++number) feed(number);
  submit(1 << 20, 1 << 20);  // software's, with the same words
  bench.run(40);
  feed(23);
  bench.run(1000);
  EXPECT_EQ(numbers, (std::vector<uint64_t>{10, 11, 12, 13, 20, 21, 22, 0, 23}));
}

TEST_F(CoprocessorTlm, AccessesOfOneInstantTakeOneIntervalEach) {
  EXPECT_OK(bus.write(B1_offset, 1));
  EXPECT_EQ(bus.value_at(B1_offset), 1u);
  EXPECT_OK(bus.write(B1_offset, 2));
  EXPECT_OK(bus.write(B1_offset, 3));
  EXPECT_EQ(bus.value_at(B1_offset), 3u);
}

}  // namespace
