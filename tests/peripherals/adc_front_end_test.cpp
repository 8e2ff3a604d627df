#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "test_bench.h"

namespace {

using capsoc::peripherals::AdcInput;
using capsoc::peripherals::SensorSample;
using namespace capsoc::registers::adc;

class AdcFrontEnd : public capsoc::test::DeviceTest {
 protected:
  struct Taken {
    uint64_t cycle;
    SensorSample sample;
  };

  void SetUp() override {
    DeviceTest::SetUp();
    bench.adc.set_source([this](uint64_t k, double t) -> std::optional<AdcInput> {
      times.push_back(t);
      if (k >= length) return std::nullopt;
      return AdcInput{u, v, 0.125, true};
    });
    bench.adc.set_sink([this](const SensorSample& sample) {
      taken.push_back({bench.cycle(), sample});
    });
  }

  void start(uint32_t period, uint32_t enables = 0) {
    EXPECT_OK(bus.write(PERIOD_offset, period));
    EXPECT_OK(bus.write(CTRL_offset, CTRL_RUN_mask | enables));
    started = bench.cycle();
  }

  capsoc::test::BusAccess& bus = adc;
  double u = 0.25, v = -0.5;
  uint64_t length = 1'000'000;
  uint64_t started = 0;
  std::vector<double> times;
  std::vector<Taken> taken;
};

TEST_F(AdcFrontEnd, TakesASampleEveryPeriod) {
  start(100);
  bench.run(99);
  EXPECT_TRUE(taken.empty());
  bench.run(1);
  ASSERT_EQ(taken.size(), 1u);
  bench.run(900);
  ASSERT_EQ(taken.size(), 10u);
  for (std::size_t k = 0; k < taken.size(); ++k) EXPECT_EQ(taken[k].cycle, started + 100 * (k + 1));
  EXPECT_EQ(bus.value_at(COUNT_offset), 10u);
}

TEST_F(AdcFrontEnd, TellsTheSensorTheTimeOfEachSampleWithoutDrift) {
  start(100'000);  // 250 Hz
  bench.run(100'000 * 1001);
  ASSERT_EQ(times.size(), 1001u);
  for (std::size_t k = 0; k < times.size(); ++k) EXPECT_EQ(times[k], double(k) / 250.0);
}

TEST_F(AdcFrontEnd, HandsOnWordsThatSoftwareCanRead) {
  start(32);
  bench.run(32);
  ASSERT_EQ(taken.size(), 1u);
  EXPECT_EQ(taken[0].sample.u, 0x20000000);
  EXPECT_EQ(taken[0].sample.v, -0x40000000);
  EXPECT_FALSE(taken[0].sample.clip);
  EXPECT_EQ(bus.value_at(DATA_U_offset), 0x20000000u);
  EXPECT_EQ(bus.value_at(DATA_V_offset), 0xC0000000u);
}

TEST_F(AdcFrontEnd, TheResolutionIsTheProgrammedOne) {
  u = 0.123456789;
  start(32);
  for (uint32_t bits = 12; bits <= 32; ++bits) {
    EXPECT_OK(bus.write(BITS_offset, bits));
    bench.run(32);
    const double scale = std::ldexp(1.0, int(bits) - 1);
    EXPECT_EQ(taken.back().sample.u, int64_t(std::floor(u * scale + 0.5)) << (32 - bits)) << bits;
  }
}

TEST_F(AdcFrontEnd, ClippingIsFlaggedPerChannel) {
  u = 1.0;
  start(100, CTRL_IE_CLIP_mask);
  bench.run(100);
  EXPECT_TRUE(taken.back().sample.clip);
  EXPECT_EQ(taken.back().sample.u, 0x7FFFFFFF);
  EXPECT_EQ(bus.value_at(FLAGS_offset), FLAGS_SAMPLE_mask | FLAGS_CLIP_U_mask);
  EXPECT_TRUE(bench.adc.interrupt.level());
  u = 0;
  v = -1.25;
  EXPECT_OK(bus.write(FLAGS_offset, FLAGS_SAMPLE_mask | FLAGS_CLIP_U_mask));
  EXPECT_FALSE(bench.adc.interrupt.level());
  bench.run(100);
  EXPECT_EQ(bus.value_at(FLAGS_offset), FLAGS_SAMPLE_mask | FLAGS_CLIP_V_mask);
  EXPECT_TRUE(bench.adc.interrupt.level());
}

TEST_F(AdcFrontEnd, EverySampleInterruptsIfEnabled) {
  start(100, CTRL_IE_SAMPLE_mask);
  EXPECT_FALSE(bench.adc.interrupt.level());
  for (int k = 0; k < 3; ++k) {
    bench.run(100);
    EXPECT_TRUE(bench.adc.interrupt.level());
    EXPECT_OK(bus.write(FLAGS_offset, FLAGS_SAMPLE_mask));
    EXPECT_FALSE(bench.adc.interrupt.level());
  }
}

TEST_F(AdcFrontEnd, TheEndOfTheSignalStopsIt) {
  length = 3;
  start(50, CTRL_IE_END_mask);
  bench.run(150);
  EXPECT_EQ(bus.value_at(STATUS_offset), STATUS_RUNNING_mask);
  EXPECT_FALSE(bench.adc.interrupt.level());
  bench.run(50);
  EXPECT_EQ(bus.value_at(STATUS_offset), STATUS_ENDED_mask);
  EXPECT_EQ(bus.value_at(CTRL_offset), CTRL_IE_END_mask) << "RUN clears itself";
  EXPECT_EQ(bus.value_at(FLAGS_offset), FLAGS_SAMPLE_mask | FLAGS_END_mask);
  EXPECT_TRUE(bench.adc.interrupt.level());
  bench.run(1000);
  EXPECT_EQ(taken.size(), 3u);
}

TEST_F(AdcFrontEnd, WithoutASignalItEndsWithTheFirstSample) {
  bench.adc.set_source({});
  start(50);
  bench.run(50);
  EXPECT_EQ(bus.value_at(STATUS_offset), STATUS_ENDED_mask);
  EXPECT_TRUE(taken.empty());
}

TEST_F(AdcFrontEnd, ANewStartBeginsWithSample0) {
  length = 2;
  start(50);
  bench.run(500);
  times.clear();
  length = 100;
  start(50);
  EXPECT_EQ(bus.value_at(STATUS_offset), STATUS_RUNNING_mask);
  EXPECT_EQ(bus.value_at(COUNT_offset), 0u);
  bench.run(100);
  EXPECT_EQ(times, (std::vector<double>{0.0, 50.0 / 25e6}));
}

TEST_F(AdcFrontEnd, StoppingKeepsTheDataAndTakesNoMore) {
  start(50);
  bench.run(125);
  EXPECT_OK(bus.write(CTRL_offset, 0));
  bench.run(1000);
  EXPECT_EQ(taken.size(), 2u);
  EXPECT_EQ(bus.value_at(STATUS_offset), 0u);
  EXPECT_EQ(bus.value_at(DATA_U_offset), 0x20000000u);
}

TEST_F(AdcFrontEnd, WritingRunAgainDoesNotRestart) {
  start(100);
  bench.run(150);
  EXPECT_OK(bus.write(CTRL_offset, CTRL_RUN_mask | CTRL_IE_SAMPLE_mask));
  bench.run(50);
  EXPECT_EQ(taken.size(), 2u);
}

TEST_F(AdcFrontEnd, ANewPeriodHoldsFromTheNextSampleOn) {
  start(100);
  bench.run(150);
  EXPECT_OK(bus.write(PERIOD_offset, 60));
  bench.run(50 + 60 + 60);
  ASSERT_EQ(taken.size(), 4u);
  EXPECT_EQ(taken[1].cycle, started + 200);
  EXPECT_EQ(taken[2].cycle, started + 260);
  EXPECT_EQ(taken[3].cycle, started + 320);
  EXPECT_DOUBLE_EQ(times[3], 220 / 25e6);
}

TEST_F(AdcFrontEnd, IllegalValuesAreIgnoredAndFlagged) {
  EXPECT_OK(bus.write(PERIOD_offset, 31));
  EXPECT_EQ(bus.value_at(PERIOD_offset), PERIOD_reset);
  EXPECT_EQ(bus.value_at(FLAGS_offset), FLAGS_CONFIG_mask);
  EXPECT_OK(bus.write(FLAGS_offset, FLAGS_CONFIG_mask));
  EXPECT_EQ(bus.value_at(FLAGS_offset), 0u);
  for (const uint32_t bits : {0u, 11u, 33u, 63u}) {
    EXPECT_OK(bus.write(BITS_offset, bits));
    EXPECT_EQ(bus.value_at(BITS_offset), 32u);
    EXPECT_EQ(bus.value_at(FLAGS_offset), FLAGS_CONFIG_mask);
    EXPECT_OK(bus.write(FLAGS_offset, FLAGS_CONFIG_mask));
  }
  EXPECT_OK(bus.write(PERIOD_offset, 32));
  EXPECT_EQ(bus.value_at(PERIOD_offset), 32u);
}

TEST_F(AdcFrontEnd, AnotherFrequencyKeepsThePeriodInCyclesAndTheSensorInRealTime) {
  namespace pll = capsoc::registers::clockctrl;
  EXPECT_OK(clock_controller.write(pll::LOCK_TIME_offset, 0));
  EXPECT_OK(clock_controller.write(pll::PLL_offset, 4 | 1 << pll::PLL_DIV_shift));
  start(100);
  bench.run(150);
  EXPECT_OK(
      clock_controller.write(pll::CTRL_offset, pll::CTRL_PLL_EN_mask | pll::CTRL_SELECT_mask));
  bench.run(150);
  ASSERT_EQ(taken.size(), 3u);
  EXPECT_EQ(taken[1].cycle, started + 200);
  EXPECT_EQ(taken[2].cycle, started + 300);
  // 50 cycles of 40 ns, 50 of 10 ns, then 100 of 10 ns; the kernel's time is exact here.
  EXPECT_DOUBLE_EQ(times[1], 2.5e-6);
  EXPECT_DOUBLE_EQ(times[2], 3.5e-6);
}

TEST_F(AdcFrontEnd, ASampleKeepsTheNumberOfItsSource) {
  bench.adc.set_source([](uint64_t k, double) { return AdcInput{0.25, 0.5, 0, false, 70 + k}; });
  std::vector<uint64_t> indices, numbers, sunk;
  const auto listening =
      bench.adc.conversions.listen([&](uint64_t index, const SensorSample& sample) {
        indices.push_back(index);
        numbers.push_back(sample.number);
      });
  bench.adc.set_sink([&](const SensorSample& sample) { sunk.push_back(sample.number); });
  start(40);
  bench.run(120);
  EXPECT_EQ(indices, (std::vector<uint64_t>{0, 1, 2}));
  EXPECT_EQ(numbers, (std::vector<uint64_t>{70, 71, 72}));
  EXPECT_EQ(sunk, numbers);
}

TEST_F(AdcFrontEnd, ASinkMayStopIt) {
  bench.adc.set_sink([this](const SensorSample&) { EXPECT_OK(bus.write(CTRL_offset, 0)); });
  start(40);
  bench.run(400);
  EXPECT_EQ(bus.value_at(COUNT_offset), 1u);
}

}  // namespace
