#include "fit/tables.h"

#include <gtest/gtest.h>

#include <iostream>
#include <sstream>

namespace capsoc::fit {
namespace {

TEST(Tables, KeepTheirBounds) {
  std::ostringstream text;
  const int missed = print_tables(text);
  std::cout << text.str();
  EXPECT_EQ(missed, 0);
  EXPECT_EQ(text.str().find("MISSED"), std::string::npos);
}

}  // namespace
}  // namespace capsoc::fit
