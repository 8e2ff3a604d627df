#include "kit/probe.h"

#include <gtest/gtest.h>

#include <optional>
#include <string>

namespace capsoc::kit {
namespace {

TEST(Probe, TellsAllListenersInTheOrderInWhichTheyCame) {
  Probe<int, const std::string&> probe;
  EXPECT_FALSE(probe.watched());
  probe(1, "nobody");
  std::string heard;
  const Listening first =
      probe.listen([&](int n, const std::string& s) { heard += s + std::to_string(n) + " "; });
  {
    const Listening second = probe.listen([&](int, const std::string& s) { heard += s + "! "; });
    probe(2, "two");
  }
  probe(3, "one");
  EXPECT_EQ(heard, "two2 two! one3 ");
  EXPECT_TRUE(probe.watched());
}

TEST(Probe, AListenerMayEndItselfAndBegin) {
  Probe<int> probe;
  Listening mine, later;
  std::string heard;
  mine = probe.listen([&](int n) {
    heard += "a" + std::to_string(n);
    later = probe.listen([&](int m) { heard += "b" + std::to_string(m); });
    mine = {};
  });
  probe(1);
  probe(2);
  EXPECT_EQ(heard, "a1b1b2");
  later = {};
  EXPECT_FALSE(probe.watched());
}

TEST(Probe, AListeningMayOutliveItAndMove) {
  Listening kept;
  int heard = 0;
  {
    Probe<int> probe;
    Listening made = probe.listen([&](int n) { heard += n; });
    kept = std::move(made);
    probe(5);
  }
  kept = {};
  EXPECT_EQ(heard, 5);
}

}  // namespace
}  // namespace capsoc::kit
