#include "armv7m/tlm/sleep.h"

#include <gtest/gtest.h>

#include <functional>
#include <memory>

#include "in_process.h"

namespace capsoc::armv7m::test {
namespace {

const sc_core::sc_time millisecond(1, sc_core::SC_MS);

struct Client : Sleep::Client {
  bool wakes = false, interrupted = false, debugger = false, attention = false, takes_over = false;
  bool looks = true;
  unsigned asked = 0, paused = 0;
  std::function<void()> on_pause;

  bool must_wake() const override { return wakes; }
  bool is_interrupted() override { return ++asked, interrupted; }
  void pause_if_due() override {
    ++paused;
    if (on_pause) on_pause();
  }
  bool has_debugger() const override { return debugger; }
  bool debugger_looks() const override { return debugger && looks; }
  bool debugger_wants_attention() const override { return attention; }
  bool debugger_takes_over() override { return takes_over; }
};

/// A core that executed WFI.
struct Asleep : Aligned {
  Client client;
  TimeHorizon horizon{clock, core};
  Sleep sleep{clock, core, horizon, client};

  Asleep() : Aligned({0xBF30, 0xE7FE}) {
    EXPECT_EQ(core.run(first + 1000), StopReason::sleeping);
    horizon.synchronise();
    horizon.look_ahead();
  }
};

TEST(Sleep, AnExceptionWakesTheCoreAtItsTime) {
  in_process([] {
    Asleep a;
    at(a.after(5000), [&] {
      a.core.pulse_nmi();
      a.sleep.wake();
    });
    EXPECT_EQ(a.sleep.until_woken(), EndReason::none);
    EXPECT_EQ(sc_core::sc_time_stamp(), a.after(5000));
    EXPECT_EQ(a.core.cycles(), a.first + 5000) << "the core slept until then";
  });
}

TEST(Sleep, APauseAtTheInstantOfFallingAsleepIsThen) {
  in_process([] {
    Asleep a;
    const sc_core::sc_time asleep = sc_core::sc_time_stamp();
    sc_core::sc_time paused_at;
    a.horizon.set_pause(asleep);
    a.client.on_pause = [&] {
      if (a.client.paused == 1) paused_at = sc_core::sc_time_stamp();
      a.horizon.plan_pause(sc_core::sc_max_time());
    };
    at(a.after(5000), [&] {
      a.core.pulse_nmi();
      a.sleep.wake();
    });
    EXPECT_EQ(a.sleep.until_woken(), EndReason::none);
    EXPECT_EQ(paused_at, asleep);
  });
}

TEST(Sleep, SomeoneWhoOnlyLooksDoesNotEndIt) {
  in_process([] {
    Asleep a;
    at(a.after(1000), [&] { a.sleep.wake(); });
    at(a.after(2000), [&] {
      a.client.wakes = true;
      a.sleep.wake();
    });
    EXPECT_EQ(a.sleep.until_woken(), EndReason::none);
    EXPECT_EQ(sc_core::sc_time_stamp(), a.after(2000));
    EXPECT_EQ(a.client.asked, 2u);
    EXPECT_EQ(a.client.paused, 2u);
  });
}

TEST(Sleep, SysTickEndsIt) {
  in_process([] {
    Asleep a;
    a.core.debug_write(0xE000E014, "\xE7\x03\0\0", 4);  // SYST_RVR = 999
    a.core.debug_write(0xE000E018, "\0\0\0\0", 4);
    a.core.debug_write(0xE000E010, "\7\0\0\0", 4);  // SYST_CSR: enabled, pends, HCLK
    const uint64_t event = a.core.next_internal_event();
    ASSERT_NE(event, Core::never);
    EXPECT_EQ(a.sleep.until_woken(), EndReason::none);
    EXPECT_EQ(a.core.cycles(), event);
  });
}

TEST(Sleep, WithoutAnythingThatCouldWakeItOnlyTheHostCanEndIt) {
  std::unique_ptr<Asleep> asleep;
  bool over = false;
  in_process([&] {
    asleep = std::make_unique<Asleep>();
    EXPECT_EQ(asleep->sleep.until_woken(), EndReason::none);
    over = true;
  });
  EXPECT_FALSE(over);
  EXPECT_TRUE(asleep->sleep.is_without_end());
  asleep->client.wakes = true;
  asleep->sleep.wake();
  sc_core::sc_start();
  EXPECT_TRUE(over);
  EXPECT_FALSE(asleep->sleep.is_without_end());
}

TEST(Sleep, ADebuggerMayTakeOverASleepWithoutEnd) {
  in_process([] {
    Asleep a;
    a.client.debugger = a.client.takes_over = true;
    EXPECT_EQ(a.sleep.until_woken(), EndReason::none);
    EXPECT_FALSE(a.sleep.is_without_end());
  });
}

TEST(Sleep, ADebuggerIsAskedEveryMillisecond) {
  in_process([] {
    Asleep a;
    a.client.debugger = true;
    at(a.after(25'000 * 10), [] {});
    at(a.after(25'000 * 3 + 7), [&] { a.client.attention = true; });
    EXPECT_EQ(a.sleep.until_woken(), EndReason::none);
    EXPECT_EQ(a.client.asked, 4u);
  });
}

TEST(Sleep, OneThatDoesNotLookSleepsOn) {
  in_process([] {
    Asleep a;
    a.client.debugger = true;
    a.client.looks = false;
    at(a.after(25'000 * 10), [&] {
      a.client.wakes = true;
      a.sleep.wake();
    });
    EXPECT_EQ(a.sleep.until_woken(), EndReason::none);
    EXPECT_EQ(a.client.asked, 1u);
  });
}

TEST(Sleep, AnInterruptedHostEndsTheSimulation) {
  in_process([] {
    Asleep a;
    at(a.after(100), [&] {
      a.client.interrupted = true;
      a.sleep.wake();
    });
    EXPECT_EQ(a.sleep.until_woken(), EndReason::interrupted);
    EXPECT_EQ(sc_core::sc_time_stamp(), a.after(100));
  });
}

TEST(Sleep, AProgramThatHasNothingToDoIsIdleAfterTheLimit) {
  in_process([] {
    Asleep a;
    a.sleep.set_end_on_idle({millisecond,
                             {[](uint32_t address) { return address == 0x40004000; },
                              [] { return false; }, [] { return uint64_t{0}; }}});
    a.sleep.note_access(0x40004000);
    a.sleep.note_access(0x40004004);
    EXPECT_TRUE(a.sleep.ends_on_idle());
    const sc_core::sc_time worked = a.clock.time_of(a.core.cycles());
    EXPECT_EQ(a.sleep.until_woken(), EndReason::end_on_idle);
    EXPECT_EQ(sc_core::sc_time_stamp(), worked + millisecond);
  });
}

}  // namespace
}  // namespace capsoc::armv7m::test
