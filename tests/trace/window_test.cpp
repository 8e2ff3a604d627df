#include "trace/window.h"

#include <gtest/gtest.h>

namespace capsoc::trace {
namespace {

Functions two_functions() {
  loader::ElfImage image;
  image.symbols = {{0x100, 0x10, "main"}, {0x110, 0x10, "work"}};
  Functions functions;
  functions.add(image);
  return functions;
}

Bound bound(const std::string& text) {
  const auto parsed = Bound::parse(text, "trace.start", two_functions());
  EXPECT_TRUE(parsed) << text;
  return parsed ? parsed.value() : Bound{};
}

/// The addresses of 0x100, 0x110, ... 0x150 run through twice: which of them are inside.
std::string run_through(Window window) {
  std::string inside;
  for (int turn = 0; turn < 2; ++turn) {
    for (uint32_t pc = 0x100; pc <= 0x150; pc += 0x10) {
      window.instruction(pc);
      inside += window.open() ? 'x' : '.';
    }
  }
  return inside;
}

TEST(Window, AnEndIsASymbolAnAddressOrATime) {
  EXPECT_EQ(bound("work").address, 0x110U);
  EXPECT_EQ(bound("0x111").address, 0x110U) << "the Thumb bit";
  EXPECT_EQ(bound("1.5e-6").picoseconds, 1'500'000U);
  EXPECT_EQ(bound("0").picoseconds, 0U);
  EXPECT_FALSE(bound("").address || bound("").picoseconds);
  for (const char* text : {"worc", "-1", "nan", "inf", "1e7", "0x", "0x100000000", "1s", "0x1g"}) {
    const auto parsed = Bound::parse(text, "trace.start", two_functions());
    ASSERT_FALSE(parsed) << text;
    EXPECT_EQ(parsed.error().find(std::string("trace.start = ") + text), 0U) << parsed.error();
  }
  EXPECT_NE(Bound::parse("worc", "x", two_functions()).error().find("did you mean work"),
            std::string::npos);
}

TEST(Window, OpensAndClosesEveryTimeItsAddressesAreReached) {
  EXPECT_EQ(run_through({{}, {}}), "xxxxxxxxxxxx");
  EXPECT_EQ(run_through({bound("0x120"), bound("0x140")}), "..xx....xx..");
  EXPECT_EQ(run_through({bound("0x120"), {}}), "..xxxxxxxxxx");
  EXPECT_EQ(run_through({{}, bound("0x120")}), "xx..........");
  EXPECT_EQ(run_through({bound("0x140"), bound("0x120")}), "....xxxx..xx");
}

TEST(Window, ATimeComesOnce) {
  Window window(bound("2e-12"), bound("5e-12"));
  std::string inside;
  for (uint64_t now = 0; now < 8; ++now) {
    window.time(now);
    inside += window.open() ? 'x' : '.';
  }
  EXPECT_EQ(inside, "..xxx...");
}

TEST(Window, TimeAndAddressTogether) {
  Window until(bound("0x110"), bound("5e-12"));
  until.instruction(0x110);
  EXPECT_TRUE(until.open());
  until.time(5);
  until.instruction(0x110);
  EXPECT_FALSE(until.open()) << "its time is over";
  Window from(bound("5e-12"), bound("0x110"));
  from.instruction(0x110);
  from.time(6);
  EXPECT_TRUE(from.open());
  from.instruction(0x110);
  from.time(7);
  EXPECT_FALSE(from.open());
}

}  // namespace
}  // namespace capsoc::trace
