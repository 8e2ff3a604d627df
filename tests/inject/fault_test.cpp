// The one form of a fault: what a line says, and what is said of a line that says nothing.
#include "inject/fault.h"

#include <gtest/gtest.h>

#include <string>

namespace capsoc::inject {
namespace {

Fault parsed(const std::string& line) {
  const auto fault = parse_fault(line);
  EXPECT_TRUE(fault) << line << ": " << (fault ? "" : fault.error());
  return fault ? fault.value() : Fault{};
}

std::string refused(const std::string& line) {
  const auto fault = parse_fault(line);
  EXPECT_FALSE(fault) << line;
  return fault ? "" : fault.error();
}

TEST(Fault, EveryFormIsReadAndPrintedTheSame) {
  for (const char* line : {"flip cpu.r3[5] at 0.25s",
                           "stuck1 COPROCESSOR.A1[3] at sample 1000 for 0.1s",
                           "stuck0 mem:table[2]+8[0] at instruction 123456",
                           "flip mem:0x20000100[7] at cycle 99",
                           "lose sample at sample 500",
                           "lose sample at 1s for 0.5s",
                           "double sample at cycle 1",
                           "freeze sin at sample 7 for 1e-06s",
                           "freeze cos at 0s",
                           "lose irq coprocessor at 0.5s",
                           "raise irq 12 at cycle 99",
                           "flip rtl.u_q[7] at sample 500 cycle 40",
                           "flip read COPROCESSOR.ANGLE[3] at 1s",
                           "stuck0 write ADC.PERIOD[0] at 1s for 2s",
                           "lose write COPROCESSOR.CTRL at sample 3",
                           "lose write ADC.CTRL at 1s for 0.5s",
                           "fail read ADC.FLAGS at cycle 3",
                           "fail write UART0.DATA at 0s",
                           "lose clock at sample 3 cycle 40",
                           "lose clock at 1s for 0.5s"})
    EXPECT_EQ(to_text(parsed(line)), line);
}

TEST(Fault, APlaceMayHaveBracketsOfItsOwn) {
  const Fault fault = parsed("flip mem:table[3].x[17] at 2");
  EXPECT_EQ(fault.place, "mem:table[3].x");
  EXPECT_EQ(fault.bit, 17U);
  EXPECT_EQ(fault.when.value, 2'000'000'000'000U);
  EXPECT_FALSE(fault.duration);
}

TEST(Fault, WhatIsWrongIsSaid) {
  EXPECT_NE(refused("").find("is empty"), std::string::npos);
  EXPECT_NE(refused("bend cpu.r3[5] at 1s").find("'bend' is no fault; there are flip"),
            std::string::npos);
  EXPECT_NE(refused("flip cpu.r3 at 1s").find("'cpu.r3' names no bit"), std::string::npos);
  for (const char* line : {"flip", "flip at 1s"})
    EXPECT_NE(refused(line).find("names no place; write PLACE[BIT]"), std::string::npos) << line;
  for (const char* line : {"flip read", "stuck0 write at 1s"})
    EXPECT_NE(refused(line).find("names no register; write DEVICE.REGISTER[BIT]"),
              std::string::npos)
        << line;
  EXPECT_NE(refused("flip cpu.r3[x] at 1s").find("names no bit"), std::string::npos);
  EXPECT_NE(refused("flip cpu.r3[5]").find("has no time"), std::string::npos);
  EXPECT_NE(refused("flip cpu.r3[5] at noon").find("'noon' is no time"), std::string::npos);
  EXPECT_NE(refused("flip cpu.r3[5] at -1s").find("is no time"), std::string::npos);
  EXPECT_NE(refused("flip cpu.r3[5] at sample 0").find("'sample 0' is no time"), std::string::npos);
  EXPECT_NE(refused("flip cpu.r3[5] at sample 7 cycle x").find("'cycle x' is no time"),
            std::string::npos);
  EXPECT_NE(refused("flip cpu.r3[5] at 1s for 2s").find("happens once"), std::string::npos);
  EXPECT_NE(refused("stuck0 cpu.r3[5] at 1s for 0s").find("is no duration"), std::string::npos);
  EXPECT_NE(refused("stuck0 cpu.r3[5] at 1s or so").find("has 'or' after its end"),
            std::string::npos);
  EXPECT_NE(refused("lose irq").find("names no interrupt"), std::string::npos);
  EXPECT_NE(refused("freeze tan at 1s").find("is no fault"), std::string::npos);
}

TEST(Fault, AFileHasOneALine) {
  const auto faults =
      parse_faults("f.txt", "# a comment\n\nflip cpu.r1[0] at 1s # why\nlose sample at 2s\n");
  ASSERT_TRUE(faults) << faults.error();
  ASSERT_EQ(faults.value().size(), 2U);
  EXPECT_EQ(faults.value()[0].origin, "f.txt:3");
  EXPECT_EQ(to_text(faults.value()[1]), "lose sample at 2s");
  const auto wrong = parse_faults("f.txt", "flip cpu.r1[0] at 1s\n\nflip cpu.r1 at 1s\n");
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().rfind("f.txt:3: 'cpu.r1' names no bit", 0), 0U) << wrong.error();
}

}  // namespace
}  // namespace capsoc::inject
