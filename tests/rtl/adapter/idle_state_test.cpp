// While nothing is in the pipeline, the RTL's registers and the model's state say the same, and
// each continues from the other's.
#include "coprocessor/idle_state.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "coprocessor/coprocessor.h"
#include "libraries.h"
#include "rtl/coprocessor_rtl.h"
#include "rtl/lockstep.h"
#include "stimulus.h"

namespace capsoc::rtl::test {
namespace {

using namespace coprocessor;

/// Both side by side, each of them within reach.
struct Sides {
  Sides(const Options& options, RtlLibrary::Handle library) {
    auto a = std::make_unique<Coprocessor>(options);
    auto b = std::make_unique<CoprocessorRtl>(std::move(library));
    model = a.get();
    rtl = b.get();
    both = std::make_unique<Lockstep>(std::move(a), std::move(b));
  }
  Device* model;
  Device* rtl;
  std::unique_ptr<Lockstep> both;
};

std::string bytes_of(IdleState state) {
  StateWriter writer;
  writer("state", state);
  return writer.take();
}

std::string difference(const std::string& saved, IdleState state) {
  StateComparison comparison(saved);
  comparison("state", state);
  return comparison.difference();
}

/// Revolutions of a sensor with offsets, some samples clipped or wild: windows that end, good ones,
/// alarms.
uint64_t turn(Device& device, std::mt19937_64& random, uint64_t cycle, int samples) {
  const auto pick = [&](uint64_t bound) { return random() % bound; };
  const double step = 0.05 + static_cast<double>(pick(100)) * 0.01;
  device.write(cycle += 2, reg_ctrl,
               (static_cast<uint32_t>(random()) & ctrl_writable & ~ctrl_ref_mask) | ctrl_adc |
                   static_cast<uint32_t>(pick(3) << ctrl_ref_shift));
  device.write(cycle += 2, reg_lock_threshold, 0x7fffffff);
  device.write(cycle += 2, reg_turn_limit, static_cast<uint32_t>(pick(2) * (10 + pick(100))));
  device.write(cycle += 2, reg_judge, static_cast<uint32_t>(pick(8)) << judge_slew_shift | 0x13333);
  // Of both, most limits; with BAD_PARITY some registers keep a wrong bit.
  device.write(cycle += 2, reg_safety, static_cast<uint32_t>(random()));
  if (pick(2) == 0) device.write(cycle += 2, reg_loop, static_cast<uint32_t>(random()));
  if (pick(2) == 0) device.write(cycle += 2, reg_av_hi, static_cast<uint32_t>(random()));
  for (int i = 0; i < samples; ++i) {
    const double angle = i * step;
    const auto word = [](double value) { return static_cast<int32_t>(value * 2147483647.0); };
    const bool wild = pick(40) == 0;
    device.submit(cycle += 40 + pick(150), word(wild ? 0.9 : 0.5 * std::sin(angle)),
                  word(0.5 * std::cos(angle)), pick(200) == 0);
  }
  return cycle;
}

class IdleStates : public testing::TestWithParam<Arithmetic> {
 protected:
  /// Both in the model's first state: what no reset reaches is anything in the RTL.
  std::unique_ptr<Sides> begin() {
    auto sides = std::make_unique<Sides>(options, library);
    IdleState first;
    EXPECT_TRUE(sides->model->save_idle(first));
    EXPECT_TRUE(sides->both->load_idle(first));
    return sides;
  }

  Options options = options_of(GetParam());
  RtlLibrary::Handle library = open_library(GetParam());
};

TEST_P(IdleStates, AreTheSameOnBothSidesAndEachGoesOnFromThem) {
  unsigned windows = 0, alarms = 0, commits = 0;
  for (uint64_t seed = 1; seed <= 6; ++seed) {
    std::mt19937_64 random(seed);
    const auto pick = [&](uint64_t bound) { return random() % bound; };
    Traffic traffic(seed);
    Answers answers;
    auto sides = begin();
    uint64_t cycle = 0;
    for (int part = 0; part < 60; ++part) {
      Lockstep& both = *sides->both;
      if (pick(2) == 0)
        cycle = traffic.run(both, 1 + static_cast<int>(pick(60)), cycle, answers);
      else
        cycle = turn(both, random, cycle, 1 + static_cast<int>(pick(120)));
      both.advance(++cycle);
      while (const auto next = both.next_event()) both.advance(cycle = *next);
      ++cycle;
      if (pick(2) == 0) both.read(cycle, reg_freq_hi + (pick(2) == 0 ? 0 : 8), false);
      ASSERT_FALSE(both.difference()) << "seed " << seed << "\n" << both.report("");

      IdleState ours, theirs;
      ASSERT_TRUE(sides->model->save_idle(ours));
      ASSERT_TRUE(sides->rtl->save_idle(theirs));
      ASSERT_EQ(difference(bytes_of(ours), theirs), "") << "seed " << seed << ", part " << part;
      windows += ours.judge.turn_count != 0;
      alarms += ours.judge.alarm;
      commits += ours.nodes.commits > 0;
      if (pick(2) == 0) continue;
      sides = begin();
      if (pick(2) == 0) traffic.run(*sides->both, 20, 0, answers);  // what is there goes
      ASSERT_TRUE(sides->both->load_idle(theirs));
      IdleState back;
      ASSERT_TRUE(sides->rtl->save_idle(back));
      ASSERT_EQ(difference(bytes_of(ours), back), "") << "seed " << seed << ", part " << part;
    }
  }
  EXPECT_GT(windows, 50u);
  EXPECT_GT(alarms, 5u);
  EXPECT_GT(commits, 200u);
}

TEST_P(IdleStates, AreNoneWhileSomethingIsComputed) {
  Sides sides(options, library);
  sides.both->write(1, reg_cmd, cmd_load);
  IdleState state;
  EXPECT_FALSE(sides.model->save_idle(state));
  EXPECT_FALSE(sides.rtl->save_idle(state));
  EXPECT_FALSE(sides.both->save_idle(state));
  sides.both->advance(1000);
  EXPECT_TRUE(sides.both->save_idle(state));
  EXPECT_EQ(state.cycle, 1000u);
}

INSTANTIATE_TEST_SUITE_P(Both, IdleStates, testing::Values(Arithmetic::precise, Arithmetic::paper),
                         [](const auto& test) {
                           return test.param == Arithmetic::paper ? "paper" : "precise";
                         });

}  // namespace
}  // namespace capsoc::rtl::test
