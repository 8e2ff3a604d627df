// What model and RTL may have wrong alike, so that no comparison of the two sees it: the edge at
// which a freeze begins and ends, and magnitudes of the most negative word. The expectations are
// the page's (docs/reference/coprocessor.md).
#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "coprocessor/coprocessor.h"
#include "coprocessor/lms_demodulator.h"
#include "coprocessor/register_map.h"
#include "coprocessor/turn_judge.h"

namespace capsoc::coprocessor::test {
namespace {

constexpr uint64_t first_sample = 10;

class Freeze : public testing::TestWithParam<Arithmetic> {
 protected:
  Freeze() {
    dut.write(1, reg_judge, 0);  // CLIP alone is a glitch
    dut.write(2, reg_ctrl, ctrl_adc | ctrl_demod | ctrl_calib | ctrl_freeze);
  }

  /// To `edge`, with a sample every tick, of which `clipped` are clipped.
  void run_to(uint64_t edge, unsigned clipped) {
    while (cycle < edge) {
      ++cycle;
      dut.advance(cycle);
      if (cycle < first_sample || (cycle - first_sample) % tick_cycles != 0) continue;
      const uint64_t number = (cycle - first_sample) / tick_cycles;
      dut.submit(cycle, 1 << 29, -(1 << 28), number < clipped);
    }
  }

  std::vector<uint32_t> weights() {
    std::vector<uint32_t> words;
    for (uint32_t offset = reg_au_lo; offset <= reg_cv_hi; offset += 4)
      words.push_back(dut.read(cycle, offset, true).value);
    return words;
  }

  uint32_t flags() { return dut.read(cycle, reg_flags, true).value; }

  Coprocessor dut{{GetParam()}};
  uint64_t cycle = 2;
};

constexpr uint64_t committed(uint64_t sample) {
  return first_sample + sample * tick_cycles + latency_cycles;
}

// The sixteenth clipped sample raises the alarm. The T3 that ends at its commit began without it
// and learns; the one that begins there does not, nor any after it.
TEST_P(Freeze, BeginsWithTheTickThatBeginsAtTheAlarm) {
  constexpr unsigned glitches = 16;
  const uint64_t alarm = committed(glitches - 1);
  run_to(alarm - 1, 100);
  EXPECT_EQ(flags() & flag_alarm, 0u);
  const auto before = weights();
  run_to(alarm, 100);
  EXPECT_EQ(flags() & flag_alarm, flag_alarm);
  const auto frozen = weights();
  EXPECT_NE(frozen, before) << "the sample ahead of the alarm is learnt";
  for (unsigned i = 1; i < 8; ++i) {
    run_to(alarm + uint64_t{i} * tick_cycles, 100);
    ASSERT_EQ(weights(), frozen) << i << " ticks behind the alarm";
  }
}

// Cleared at a tick's first edge, the flag still holds for the T3 that begins there.
TEST_P(Freeze, EndsWithTheTickBehindTheOneAtWhoseEdgeTheFlagIsCleared) {
  constexpr unsigned glitches = 16, calm = 40;  // the alarm falls after as many good samples
  const uint64_t cleared = committed(glitches + calm);
  run_to(cleared, glitches);
  const auto frozen = weights();
  ASSERT_EQ(flags() & flag_alarm, flag_alarm);
  dut.write(cleared, reg_flags, flag_alarm);
  run_to(cleared + tick_cycles, glitches);
  EXPECT_EQ(weights(), frozen);
  run_to(cleared + 2 * tick_cycles, glitches);
  EXPECT_NE(weights(), frozen);
}

INSTANTIATE_TEST_SUITE_P(Both, Freeze, testing::Values(Arithmetic::precise, Arithmetic::paper),
                         [](const auto& test) {
                           return test.param == Arithmetic::paper ? "paper" : "precise";
                         });

constexpr uint32_t half = uint32_t{1} << 31;

TEST(MostNegativeWord, OfAnErrorCountsWhole) {
  EXPECT_EQ(next_error_sum(0, INT32_MIN), uint64_t{half});
  EXPECT_EQ(next_error_sum(0, INT32_MIN + 1), uint64_t{half} - 1);
  EXPECT_EQ(next_error_sum(0, INT32_MAX), uint64_t{half} - 1);
  // 64 times an average of 1.0 is where it comes to rest, less what rounding keeps.
  uint64_t sum = 0;
  for (unsigned i = 0; i < 4000; ++i) sum = next_error_sum(sum, INT32_MIN);
  EXPECT_EQ(sum, (uint64_t{1} << 37) - 32);
  EXPECT_EQ(error_average(sum), half);
}

TEST(MostNegativeWord, OfAResidueIsHalfATurn) {
  JudgedSample sample;
  sample.residue = INT32_MIN;
  EXPECT_EQ(judge({}, sample, {}, false).window.residue_max, half);
  sample.residue = INT32_MIN + 1;
  EXPECT_EQ(judge({}, sample, {}, false).window.residue_max, half - 1);
}

TEST(MostNegativeWord, OfADeterminantIsOne) {
  JudgedSample sample;
  sample.det = INT32_MIN;
  EXPECT_EQ(judge({}, sample, {}, false).deviation, half);
  sample.amplitude = INT32_MAX;
  EXPECT_EQ(judge({}, sample, {}, false).deviation, 1u);
  // L(n) = (|DET| n) >> 8
  for (uint32_t n : {1u, 51u, 255u}) {
    const uint32_t limit = (half >> 8) * n;
    EXPECT_TRUE(is_beyond(limit, INT32_MIN, n)) << n;
    EXPECT_FALSE(is_beyond(limit - 1, INT32_MIN, n)) << n;
  }
}

}  // namespace
}  // namespace capsoc::coprocessor::test
