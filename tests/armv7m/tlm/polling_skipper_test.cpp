#include "armv7m/tlm/polling_skipper.h"

#include <gtest/gtest.h>

#include "../bench.h"

namespace capsoc::armv7m::test {
namespace {

constexpr uint32_t status = 0x40000000;
constexpr BusTransfer ready_not{status, 4, 0, 3};

/// A core whose reads of the device a PollingSkipper is notified of, as the shell does it.
struct Watched : Bench {
  PollingSkipper polling{core};
  bool steady = true;
  uint64_t limit = 10'000, kernel_runs = 1;
  unsigned reads = 0;

  bool read(uint32_t address, unsigned size, uint32_t& value, unsigned& wait,
            AccessKind kind) override {
    const bool ok = Bench::read(address, size, value, wait, kind);
    ++reads;
    polling.made({address, size, value, wait}, ok, steady, limit, kernel_runs);
    return ok;
  }
  /// ldr r0,[r4]; lsls r0,#31; bpl .-4: 8 cycles
  void poll() {
    start({0x6820, 0x07C0, 0xD5FC, 0xE7FE});
    core.set_reg(4, status);
    core.run(40);
  }
};

TEST(PollingSkipper, TheSameSteadyReadTwiceIsWorthALook) {
  Watched w;
  w.polling.made(ready_not, true, true, 100, 1);
  EXPECT_FALSE(w.polling.seems_to_poll());
  w.polling.made(ready_not, true, true, 100, 1);
  EXPECT_TRUE(w.polling.seems_to_poll());
  w.polling.clear();
  EXPECT_FALSE(w.polling.seems_to_poll());
}

TEST(PollingSkipper, AnUnsteadyReadNever) {
  Watched w;
  for (int i = 0; i < 10; ++i) w.polling.made(ready_not, true, false, 100, 1);
  EXPECT_FALSE(w.polling.seems_to_poll());
  EXPECT_EQ(w.polling.repeats(status, 4, 1), nullptr);
}

TEST(PollingSkipper, ARepeatedReadHasItsAnswerUntilAnythingHappens) {
  Watched w;
  w.polling.made(ready_not, true, true, 100, 1);
  ASSERT_NE(w.polling.repeats(status, 4, 1), nullptr);
  EXPECT_EQ(*w.polling.repeats(status, 4, 1), ready_not);
  EXPECT_EQ(w.polling.repeats(status + 4, 4, 1), nullptr) << "another register";
  EXPECT_EQ(w.polling.repeats(status, 1, 1), nullptr) << "another size";
  EXPECT_EQ(w.polling.repeats(status, 4, 2), nullptr) << "the kernel has run";
  w.polling.forget_read();
  EXPECT_EQ(w.polling.repeats(status, 4, 1), nullptr) << "another access is being made";
  w.polling.made(ready_not, false, true, 100, 1);
  EXPECT_EQ(w.polling.repeats(status, 4, 1), nullptr) << "it was no read";
}

TEST(PollingSkipper, SwitchedOffItNoticesNothing) {
  Watched w;
  w.polling.set_enabled(false);
  for (int i = 0; i < 10; ++i) w.polling.made(ready_not, true, true, 100, 1);
  EXPECT_FALSE(w.polling.seems_to_poll());
  EXPECT_EQ(w.polling.repeats(status, 4, 1), nullptr);
}

TEST(PollingSkipper, SkipsWholeIterationsAsLongAsTheReadIsStable) {
  Watched w;
  w.poll();
  const auto turn = w.polling.measure(Core::never);
  ASSERT_TRUE(turn);
  EXPECT_EQ(turn->cycles, 8u);
  const unsigned reads = w.reads;
  w.polling.skip(*turn);
  EXPECT_LE(w.core.cycles(), w.limit);
  EXPECT_GT(w.core.cycles() + turn->cycles, w.limit);
  EXPECT_EQ(w.reads, reads) << "no access was made";
}

TEST(PollingSkipper, AnUnstableReadIsNotSkipped) {
  Watched w;
  w.steady = false;
  w.poll();
  const auto turn = w.polling.measure(Core::never);
  const uint64_t cycles = w.core.cycles();
  if (turn) w.polling.skip(*turn);
  EXPECT_EQ(w.core.cycles(), cycles);
}

TEST(PollingSkipper, AnIterationIsKnownAgainAfterTheSameRead) {
  Watched w;
  w.poll();
  EXPECT_FALSE(w.polling.skip_known(w.limit)) << "nothing was measured";
  const auto turn = w.polling.measure(Core::never);
  ASSERT_TRUE(turn);
  w.polling.skip(*turn);
  ASSERT_TRUE(w.polling.skip_known(20'000));
  EXPECT_LE(w.core.cycles(), 20'000u);
  EXPECT_GT(w.core.cycles() + turn->cycles, 20'000u);
  w.polling.made({status, 4, 1, 3}, true, true, w.limit, 1);
  EXPECT_FALSE(w.polling.skip_known(30'000)) << "the status has changed";
}

}  // namespace
}  // namespace capsoc::armv7m::test
