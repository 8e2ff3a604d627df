#include "armv7m/tlm/time_horizon.h"

#include <gtest/gtest.h>

#include "in_process.h"

namespace capsoc::armv7m::test {
namespace {

const sc_core::sc_time microsecond(1, sc_core::SC_US);  // 25 cycles

struct Horizon : Aligned {
  TimeHorizon horizon{clock, core};

  /// The first cycle that the core may not pass, from the first one on.
  uint64_t allowed() const { return horizon.limit() - first; }
};

TEST(TimeHorizon, TheQuantumBoundsTheCoreIfNothingElseDoes) {
  in_process([] {
    Horizon h;
    sc_core::wait(h.after(0) - h.begin);
    h.horizon.set_quantum(microsecond);
    h.horizon.look_ahead();
    EXPECT_EQ(h.allowed(), 25u);
    EXPECT_EQ(h.horizon.begin_run(10), h.first + 10);
    EXPECT_FALSE(h.horizon.is_late());
  });
}

TEST(TimeHorizon, TheNextActivityOfTheKernelBoundsTheCore) {
  in_process([] {
    Horizon h;
    sc_core::sc_event event;
    sc_core::wait(h.after(0) - h.begin);
    event.notify(h.after(7) - sc_core::sc_time_stamp());
    h.horizon.look_ahead();
    EXPECT_EQ(h.allowed(), 7u);
    h.core.skip_to(h.first + 6);
    EXPECT_FALSE(h.horizon.is_late());
    h.core.skip_to(h.first + 7);
    EXPECT_TRUE(h.horizon.is_late());
  });
}

TEST(TimeHorizon, APauseBoundsTheCoreAndAClearedOneDoesNot) {
  in_process([] {
    Horizon h;
    sc_core::wait(h.after(0) - h.begin);
    h.horizon.set_quantum(microsecond);
    h.horizon.look_ahead();
    const uint64_t until = h.horizon.begin_run(1000);
    EXPECT_EQ(until, h.first + 25);
    h.horizon.set_pause(h.after(5));
    EXPECT_EQ(h.allowed(), 5u);
    EXPECT_TRUE(h.horizon.is_nearer());
    EXPECT_TRUE(h.horizon.pauses());
    h.horizon.set_pause(sc_core::sc_max_time());
    EXPECT_EQ(h.allowed(), 25u);
    EXPECT_FALSE(h.horizon.is_nearer());
    EXPECT_FALSE(h.horizon.pauses());
  });
}

TEST(TimeHorizon, SynchroniseLetsTheKernelCatchUpWithTheCore) {
  in_process([] {
    Horizon h;
    const uint64_t runs = h.horizon.kernel_runs();
    bool happened = false;
    at(h.after(40), [&] { happened = true; });
    h.core.skip_to(h.first + 40);
    h.horizon.synchronise();
    EXPECT_EQ(sc_core::sc_time_stamp(), h.after(40));
    EXPECT_TRUE(happened) << "what happens at this instant happens before the next instruction";
    EXPECT_NE(h.horizon.kernel_runs(), runs);
  });
}

TEST(TimeHorizon, FollowGoesNoFurtherThanWhatIsDue) {
  in_process([] {
    Horizon h;
    bool happened = false;
    at(h.after(10), [&] { happened = true; });
    sc_core::wait(sc_core::SC_ZERO_TIME);
    h.horizon.look_ahead();
    h.core.skip_to(h.first + 40);
    EXPECT_TRUE(h.horizon.is_late());
    h.horizon.follow();
    EXPECT_TRUE(happened);
    EXPECT_EQ(sc_core::sc_time_stamp(), h.after(10));
    EXPECT_FALSE(h.horizon.is_late());
  });
}

TEST(TimeHorizon, CatchUpAdvancesTheCoreAndNeverTurnsItBack) {
  in_process([] {
    Horizon h;
    sc_core::wait(h.after(12) - h.begin);
    h.horizon.catch_up();
    EXPECT_EQ(h.core.cycles(), h.first + 12);
    h.core.skip_to(h.first + 20);
    h.horizon.catch_up();
    EXPECT_EQ(h.core.cycles(), h.first + 20);
  });
}

}  // namespace
}  // namespace capsoc::armv7m::test
