// The state that model and RTL share: each of its bits changes the model's state, there and back.
#include "inject/coprocessor_words.h"

#include <gtest/gtest.h>

#include <cstring>
#include <set>
#include <string>

#include "coprocessor/idle_state.h"
#include "rtl/rtl_state.h"

namespace capsoc::inject {
namespace {

using coprocessor::IdleState;

/// One in which everything counts: a window, a block and a sample are under way.
IdleState busy_state() {
  capsoc_rtl_state registers{};
  IdleState state = rtl::to_model(registers, {});
  registers = rtl::to_rtl(state);
  registers.block_begun = registers.any_sample = 1;
  registers.fresh = 0;
  registers.octants = 5;
  return rtl::to_model(registers, {});
}

std::string bytes_of(IdleState state) {
  StateWriter writer;
  state.visit(writer);
  return writer.take();
}

IdleState changed(const IdleState& state, const CoprocessorWord& word, unsigned bit) {
  capsoc_rtl_state registers = rtl::to_rtl(state);
  value_of(registers, word) ^= uint64_t{1} << bit;
  IdleState result = rtl::to_model(registers, coprocessor::Nodes(state.nodes));
  result.cycle = state.cycle;
  return result;
}

TEST(CoprocessorWords, NamesAreUnique) {
  std::set<std::string> names, flip_flops;
  for (const CoprocessorWord& word : coprocessor_words()) {
    EXPECT_TRUE(names.insert(word.name).second) << word.name;
    EXPECT_TRUE(flip_flops.insert(word.flip_flop).second) << word.flip_flop;
    EXPECT_EQ(word.index, names.size() - 1);
    EXPECT_TRUE(word.bits >= 1 && word.bits <= 64) << word.name;
  }
  EXPECT_EQ(names.size(), sizeof(capsoc_rtl_state) / sizeof(uint64_t));
  EXPECT_EQ(flip_flops.count("u_register_bank.u_state.u_a1.value_q"), 1U);
}

TEST(CoprocessorWords, EverySharedBitChangesTheModelThereAndBack) {
  const IdleState state = busy_state();
  const std::string before = bytes_of(state);
  unsigned bits = 0;
  for (const CoprocessorWord& word : coprocessor_words()) {
    if (!word.is_shared) continue;
    for (unsigned bit = 0; bit < word.bits; ++bit) {
      const IdleState other = changed(state, word, bit);
      EXPECT_NE(bytes_of(other), before) << word.name << '[' << bit << ']';
      ++bits;
      // Without a sample there is no last angle, and without a window no record of it.
      const bool hides_others = word.name == "any_sample" || word.name == "block_begun";
      if (hides_others) continue;
      EXPECT_EQ(bytes_of(changed(other, word, bit)), before) << word.name << '[' << bit << ']';
    }
  }
  EXPECT_GT(bits, 4000U);
}

}  // namespace
}  // namespace capsoc::inject
