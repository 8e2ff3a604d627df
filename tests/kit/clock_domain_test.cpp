#include "kit/clock_domain.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "kit/seconds.h"

namespace {

using capsoc::kit::ClockDomain;
using sc_core::sc_time;

sc_time picoseconds(uint64_t count) {
  return sc_time::from_value(count);
}

TEST(ClockDomain, EdgesOf25MHzAre40NanosecondsApart) {
  ClockDomain clock;
  EXPECT_EQ(clock.time_of(1), sc_time(40, sc_core::SC_NS));
  EXPECT_EQ(clock.cycles_at(sc_time(40, sc_core::SC_NS)), 1u);
  EXPECT_EQ(clock.cycles_at(picoseconds(39'999)), 0u);
  EXPECT_EQ(clock.cycles_at(picoseconds(79'999)), 1u);
}

TEST(ClockDomain, AnEdgeCountsFromItsOwnInstantForEveryFrequency) {
  for (const uint64_t hz :
       {1ull, 3ull, 32'768ull, 8'333'333ull, 33'333'333ull, 199'999'999ull, 200'000'000ull}) {
    ClockDomain clock(hz);
    for (const uint64_t cycle : {1ull, 2ull, 3ull, 999ull, 1'000'003ull, 17'000'000ull}) {
      const sc_time edge = clock.time_of(cycle);
      EXPECT_EQ(clock.cycles_at(edge), cycle) << hz;
      EXPECT_EQ(clock.cycles_at(edge - picoseconds(1)), cycle - 1) << hz;
      EXPECT_EQ(clock.next_edge(edge), cycle);
      EXPECT_EQ(clock.next_edge(edge - picoseconds(1)), cycle);
    }
  }
}

TEST(ClockDomain, AnInstantThatWasAskedForIsAnotherEdgeAfterAChange) {
  ClockDomain clock;
  const sc_time now = sc_core::sc_time_stamp();
  const uint64_t present = clock.cycles_at(now);
  const sc_time later = clock.time_of(present + 4);
  EXPECT_EQ(clock.cycles_at(later), present + 4);
  clock.set_frequency(2 * clock.frequency_hz());
  EXPECT_EQ(clock.cycles_at(later), clock.cycles_at(now) + (later - now).value() / 20'000);
}

TEST(ClockDomain, WholePeriodsAreNoOtherClock) {
  __extension__ typedef unsigned __int128 Wide;
  constexpr Wide second = 1'000'000'000'000;
  std::mt19937_64 random(7);
  for (const uint64_t hz :
       {1ull, 10ull, 25'000'000ull, 62'500'000ull, 200'000'000ull, 24'999'999ull}) {
    ClockDomain clock(hz);
    for (int i = 0; i < 1000; ++i) {
      const uint64_t number = random() >> (random() % 64);
      const Wide edge = (Wide{number} * second + hz - 1) / hz;
      const sc_time expected = edge > std::numeric_limits<uint64_t>::max()
                                   ? sc_core::sc_max_time()
                                   : picoseconds(static_cast<uint64_t>(edge));
      EXPECT_EQ(clock.time_of(number), expected) << hz << " " << number;
      EXPECT_EQ(clock.cycles_at(picoseconds(number)),
                static_cast<uint64_t>(Wide{number} * hz / second))
          << hz << " " << number;
    }
  }
}

TEST(ClockDomain, AFewCyclesOfWholePeriodsTakeTheSameFromWherever) {
  for (const uint64_t hz : {25'000'000ull, 24'999'999ull}) {
    ClockDomain clock(hz);
    for (uint64_t cycles = 0; cycles < 20; ++cycles) {
      const sc_time* const fixed = clock.fixed_duration(cycles);
      EXPECT_EQ(fixed != nullptr, hz == 25'000'000 && cycles < 8) << hz << " " << cycles;
      if (fixed == nullptr) continue;
      EXPECT_EQ(*fixed, clock.duration(cycles, picoseconds(99'999)));
    }
  }
}

TEST(ClockDomain, RoundingDoesNotAddUp) {
  ClockDomain clock(3'000'000);  // 333,333.33 ps
  EXPECT_EQ(clock.time_of(3'000'000'000), sc_time(1000, sc_core::SC_SEC));
}

TEST(ClockDomain, AnEdgeBeyondTheEndOfTimeIsTheEndOfTime) {
  ClockDomain clock;
  EXPECT_EQ(clock.time_of(std::numeric_limits<uint64_t>::max()), sc_core::sc_max_time());
  EXPECT_EQ(clock.cycles_at(sc_core::sc_max_time()), 461'168'601'842'738ull) << "2^64 ps / 40 ns";
}

TEST(ClockDomain, AFrequencyOfZeroDoesNotStopTheModel) {
  ClockDomain clock(0);
  EXPECT_EQ(clock.frequency_hz(), 1u);
}

// SystemC 3.0 has 0.09999999999999999.
TEST(Seconds, AreThoseOfSystemC234) {
  EXPECT_EQ(capsoc::kit::to_seconds(sc_time(0.1, sc_core::SC_SEC)), 0.1);
#if SC_VERSION_MAJOR == 2
  std::mt19937_64 random(20261129);
  for (int n = 0; n < 10000; ++n) {
    const sc_time time = sc_time::from_value(random() >> (random() % 64));
    EXPECT_EQ(capsoc::kit::to_seconds(time), time.to_seconds()) << time.value();
  }
#endif
}

}  // namespace
