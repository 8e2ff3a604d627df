// Lockstep: no difference where there is none, and the right report where one was planted.
#include "rtl/lockstep.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>

#include "coprocessor/coprocessor.h"
#include "libraries.h"
#include "rtl/coprocessor_rtl.h"
#include "stimulus.h"

namespace capsoc::rtl::test {
namespace {

using namespace coprocessor;

/// What a faulty model gets wrong; each function sees what the model would have answered.
struct Faults {
  std::function<void(unsigned stage, Nodes&)> node = [](unsigned, Nodes&) {};
  std::function<void(uint32_t offset, RegisterAccess&)> read = [](uint32_t, RegisterAccess&) {};
  std::function<bool(bool)> interrupt = [](bool level) { return level; };
  uint64_t late = 0;  // cycles by which a sample comes late
};

class FaultyModel : public Device {
 public:
  FaultyModel(const Options& options, Faults faults)
      : model_(options), faults_(std::move(faults)) {}

  void reset() override { model_.reset(); }
  void advance(uint64_t cycle) override { model_.advance(cycle); }
  std::optional<uint64_t> next_event() const override { return model_.next_event(); }
  bool submit(uint64_t cycle, int32_t u, int32_t v, bool clip) override {
    return model_.submit(cycle + faults_.late, u, v, clip);
  }
  RegisterAccess read(uint64_t cycle, uint32_t offset, bool debug) override {
    RegisterAccess access = model_.read(cycle, offset, debug);
    faults_.read(offset, access);
    return access;
  }
  bool write(uint64_t cycle, uint32_t offset, uint32_t value) override {
    return model_.write(cycle, offset, value);
  }
  bool interrupt() const override { return faults_.interrupt(model_.interrupt()); }
  bool idle() const override { return model_.idle(); }
  const Nodes& nodes() const override { return model_.nodes(); }
  unsigned tick() const override { return model_.tick(); }
  bool stage_nodes(unsigned stage, Nodes& nodes) const override {
    if (!model_.stage_nodes(stage, nodes)) return false;
    faults_.node(stage, nodes);
    return true;
  }
  std::unique_ptr<Device> clone() const override { return std::make_unique<FaultyModel>(*this); }

 private:
  Coprocessor model_;
  Faults faults_;
};

class LockstepTest : public testing::TestWithParam<Arithmetic> {
 protected:
  std::unique_ptr<Lockstep> lockstep(const Faults& faults) {
    return std::make_unique<Lockstep>(std::make_unique<FaultyModel>(options_of(GetParam()), faults),
                                      std::make_unique<CoprocessorRtl>(library));
  }

  RtlLibrary::Handle library = open_library(GetParam());
};

TEST_P(LockstepTest, ModelAndRtlAgreeOnRandomTraffic) {
  for (uint64_t seed = 101; seed <= 106; ++seed) {
    Lockstep both(std::make_unique<Coprocessor>(options_of(GetParam())),
                  std::make_unique<CoprocessorRtl>(library));
    Answers answers;
    Traffic(seed).run(both, 3000, 0, answers);
    ASSERT_FALSE(both.difference()) << "seed " << seed << "\n" << both.report("");
    EXPECT_GT(both.counters().nodes, 1000u);
    EXPECT_GT(both.counters().commits, 100u);
  }
}

TEST_P(LockstepTest, AWrongNodeIsNamedWithItsUnit) {
  Faults faults;
  faults.node = [count = 0](unsigned stage, Nodes& nodes) mutable {
    if (stage == 2 && ++count == 100) ++nodes.sine;
  };
  const auto both = lockstep(faults);
  int told = 0;
  both->on_difference([&] { ++told; });
  Answers answers;
  Traffic(5).run(*both, 3000, 0, answers);
  ASSERT_TRUE(both->difference());
  EXPECT_EQ(told, 1) << "only the first difference counts";
  EXPECT_EQ(both->difference()->node, "sine (T2, reference generator)") << both->report("");
  const std::string report = both->report("capsoc run --coprocessor lockstep");
  EXPECT_NE(report.find("last samples"), std::string::npos);
  EXPECT_NE(report.find("to reproduce: capsoc run"), std::string::npos);
}

// T4 has two units.
TEST_P(LockstepTest, AWrongNodeOfTheTurnJudgeIsNamedWithIt) {
  Faults faults;
  faults.node = [](unsigned stage, Nodes& nodes) {
    if (stage == 4) ++nodes.travel;
  };
  const auto both = lockstep(faults);
  Answers answers;
  Traffic(5).run(*both, 3000, 0, answers);
  ASSERT_TRUE(both->difference());
  EXPECT_EQ(both->difference()->node, "travel (T4, turn judge)") << both->report("");
}

TEST_P(LockstepTest, AWrongReadIsFound) {
  Faults faults;
  faults.read = [](uint32_t offset, RegisterAccess& access) {
    if (offset == reg_loop) access.value ^= 1u << 12;
  };
  const auto both = lockstep(faults);
  EXPECT_EQ(both->read(5, reg_id, false).value, description::ID_reset);
  EXPECT_FALSE(both->difference());
  both->read(9, reg_loop, false);
  ASSERT_TRUE(both->difference());
  EXPECT_EQ(both->difference()->what, "read of 0x040 (LOOP)");
  EXPECT_EQ(both->difference()->rtl, "0xa04");
  EXPECT_EQ(both->difference()->model, "0x1a04");
  EXPECT_EQ(both->difference()->cycle, 9u);
}

TEST_P(LockstepTest, AWrongLoadIsNamedWithoutASample) {
  Faults faults;
  bool loaded = false;
  faults.read = [&](uint32_t offset, RegisterAccess& access) {
    if (loaded && offset == reg_au_lo + 28) access.value ^= 1;  // AV_HI
  };
  const auto both = lockstep(faults);
  both->write(5, reg_cmd, cmd_load);
  loaded = true;
  both->advance(300);
  ASSERT_TRUE(both->difference());
  EXPECT_EQ(both->difference()->node, "a_v (LOAD)");
  EXPECT_LE(both->difference()->cycle, 5u + 1 + 3 * 32) << "three ticks after the command";
}

TEST_P(LockstepTest, AWrongInterruptIsFoundAtItsEdge) {
  Faults faults;
  faults.interrupt = [](bool) { return false; };
  faults.read = [](uint32_t offset, RegisterAccess& access) {
    if (offset == reg_flags) access.value &= ~1u;  // RESULT
  };
  const auto both = lockstep(faults);
  both->write(5, reg_ctrl, ctrl_adc | ctrl_ie_result);
  both->submit(100, 1 << 29, 1 << 28, false);
  both->advance(400);
  ASSERT_TRUE(both->difference());
  EXPECT_EQ(both->difference()->what, "interrupt line");
  EXPECT_EQ(both->difference()->cycle, 261u);
  EXPECT_EQ(both->difference()->registers, "FLAGS 0x00000000 0x00000001");
  EXPECT_NE(both->report("", 40).find("registers   FLAGS 0x00000000 0x00000001 (model, rtl)"),
            std::string::npos);
}

TEST_P(LockstepTest, AnotherLatencyIsFound) {
  Faults faults;
  faults.late = 1;
  const auto both = lockstep(faults);
  both->write(5, reg_ctrl, ctrl_adc);
  both->submit(100, 1 << 29, 1 << 28, false);
  both->advance(400);
  ASSERT_TRUE(both->difference());
  EXPECT_EQ(both->difference()->what, "next event");
  EXPECT_EQ(both->difference()->cycle, 100u);
}

TEST_P(LockstepTest, BothSidesAroundTheDifferenceGoToAWaveFile) {
  Faults faults;
  faults.node = [count = 0](unsigned stage, Nodes& nodes) mutable {
    if (stage == 0 && ++count == 500) nodes.cal_s ^= 1;
  };
  const auto both = lockstep(faults);
  Answers answers;
  Traffic(6).run(*both, 3000, 0, answers);
  ASSERT_TRUE(both->difference());
  const std::string file = testing::TempDir() + "lockstep_test_" +
                           (GetParam() == Arithmetic::paper ? "paper" : "precise") + ".fst";
  EXPECT_FALSE(both->write_waves(file));
  EXPECT_GT(std::filesystem::file_size(file), 1000u);
  std::remove(file.c_str());
  EXPECT_TRUE(both->write_waves("/nonexistent/waves.fst"));
}

INSTANTIATE_TEST_SUITE_P(Both, LockstepTest,
                         testing::Values(Arithmetic::precise, Arithmetic::paper),
                         [](const auto& test) {
                           return test.param == Arithmetic::paper ? "paper" : "precise";
                         });

}  // namespace
}  // namespace capsoc::rtl::test
