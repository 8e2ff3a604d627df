#include "kit/interrupt_line.h"

#include <gtest/gtest.h>

namespace {

TEST(InterruptLine, TellsItsSinksOnlyOfChanges) {
  capsoc::kit::InterruptLine line;
  std::vector<bool> first, second;
  line.connect([&](bool level) { first.push_back(level); });
  line.set(false);
  line.set(true);
  line.set(true);
  line.connect([&](bool level) { second.push_back(level); });
  line.set(false);
  EXPECT_EQ(first, (std::vector<bool>{true, false}));
  EXPECT_EQ(second, (std::vector<bool>{true, false})) << "a late sink hears that the line is high";
  EXPECT_FALSE(line.level());
}

}  // namespace
