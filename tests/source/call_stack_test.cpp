// Call stacks of a stack that was made by hand.
#include "source/call_stack.h"

#include <gtest/gtest.h>

#include <map>

namespace capsoc::source {
namespace {

constexpr uint32_t stack = 0x20001000, process = 0x20002000;

/// Three functions without debug information: `movs; movs; ...`, leaves as they stand.
loader::ElfImage three_functions() {
  loader::ElfImage image;
  image.path = "three.elf";
  image.segments.push_back({0x1000, std::vector<uint8_t>(0x300, 0x20), 0x300});
  image.symbols.push_back({0x1000, 0x100, "outer", false, true});
  image.symbols.push_back({0x1100, 0x100, "middle", false, true});
  image.symbols.push_back({0x1200, 0x100, "handler", false, true});
  return image;
}

class CallStackTest : public testing::Test {
 protected:
  CallStackTest() {
    for (uint32_t at = 0x1000; at < 0x1300; at += 4) memory_[at] = 0x20202020;
  }
  void frame(uint32_t at, uint32_t lr, uint32_t pc, uint32_t psr) {
    for (uint32_t i = 0; i < 5; ++i) memory_[at + 4 * i] = i;
    memory_[at + 20] = lr;
    memory_[at + 24] = pc;
    memory_[at + 28] = psr;
  }
  CallStack from(uint32_t pc, uint32_t lr, unsigned exception) {
    armv7m::InterruptedRegisters registers;
    registers.r[13] = registers.msp = stack;
    registers.psp = process;
    registers.r[14] = lr;
    registers.r[15] = pc;
    registers.ipsr = exception;
    return program_.call_stack(
        registers,
        [this](uint32_t address) -> std::optional<uint32_t> {
          const auto found = memory_.find(address);
          if (found == memory_.end()) return std::nullopt;
          return found->second;
        },
        16);
  }

  loader::ElfImage image_ = three_functions();
  Program program_{{&image_}};
  std::map<uint32_t, uint32_t> memory_;
};

TEST_F(CallStackTest, GoesThroughAnExceptionOnTheProcessStack) {
  frame(process, 0x1011, 0x1108, 1U << 24);
  const CallStack stack_now = from(0x1204, 0xFFFFFFFD, 15);
  ASSERT_EQ(stack_now.frames.size(), 4U) << stack_now.end;
  EXPECT_EQ(stack_now.frames[0].place.function, "handler+0x4");
  EXPECT_EQ(stack_now.frames[1].exception, 15U);
  EXPECT_TRUE(stack_now.frames[1].process_stack);
  EXPECT_EQ(stack_now.frames[2].place.function, "middle+0x8");
  EXPECT_EQ(stack_now.frames[2].stack_pointer, process + 0x20);
  EXPECT_EQ(stack_now.frames[3].address, 0x1010U);
}

TEST_F(CallStackTest, CountsTheWordThatAlignedTheFrame) {
  frame(stack, 0x1011, 0x1108, 1U << 24 | 1U << 9);
  const CallStack stack_now = from(0x1204, 0xFFFFFFF9, 15);
  ASSERT_GE(stack_now.frames.size(), 3U);
  EXPECT_EQ(stack_now.frames[2].stack_pointer, stack + 0x24);
}
// B1.5.8: EXC_RETURN, bit 4, of a frame with floating-point registers.
TEST_F(CallStackTest, AnExtendedFrameHasEighteenWordsMore) {
  frame(stack, 0x1011, 0x1108, 1U << 24 | 1U << 9);
  const CallStack stack_now = from(0x1204, 0xFFFFFFE9, 15);
  ASSERT_GE(stack_now.frames.size(), 3U);
  EXPECT_EQ(stack_now.frames[2].stack_pointer, stack + 0x6C);
}

TEST_F(CallStackTest, NestedHandlersStackOnTheMainStack) {
  frame(stack, 0xFFFFFFFD, 0x1204, 1U << 24 | 15);
  frame(process, 0x1011, 0x1108, 1U << 24);
  const CallStack stack_now = from(0x1200, 0xFFFFFFF1, 24);
  ASSERT_GE(stack_now.frames.size(), 5U) << stack_now.end;
  EXPECT_EQ(stack_now.frames[1].exception, 24U);
  EXPECT_EQ(stack_now.frames[3].exception, 15U);
  EXPECT_TRUE(stack_now.frames[3].process_stack);
  EXPECT_EQ(stack_now.frames[4].address, 0x1108U);
}

TEST_F(CallStackTest, AFrameThatCannotBeReadEndsIt) {
  const CallStack stack_now = from(0x1204, 0xFFFFFFFD, 15);
  EXPECT_EQ(stack_now.frames.size(), 1U);
  EXPECT_NE(stack_now.end.find("exception 15 stacked on PSP cannot be read"), std::string::npos);
}

TEST_F(CallStackTest, AJumpToNowhereIsBelievedToComeFromItsLink) {
  const CallStack stack_now = from(0x60000000, 0x1011, 0);
  ASSERT_GE(stack_now.frames.size(), 2U);
  EXPECT_EQ(stack_now.frames[0].place.function, "no code of the program");
  EXPECT_TRUE(stack_now.frames[0].guessed);
  EXPECT_EQ(stack_now.frames[1].address, 0x1010U);
}

TEST_F(CallStackTest, WithoutDebugInformationItSaysSo) {
  const std::vector<std::string> gaps = program_.gaps();
  ASSERT_EQ(gaps.size(), 1U);
  EXPECT_NE(gaps.front().find("three.elf: has no lines of source"), std::string::npos);
}

}  // namespace
}  // namespace capsoc::source
