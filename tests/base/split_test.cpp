#include "base/split.h"

#include <gtest/gtest.h>

namespace capsoc {
namespace {

using List = std::vector<std::string>;

TEST(Split, PartsBetweenSeparators) {
  EXPECT_EQ(split("a,b c,d", ','), (List{"a", "b c", "d"}));
  EXPECT_EQ(split("a", ','), List{"a"});
  EXPECT_EQ(split("a|b", '|'), (List{"a", "b"}));
}

TEST(Split, EmptyPartsAreKeptButNoneBeginsAtTheEnd) {
  EXPECT_EQ(split(",a,,b", ','), (List{"", "a", "", "b"}));
  EXPECT_EQ(split("a,", ','), List{"a"});
  EXPECT_EQ(split("a,,", ','), (List{"a", ""}));
  EXPECT_EQ(split(",", ','), List{""});
  EXPECT_TRUE(split("", ',').empty());
}

}  // namespace
}  // namespace capsoc
