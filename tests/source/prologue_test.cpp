// Callers found without debug information, by what a function's first instructions do.
#include "source/prologue.h"

#include <gtest/gtest.h>

#include <map>
#include <vector>

namespace capsoc::source {
namespace {

constexpr uint32_t function = 0x1000, frame_base = 0x20001000;

class Memory {
 public:
  explicit Memory(const std::vector<uint16_t>& code) {
    for (std::size_t i = 0; i < code.size(); ++i)
      words_[(function + 2 * i) & ~3U] |= uint32_t{code[i]} << (i % 2 * 16);
    for (uint32_t at = function; at < function + 0x40; at += 4) words_[at];
  }
  void set(uint32_t address, uint32_t value) { words_[address] = value; }
  ReadWord reader() const {
    return [this](uint32_t address) -> std::optional<uint32_t> {
      const auto found = words_.find(address);
      if (found == words_.end()) return std::nullopt;
      return found->second;
    };
  }

 private:
  std::map<uint32_t, uint32_t> words_;
};

Registers at(uint32_t address, uint32_t stack_pointer) {
  Registers registers{};
  registers[4] = 4;
  registers[13] = stack_pointer;
  registers[14] = 0x2001;
  registers[15] = address;
  return registers;
}

TEST(Prologue, ALeafReturnsByItsLink) {
  const Memory memory({0x2001, 0x4770});  // movs r0,#1; bx lr
  Registers registers = at(function + 2, frame_base);
  ASSERT_TRUE(unwind_by_prologue(function, function + 2, registers, memory.reader()));
  EXPECT_EQ(registers[15], 0x2000U);
  EXPECT_EQ(registers[13], frame_base);
}

TEST(Prologue, WhatWasPushedIsGivenBack) {
  Memory memory({0xB510, 0xB084, 0x2001, 0x2002});  // push {r4,lr}; sub sp,#16; movs; movs
  memory.set(frame_base + 16, 44);
  memory.set(frame_base + 20, 0x3001);
  Registers registers = at(function + 6, frame_base);
  ASSERT_TRUE(unwind_by_prologue(function, function + 6, registers, memory.reader()));
  EXPECT_EQ(registers[4], 44U);
  EXPECT_EQ(registers[15], 0x3000U);
  EXPECT_EQ(registers[13], frame_base + 24);
}

TEST(Prologue, InTheMidstOfItOnlyWhatWasDone) {
  Memory memory({0xB510, 0xB084, 0x2001});
  memory.set(frame_base, 44);
  memory.set(frame_base + 4, 0x3001);
  Registers registers = at(function + 2, frame_base);
  ASSERT_TRUE(unwind_by_prologue(function, function + 2, registers, memory.reader()));
  EXPECT_EQ(registers[15], 0x3000U);
  EXPECT_EQ(registers[13], frame_base + 8);
}

TEST(Prologue, AFramePointerIsBelieved) {
  Memory memory({0xB580, 0xAF00, 0xB082, 0x2001});  // push {r7,lr}; add r7,sp,#0; sub sp,#8; movs
  memory.set(frame_base, 77);
  memory.set(frame_base + 4, 0x3001);
  Registers registers = at(function + 6, frame_base - 64);  // the stack was moved meanwhile
  registers[7] = frame_base;
  ASSERT_TRUE(unwind_by_prologue(function, function + 6, registers, memory.reader()));
  EXPECT_EQ(registers[7], 77U);
  EXPECT_EQ(registers[15], 0x3000U);
  EXPECT_EQ(registers[13], frame_base + 8);
}

TEST(Prologue, AStackThatCannotBeReadChangesNothing) {
  const Memory memory({0xB510, 0x2001});
  Registers registers = at(function + 2, frame_base);
  const Registers before = registers;
  EXPECT_FALSE(unwind_by_prologue(function, function + 2, registers, memory.reader()));
  EXPECT_EQ(registers, before);
}

}  // namespace
}  // namespace capsoc::source
