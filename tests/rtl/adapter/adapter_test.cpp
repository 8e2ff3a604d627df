// The Verilated coprocessor as a Device: same answers as the model, whether or not idle clocks are
// skipped.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "coprocessor/coprocessor.h"
#include "libraries.h"
#include "rtl/coprocessor_rtl.h"
#include "stimulus.h"

namespace capsoc::rtl::test {
namespace {

using namespace coprocessor;

class Adapter : public testing::TestWithParam<Arithmetic> {
 protected:
  RtlLibrary::Handle library = open_library(GetParam());
};

TEST_P(Adapter, SkippingIdleClocksChangesNothing) {
  for (uint64_t seed = 1; seed <= 3; ++seed) {
    CoprocessorRtl skipping(library, Clocking::skip);
    CoprocessorRtl clocked(library, Clocking::every);
    Answers ours, theirs;
    const uint64_t end = Traffic(seed).run(skipping, 2000, 0, ours);
    Traffic(seed).run(clocked, 2000, 0, theirs);
    EXPECT_EQ(ours, theirs) << "seed " << seed;
    skipping.advance(end + 1000);
    clocked.advance(end + 1000);
    for (uint32_t offset = 0; offset < 0x100; offset += 4)
      EXPECT_EQ(skipping.read(end + 1000, offset, true).value,
                clocked.read(end + 1000, offset, true).value)
          << offset;
    EXPECT_LT(skipping.clocks(), clocked.clocks());
    EXPECT_EQ(clocked.clocks(), end + 1000);
  }
}

TEST_P(Adapter, AnswersAsTheModelDoes) {
  for (uint64_t seed = 11; seed <= 13; ++seed) {
    Coprocessor model(options_of(GetParam()));
    CoprocessorRtl rtl(library);
    Answers ours, theirs;
    Traffic(seed).run(model, 2000, 0, ours);
    Traffic(seed).run(rtl, 2000, 0, theirs);
    EXPECT_EQ(ours, theirs) << "seed " << seed;
  }
}

/// With waves, every edge evaluates the whole design; without, those of a single sample are the
/// ones that were compiled for it. Everything that Verilator has of the design must be the same.
TEST_P(Adapter, SpecialisedEdgesLeaveWhatTheWholeDesignLeaves) {
  for (const uint64_t gap : {40u, 300u, 1000u}) {
    CoprocessorRtl specialised(library), whole(library);
    // A separate name: an FST writer removes what has the name, be it a device.
    const std::string waves = testing::TempDir() + "whole" + std::to_string(getpid()) + ".fst";
    ASSERT_FALSE(whole.open_waves(waves, 40));
    uint64_t cycle = 0;
    for (uint64_t seed = 31; seed < 51; ++seed) {
      Answers ours, theirs;
      Traffic(seed, gap).run(specialised, 40, cycle, ours);
      const uint64_t end = Traffic(seed, gap).run(whole, 40, cycle, theirs);
      ASSERT_EQ(ours, theirs) << "gap " << gap << ", seed " << seed;
      cycle = end + seed % 7 * 40;
      specialised.advance(cycle);
      whole.advance(cycle);
      StateWriter writer;
      whole.visit(writer);
      const std::string state = writer.take();
      StateComparison comparison(state);
      specialised.visit(comparison);
      ASSERT_EQ(comparison.difference(), "") << "gap " << gap << ", seed " << seed;
    }
    whole.close_waves();
    std::filesystem::remove(waves);
  }
}

TEST_P(Adapter, ACopyGoesOnAlone) {
  CoprocessorRtl original(library);
  Answers start, ours, theirs;
  const uint64_t cycle = Traffic(21).run(original, 500, 0, start);
  const auto copy = original.clone();
  ASSERT_NE(copy, nullptr);
  Traffic(22).run(original, 500, cycle, ours);
  Traffic(22).run(*copy, 500, cycle, theirs);
  EXPECT_EQ(ours, theirs);
}

TEST_P(Adapter, AnInputActsAtItsEdgeAndAReadShowsTheStateBeforeTheNext) {
  CoprocessorRtl rtl(library);
  EXPECT_TRUE(rtl.write(10, reg_ctrl, ctrl_adc));
  EXPECT_FALSE(rtl.write(12, 0x0E8, 0)) << "no register";
  EXPECT_TRUE(rtl.submit(20, 1 << 20, 1 << 20, false));
  EXPECT_EQ(rtl.read(19 + 1, reg_status, false).value & status_busy, status_busy);
  EXPECT_EQ(rtl.next_event(), 181u);
  EXPECT_EQ(rtl.read(180, reg_samples, false).value, 0u);
  EXPECT_EQ(rtl.read(181, reg_samples, false).value, 1u);
  EXPECT_TRUE(rtl.idle());
  EXPECT_FALSE(rtl.next_event());
}

TEST_P(Adapter, TheDebuggerDoesNotLatchTheLowWord) {
  CoprocessorRtl rtl(library);
  rtl.write(10, reg_freq_lo, 0x1111);
  rtl.write(12, reg_freq_hi, 1);
  EXPECT_EQ(rtl.read(14, reg_freq_hi, false).value, 1u);
  rtl.write(16, reg_freq_lo, 0x2222);
  rtl.write(18, reg_freq_hi, 2);
  EXPECT_EQ(rtl.read(20, reg_freq_hi, true).value, 2u);
  EXPECT_EQ(rtl.read(20, reg_freq_lo, true).value, 0x2222u);
  EXPECT_EQ(rtl.read(20, reg_freq_lo, false).value, 0x1111u) << "as the guest latched it";
}

INSTANTIATE_TEST_SUITE_P(Both, Adapter, testing::Values(Arithmetic::precise, Arithmetic::paper),
                         [](const auto& test) {
                           return test.param == Arithmetic::paper ? "paper" : "precise";
                         });

}  // namespace
}  // namespace capsoc::rtl::test
