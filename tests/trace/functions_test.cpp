#include "trace/functions.h"

#include <gtest/gtest.h>

namespace capsoc::trace {
namespace {

Functions program() {
  loader::ElfImage image;
  image.symbols = {{0x100, 0x20, "main"},    {0x110, 0, "label"},        {0x120, 8, "alias", true},
                   {0x120, 8, "work"},       {0x200, 0, "assembly"},     {0x8000, 4, "far"},
                   {0x9000, 0x100, "outer"}, {0x9010, 4, "inner_object"}};
  Functions functions;
  functions.add(image);
  return functions;
}

TEST(Functions, TheOneThatCoversAnAddress) {
  Functions functions = program();
  const auto place = [&](uint32_t address) { return functions.place(address); };
  EXPECT_EQ(place(0x100), "main");
  EXPECT_EQ(place(0x11F), "main+0x1e") << "a label inside has no size";
  EXPECT_EQ(place(0x120), "work") << "not its weak alias";
  EXPECT_EQ(place(0x210), "assembly+0x10");
  EXPECT_EQ(place(0x9020), "outer+0x20") << "behind a symbol inside it";
  EXPECT_EQ(place(0x5000), "");
  EXPECT_EQ(functions[functions.at(0x5000)].name, "[no symbol]");
  EXPECT_EQ(place(0), "");
  EXPECT_EQ(place(0xFFFFFFFF), "");
}

TEST(Functions, NamesWithoutAnAddress) {
  Functions functions = program();
  const uint32_t waiting = functions.add_name("[waiting]");
  EXPECT_EQ(functions[waiting].name, "[waiting]");
  EXPECT_EQ(functions.address_of("[waiting]"), std::nullopt);
  EXPECT_EQ(functions.address_of("far"), 0x8000U);
}

}  // namespace
}  // namespace capsoc::trace
