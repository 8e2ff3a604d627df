#include "fit/tables.h"

#include <gtest/gtest.h>

#include <iostream>
#include <sstream>

#include "fit/certainty_tables.h"
#include "fit/hard_records.h"
#include "identification/identify.h"

namespace capsoc::fit {
namespace {

TEST(Tables, KeepTheirBounds) {
  std::ostringstream text;
  const int missed = print_tables(text);
  std::cout << text.str();
  EXPECT_EQ(missed, 0);
  EXPECT_EQ(text.str().find("MISSED"), std::string::npos);
}

TEST(Tables, ThePapersOtherMethodsKeepTheirs) {
  std::ostringstream text;
  const int missed = print_peers(text);
  std::cout << text.str();
  EXPECT_EQ(missed, 0);
  for (const char* name : {"sgd", "momentum", "rls", "fourier", "observer", "two-step"})
    EXPECT_NE(text.str().find(std::string("\n") + name), std::string::npos) << name;
}

/// A part of what `capsoc fit --tables` draws, the same on every run.
TEST(Tables, IntervalsOf95PercentHoldTheTruthAsOften) {
  std::ostringstream text;
  const int missed = print_coverage(text, 40);
  std::cout << text.str();
  EXPECT_EQ(missed, 0);
}

/// Noise of all memories tells no interval: at most one record in a hundred keeps its own.
TEST(Tables, FlickerNoiseHasNoIntervalsAndAReason) {
  for (const HardKind& kind : hard_kinds()) {
    if (std::string(kind.name) != "1/f, turning") continue;
    Random random(555);
    int kept = 0;
    for (int i = 0; i < 200; ++i) {
      const auto found = identification::identify(kind.draw(random).samples);
      ASSERT_TRUE(found) << found.error();
      kept += found.value().no_intervals.empty() && !found.value().structure.found ? 1 : 0;
    }
    EXPECT_LE(kept, 2);
    return;
  }
  FAIL() << "there is no such kind";
}

TEST(Tables, DrawnRecordsAreWithinTheirBoundsOrRefusedForATrueReason) {
  std::ostringstream text;
  const int missed = print_drawn(text, 110);
  std::cout << text.str();
  EXPECT_EQ(missed, 0);
}

TEST(Tables, TheAllowanceForHarmonicsIsEnoughForSeveralOrders) {
  std::ostringstream text;
  const int missed = print_allowance(text, 100);
  std::cout << text.str();
  EXPECT_EQ(missed, 0);
  EXPECT_NE(text.str().find("\norder 3, U alone"), std::string::npos);
}

}  // namespace
}  // namespace capsoc::fit
