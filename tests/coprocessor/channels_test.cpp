// Several channels: docs/reference/coprocessor.md, "Channels".
#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <random>
#include <vector>

#include "base/archive.h"
#include "bench.h"
#include "coprocessor/channel_register.h"
#include "several_channels.h"

namespace capsoc::coprocessor::test {
namespace {

constexpr unsigned change = 1 + change_cycles;  // from the edge that asks for it to the last of it

class Channels : public testing::Test {
 protected:
  uint32_t read(uint32_t offset) { return dut.read(cycle, offset, false).value; }
  void write(uint32_t offset, uint32_t value) { dut.write(++cycle, offset, value); }
  void choose(unsigned window, bool hold) {
    write(channel::offset, window | (hold ? channel::hold : 0));
  }
  void open(unsigned window) {
    choose(window, true);
    while ((read(channel::offset) & channel::ready) == 0) dut.advance(++cycle);
  }
  void take_samples_of(unsigned window, uint32_t ctrl = ctrl_adc | ctrl_calib) {
    open(window);
    write(reg_ctrl, ctrl);
  }
  bool submit(unsigned of, uint64_t at) { return dut.submit_of(of, at, 1 << 29, 1 << 28, false); }
  uint64_t commits(uint64_t at) {
    dut.advance(at);
    return dut.nodes().commits;
  }

  Coprocessor dut{with_channels(4)};
  uint64_t cycle = 0;
};

TEST_F(Channels, AreThereWithTheParameterAlone) {
  Coprocessor one{Options{}};
  EXPECT_FALSE(one.read(1, channel::offset, false).ok);
  EXPECT_FALSE(one.write(2, channel::offset, 0));
  EXPECT_EQ(one.read(2, reg_version, false).value, 0x00010005u);
  EXPECT_EQ(read(channel::offset), channel::hold | channel::ready | 3u << channel::last_shift);
  EXPECT_EQ(read(reg_version), 0x00010006u);
}

TEST_F(Channels, SoftwareThatKnowsOfNoneHasTheFirst) {
  write(reg_ctrl, ctrl_adc);
  EXPECT_TRUE(submit(0, 1000));
  EXPECT_FALSE(submit(1, 1200)) << "its CTRL.ADC is 0";
  EXPECT_FALSE(submit(4, 1201)) << "there is no such channel";
  EXPECT_EQ(commits(1000 + latency_cycles), 1u);
  cycle = 2000;
  EXPECT_EQ(read(reg_samples), 1u);
}

TEST_F(Channels, AnotherChannelsSampleComesThirtyThreeEdgesLater) {
  take_samples_of(0);
  take_samples_of(2);
  choose(2, false);
  EXPECT_TRUE(submit(2, 1000));  // its context is there
  EXPECT_EQ(commits(1160), 0u);
  EXPECT_EQ(commits(1161), 1u);
  EXPECT_TRUE(submit(0, 2000));
  EXPECT_EQ(dut.next_event(), std::optional<uint64_t>{2001});
  EXPECT_EQ(commits(2000 + change + 160), 1u);
  EXPECT_EQ(commits(2000 + change + 161), 2u);
  EXPECT_EQ(dut.nodes().channel, 0u);
}

TEST_F(Channels, AnotherChannelsSampleWaitsForTheLastOfTheFirst) {
  take_samples_of(0);
  take_samples_of(1);
  choose(1, false);
  EXPECT_TRUE(submit(1, 1000));  // T0 from 1001, committed at 1161
  EXPECT_TRUE(submit(0, 1010));
  EXPECT_FALSE(submit(1, 1040)) << "the place is taken";
  EXPECT_EQ(commits(1161), 1u);
  EXPECT_FALSE(submit(0, 1161 + change));  // it enters at the edge after the change's last one
  EXPECT_TRUE(submit(0, 1161 + change + 1));
  EXPECT_EQ(commits(1161 + change + 160), 1u);
  EXPECT_EQ(commits(1161 + change + 161), 2u);
}

TEST_F(Channels, AWindowIsReadyThirtyThreeEdgesAfterItIsAskedFor) {
  choose(3, true);  // at edge 1
  for (cycle = 1; cycle < 1 + change; ++cycle) {
    EXPECT_EQ(read(channel::offset) & channel::ready, 0u) << cycle;
    dut.advance(cycle + 1);
  }
  EXPECT_NE(read(channel::offset) & channel::ready, 0u);
}

TEST_F(Channels, AWindowThatIsHeldKeepsOtherSamplesWaiting) {
  take_samples_of(1);
  take_samples_of(0);
  const uint64_t start = cycle + 10;
  EXPECT_TRUE(submit(1, start));
  EXPECT_FALSE(submit(0, start + 1)) << "the place is taken";
  EXPECT_EQ(commits(start + 1000), 0u);
  cycle = start + 1000;
  EXPECT_EQ(read(reg_status) & status_busy, 0u) << "this channel has nothing to do";
  EXPECT_FALSE(dut.idle());
  EXPECT_EQ(read(reg_early_count), 1u);
  EXPECT_EQ(read(reg_flags), flag_early);
  choose(0, false);
  EXPECT_EQ(commits(cycle + change + 160), 0u);
  EXPECT_EQ(commits(cycle + change + 161), 1u);
}

TEST_F(Channels, AResetOfOneLeavesAnothersSample) {
  take_samples_of(1);
  take_samples_of(0);
  EXPECT_TRUE(submit(0, cycle + 10));
  EXPECT_TRUE(submit(1, cycle + 60));
  cycle += 100;
  write(reg_ctrl, ctrl_srst);
  EXPECT_EQ(read(reg_status) & status_busy, 0u);
  choose(0, false);
  EXPECT_EQ(commits(cycle + 1000), 1u);
  EXPECT_EQ(dut.nodes().channel, 1u);
}

TEST_F(Channels, ALostSampleIsOfItsChannel) {
  take_samples_of(2, ctrl_adc | ctrl_ie_error);
  take_samples_of(0);
  choose(0, false);
  EXPECT_TRUE(submit(0, cycle + 10));
  EXPECT_TRUE(submit(0, cycle + 20));
  EXPECT_FALSE(dut.interrupt());
  EXPECT_FALSE(submit(2, cycle + 22));
  EXPECT_FALSE(submit(2, cycle + 23));
  EXPECT_TRUE(dut.interrupt());
  cycle += 500;
  EXPECT_EQ(read(channel::offset) >> channel::pending_shift, 1u << 2);
  open(2);
  EXPECT_EQ(read(reg_early_count), 2u);
  write(reg_flags, flag_early);
  EXPECT_FALSE(dut.interrupt());
  open(0);
  EXPECT_EQ(read(reg_early_count), 0u);
}

TEST_F(Channels, AnAccessWithoutAWindowHasNoEffectAndIsNoted) {
  choose(0, false);
  EXPECT_EQ(read(reg_a1), 0u);
  EXPECT_NE(read(channel::offset) & channel::refused, 0u);
  write(channel::offset, channel::refused);
  EXPECT_EQ(read(channel::offset) & channel::refused, 0u);
  EXPECT_EQ(read(reg_id), description::ID_reset);
  EXPECT_EQ(read(reg_latency), latency_cycles);
  EXPECT_EQ(read(channel::offset) & channel::refused, 0u) << "these are everyone's";
  write(reg_a1, 5);
  EXPECT_NE(read(channel::offset) & channel::refused, 0u);
  write(channel::offset, channel::refused | channel::hold);
  EXPECT_EQ(read(reg_a1), description::A1_reset);
  write(channel::offset, 4 | channel::hold);
  EXPECT_EQ(read(channel::offset),
            channel::hold | channel::ready | channel::refused | 3u << channel::last_shift)
      << "there is no channel 4";
}

TEST_F(Channels, ALoadEndsBeforeTheContextChanges) {
  write(reg_phi, 1u << 30);
  write(reg_cmd, cmd_load);
  choose(1, true);
  const uint64_t asked = cycle - 1;
  while ((read(channel::offset) & channel::ready) == 0) dut.advance(++cycle);
  EXPECT_EQ(cycle, asked + 97 + change);
  open(0);
  EXPECT_EQ(static_cast<int32_t>(read(reg_bu_hi)), 1 << 30);
}

TEST_F(Channels, TheWholeResetReachesEveryChannel) {
  for (unsigned each = 0; each < 4; ++each) {
    open(each);
    write(reg_a1, each + 1);
    write(reg_correction, each << correction_node_shift | 7);
  }
  dut.reset();
  EXPECT_EQ(read(channel::offset), channel::hold | channel::ready | 3u << channel::last_shift);
  for (unsigned each = 0; each < 4; ++each) {
    open(each);
    EXPECT_EQ(read(reg_a1), description::A1_reset);
    IdleState state;
    ASSERT_TRUE(dut.save_idle(state));
    EXPECT_EQ(state.corrections.at(each), 7) << "a memory that no reset reaches";
    EXPECT_EQ(state.corrections.at((each + 1) % 4), 0);
  }
}

std::string saved(Device& device) {
  StateWriter writer;
  device.visit(writer);
  return writer.take();
}

// Random accesses and samples of any channel, as drivers make them, and each channel's again on a
// separate coprocessor.
class Separate {
 public:
  Separate(const Options& options, uint64_t seed)
      : options_(options), random_(seed), together_(options) {
    Options one = options;
    one.channels = 1;
    alone_.assign(static_cast<std::size_t>(options.channels), Coprocessor(one));
    results_.assign(alone_.size(), 0);
    under_way_.assign(alone_.size(), false);
  }

  void run(unsigned steps) {
    for (unsigned i = 0; i < steps && !testing::Test::HasFailure(); ++i) {
      const unsigned of = below(count());
      together_.advance(cycle_ += 1 + below(100));
      if (together_.idle()) under_way_.assign(count(), false);
      const unsigned what = below(32);
      if (what == 0) access(of);
      if (what == 1) through_a_checkpoint();
      if (what == 2) together_.write(++cycle_, channel::offset, below(count()));
      if (what > 2) stream(of);
    }
    for (unsigned each = 0; each < count(); ++each) compare(each);
  }

  const std::vector<unsigned>& results() const { return results_; }

 private:
  unsigned count() const { return static_cast<unsigned>(alone_.size()); }
  unsigned below(unsigned n) { return static_cast<unsigned>(random_() % n); }

  // Only where it is taken, and not while another of its channel is under way: alone the two would
  // meet in the pipeline otherwise.
  void stream(unsigned of) {
    const auto u = static_cast<int32_t>(random_()) >> below(4);
    const auto v = static_cast<int32_t>(random_()) >> below(4);
    const bool clip = below(16) == 0;
    Coprocessor trial = together_;
    if (under_way_.at(of) || !trial.submit_of(of, ++cycle_, u, v, clip)) return;
    EXPECT_TRUE(together_.submit_of(of, cycle_, u, v, clip));
    EXPECT_TRUE(alone_.at(of).submit(cycle_, u, v, clip));
    under_way_.at(of) = true;
    ++results_.at(of);
  }

  void rest() {
    while (!together_.idle()) {
      if (below(200) == 0) together_.write(++cycle_, channel::offset, 0);  // something waits for it
      together_.advance(++cycle_);
    }
  }

  void open(unsigned of) {
    together_.write(++cycle_, channel::offset, of | channel::hold);
    while ((together_.read(cycle_, channel::offset, false).value & channel::ready) == 0)
      together_.advance(++cycle_);
  }

  void access(unsigned of) {
    rest();
    open(of);
    under_way_.at(of) = true;  // SOFT_V
    for (unsigned i = 0; i < 8; ++i) {
      const uint32_t offset = below(reg_last / 4 + 1) * 4;
      auto value = static_cast<uint32_t>(random_());
      if (offset == reg_ctrl) value = (below(8) == 0 ? value : value & ~ctrl_srst) | ctrl_adc;
      cycle_ += 2;
      if (below(3) == 0) {
        expect_same(of, offset);
      } else {
        const bool ok = together_.write(cycle_, offset, value);
        EXPECT_EQ(alone_.at(of).write(cycle_, offset, value), ok) << offset;
      }
    }
    write_ctrl(of);
    if (below(4) != 0) together_.write(++cycle_, channel::offset, of);
  }

  void write_ctrl(unsigned of) {
    const uint32_t value = (static_cast<uint32_t>(random_()) & ~ctrl_srst) | ctrl_adc;
    cycle_ += 2;
    together_.write(cycle_, reg_ctrl, value);
    alone_.at(of).write(cycle_, reg_ctrl, value);
  }

  void expect_same(unsigned of, uint32_t offset) {
    if (offset == reg_version) return;
    const auto here = together_.read(cycle_, offset, false);
    const auto there = alone_.at(of).read(cycle_, offset, false);
    EXPECT_EQ(here.ok, there.ok) << offset;
    EXPECT_EQ(here.value, there.value) << "channel " << of << ", offset " << offset;
  }

  void compare(unsigned of) {
    rest();
    open(of);
    for (uint32_t offset = 0; offset <= reg_last; offset += 4) {
      cycle_ += 2;
      expect_same(of, offset);
    }
    bool any = false;
    for (const Coprocessor& each : alone_) any = any || each.interrupt();
    EXPECT_EQ(together_.interrupt(), any);
  }

  void through_a_checkpoint() {
    const std::string bytes = saved(together_);
    Coprocessor other(options_);
    StateReader reader(bytes);
    other.visit(reader);
    ASSERT_TRUE(reader.ok()) << reader.problem();
    ASSERT_TRUE(reader.at_end());
    EXPECT_EQ(saved(other), bytes);
    together_ = other;
  }

  Options options_;
  std::mt19937_64 random_;
  Coprocessor together_;
  std::vector<Coprocessor> alone_;
  std::vector<unsigned> results_;
  std::vector<bool> under_way_;
  uint64_t cycle_ = 0;
};

TEST(ChannelsTogether, AreAsManyCoprocessors) {
  for (const Arithmetic arithmetic : {Arithmetic::precise, Arithmetic::paper}) {
    for (const unsigned count : {2u, 5u, 16u}) {
      SCOPED_TRACE(testing::Message() << count << " channels");
      Separate test(with_channels(count, arithmetic), count);
      test.run(count * 1500);
      for (const unsigned results : test.results()) EXPECT_GT(results, 50u);
      if (HasFailure()) return;
    }
  }
}

TEST(ChannelsTogether, ACheckpointOfAnotherNumberIsRefused) {
  Coprocessor two(with_channels(2));
  two.write(1, channel::offset, 1 | channel::hold);
  const std::string bytes = saved(two);
  for (const unsigned count : {1u, 3u}) {
    Coprocessor other(with_channels(count));
    StateReader reader(bytes);
    other.visit(reader);
    EXPECT_FALSE(reader.ok() && reader.at_end()) << count;
  }
  IdleState state;
  ASSERT_TRUE(Coprocessor(with_channels(3)).save_idle(state));
  EXPECT_FALSE(two.load_idle(state));
}

TEST(ChannelsTogether, AnIdleStateHasAllOfThem) {
  Coprocessor one(with_channels(3)), other(with_channels(3));
  one.write(1, reg_a1, 7);
  one.write(2, channel::offset, 2 | channel::hold);
  one.advance(100);
  one.write(101, reg_a1, 8);
  IdleState state;
  ASSERT_TRUE(one.save_idle(state));
  ASSERT_TRUE(other.load_idle(state));
  EXPECT_EQ(other.read(102, reg_a1, false).value, 8u);
  other.write(103, channel::offset, channel::hold);
  other.advance(200);
  EXPECT_EQ(other.read(200, reg_a1, false).value, 7u);
  EXPECT_EQ(saved(one).size(), saved(other).size());
}

}  // namespace
}  // namespace capsoc::coprocessor::test
