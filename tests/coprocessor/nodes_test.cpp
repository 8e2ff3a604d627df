// The list of nodes against the model that it takes them from.
#include "coprocessor/nodes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string_view>

#include "bench.h"

namespace capsoc::coprocessor::test {
namespace {

NodeFormat format_of(std::string_view name) {
  const auto& names = node_names();
  const auto* const found = std::find_if(
      names.begin(), names.end(), [name](const NamedNode& node) { return node.name == name; });
  EXPECT_NE(found, names.end()) << name;
  return found == names.end() ? NodeFormat{} : found->format;
}

// A coprocessor under words, settings and spacings of any kind.
class Traffic {
 public:
  explicit Traffic(Arithmetic arithmetic) : dut_({arithmetic}) {}

  // Calls `seen(stage, nodes)` at the end of each stage's tick, and with commit_stage at the
  // commit.
  template <typename Seen>
  void run(int samples, Seen seen) {
    for (int i = 0; i < samples; ++i) {
      if (i % 64 == 0) settings(i / 64);
      const uint64_t latched = ++cycle_;
      dut_.submit(latched, word(), word(), pick(16) == 0);
      for (unsigned stage = 0; stage < stage_count; ++stage) {
        Nodes nodes;
        dut_.advance(latched + uint64_t{stage + 1} * tick_cycles);
        ASSERT_TRUE(dut_.stage_nodes(stage, nodes));
        seen(stage, nodes);
        if (testing::Test::HasFailure()) return;
      }
      cycle_ = latched + latency_cycles;
      dut_.advance(cycle_);
      ASSERT_EQ(dut_.nodes().commits, static_cast<uint64_t>(i) + 1);
      seen(commit_stage, dut_.nodes());
    }
  }

 private:
  uint64_t pick(uint64_t bound) { return random_() % bound; }

  int32_t word() {
    const auto any = static_cast<int32_t>(random_());
    if (pick(8) == 0) return any < 0 ? INT32_MIN : INT32_MAX;
    return pick(4) == 0 ? any >> pick(31) : any;
  }

  void write(uint32_t offset, uint64_t value) {
    dut_.write(++cycle_, offset, static_cast<uint32_t>(value));
  }

  void settings(int round) {
    write(reg_ctrl,
          ctrl_adc | ctrl_demod | ctrl_calib | static_cast<uint32_t>(round % 3) << ctrl_ref_shift);
    for (uint32_t offset = reg_step_au; offset <= reg_step_cv; offset += 4)
      write(offset, random_() >> (1 + pick(31)));
    write(reg_freq_lo, random_());
    write(reg_freq_hi, random_());
    write(reg_judge, random_());
    write(reg_turn_limit, pick(100));
  }

  std::mt19937 random_{1};
  Coprocessor dut_;
  uint64_t cycle_ = 0;
};

class OfTheModel : public testing::TestWithParam<Arithmetic> {};

TEST_P(OfTheModel, FitTheirFormats) {
  Traffic(GetParam()).run(3000, [](unsigned stage, const Nodes& nodes) {
    for (const NamedNode& node : node_names()) {
      if (node.stage != stage) continue;
      ASSERT_TRUE(node.format.fits(nodes.*node.value)) << node.name << " " << nodes.*node.value;
    }
  });
}

TEST_P(OfTheModel, AreThereAtTheEndOfTheirStage) {
  Nodes seen;
  Traffic(GetParam()).run(3000, [&seen](unsigned stage, const Nodes& nodes) {
    for (const NamedNode& node : node_names()) {
      if (stage == node.stage) seen.*node.value = nodes.*node.value;
      if (stage != commit_stage) continue;
      ASSERT_EQ(nodes.*node.value, seen.*node.value) << node.name << " of stage " << node.stage;
    }
  });
}

INSTANTIATE_TEST_SUITE_P(Nodes, OfTheModel, testing::Values(Arithmetic::precise, Arithmetic::paper),
                         [](const auto& suite) {
                           return suite.param == Arithmetic::paper ? "Paper" : "Precise";
                         });

TEST(Nodes, StandStageByStage) {
  const auto& names = node_names();
  EXPECT_TRUE(std::is_sorted(names.begin(), names.end(),
                             [](const auto& a, const auto& b) { return a.stage < b.stage; }));
  EXPECT_EQ(names.back().stage, commit_stage);
}

TEST(NodeFormat, Values) {
  EXPECT_DOUBLE_EQ(format_of("a1").value(0x40000000), 0.5);
  EXPECT_DOUBLE_EQ(format_of("u").value(-0x40000000), -0.5);
  EXPECT_DOUBLE_EQ(format_of("a_u").value(int64_t{3} << 45), 1.5);
  EXPECT_DOUBLE_EQ(format_of("angle").value(0xC0000000), 270);
  EXPECT_DOUBLE_EQ(format_of("residue").value(-0x40000000), -90);
  EXPECT_DOUBLE_EQ(format_of("frequency").value(int64_t{1} << 46), 90);
  EXPECT_DOUBLE_EQ(format_of("travel").value(-(int64_t{1} << 28)), -90);
  EXPECT_DOUBLE_EQ(format_of("deviation").value(0xC0000000), 1.5);
  EXPECT_DOUBLE_EQ(format_of("samples").value(7), 7);
}

TEST(NodeFormat, FitsUpToItsLastBit) {
  const NodeFormat q1_31 = format_of("u"), angle = format_of("angle"), flag = format_of("clip");
  EXPECT_TRUE(q1_31.fits(INT32_MIN) && q1_31.fits(INT32_MAX));
  EXPECT_FALSE(q1_31.fits(int64_t{INT32_MAX} + 1) || q1_31.fits(int64_t{INT32_MIN} - 1));
  EXPECT_TRUE(angle.fits(0) && angle.fits(UINT32_MAX));
  EXPECT_FALSE(angle.fits(-1) || angle.fits(int64_t{UINT32_MAX} + 1));
  EXPECT_TRUE(flag.fits(1));
  EXPECT_FALSE(flag.fits(2) || flag.fits(-1));
  EXPECT_TRUE(format_of("s_low").fits(INT64_MIN));
}

}  // namespace
}  // namespace capsoc::coprocessor::test
