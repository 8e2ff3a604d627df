// A flipped bit in any register of the datapath is found in the next sample, on both sides alike
// (docs/reference/coprocessor.md, "Safety mechanisms").
#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "coprocessor/coprocessor.h"
#include "coprocessor/register_map.h"
#include "libraries.h"
#include "rtl/coprocessor_rtl.h"
#include "rtl/lockstep.h"
#include "rtl/rtl_state.h"

namespace capsoc::rtl::test {
namespace {

using namespace coprocessor;

/// A word of the RTL's registers, as rtl_state.def lists them.
struct Word {
  std::string name;
  std::string_view instance;
  unsigned bits;
  uint64_t capsoc_rtl_state::*value;
};

/// Those of the datapath's registers, with their parity bits.
std::vector<Word> guarded_words() {
  std::vector<Word> words = {
#define WORD(name, bits, instance, variable) {#name, #instance, bits, &capsoc_rtl_state::name},
#define WORDS(name, count, bits, instance, variable)
#include "rtl/rtl_state.def"
#undef WORD
#undef WORDS
  };
  std::vector<Word> guarded;
  for (Word& word : words)
    if (word.instance.find("u_register_bank__DOT__u_settings") == 0 ||
        word.instance.find("u_register_bank__DOT__u_state") == 0)
      guarded.push_back(std::move(word));
  return guarded;
}

class Parity : public testing::TestWithParam<Arithmetic> {
 protected:
  void SetUp() override {
    both_ = std::make_unique<Lockstep>(std::make_unique<Coprocessor>(options_of(GetParam())),
                                       std::make_unique<CoprocessorRtl>(open_library(GetParam())));
    // What no reset reaches, the table of the correction, is anything in the RTL.
    IdleState first;
    ASSERT_TRUE(Coprocessor(options_of(GetParam())).save_idle(first));
    ASSERT_TRUE(both_->load_idle(first));
    write(reg_ctrl, ctrl_calib);
    write(reg_safety, safety_parity);
  }

  void write(uint32_t offset, uint32_t value) { both_->write(cycle_ += 2, offset, value); }
  uint32_t read(uint32_t offset) { return both_->read(cycle_ += 2, offset, false).value; }

  /// By software: a flip in CTRL may switch the converter's off.
  void sample() {
    write(reg_soft_u, 0x20000000);
    write(reg_soft_v, 0x10000000);
    both_->advance(cycle_ += 200);
    ASSERT_FALSE(both_->difference()) << both_->report("");
  }

  bool flip(const Word& word, unsigned bit) {
    return both_->change_idle([&](IdleState& state) {
      capsoc_rtl_state registers = to_rtl(state);
      registers.*word.value ^= uint64_t{1} << bit;
      const uint64_t cycle = state.cycle;
      state = to_model(registers, Nodes(state.nodes));
      state.cycle = cycle;
      return true;
    });
  }

  std::unique_ptr<Lockstep> both_;
  uint64_t cycle_ = 0;
};

TEST_P(Parity, EachFlippedBitIsFoundInTheNextSample) {
  unsigned bits = 0;
  const std::vector<Word> words = guarded_words();
  EXPECT_GT(words.size(), 50u);
  for (const Word& word : words) {
    for (unsigned bit = 0; bit < word.bits; ++bit) {
      // This arithmetic has none of the three.
      const bool is_paper = GetParam() == Arithmetic::paper;
      if (is_paper && (word.name == "block" || word.name == "guard" || word.name == "correct"))
        continue;
      // Its coefficients end at bit 15, and their two upper bits are the same.
      if (is_paper && word.bits == 48 && word.name != "phase" && word.name != "freq" &&
          (bit < 15 || bit >= 46))
        continue;
      sample();
      const uint32_t flags = read(reg_flags), status = read(reg_status);
      ASSERT_EQ(flags & flags_safety, 0u) << word.name << " before bit " << bit;
      ASSERT_NE(status & status_valid, 0u) << word.name << " before bit " << bit;
      const uint32_t angle = read(reg_angle);
      ASSERT_TRUE(flip(word, bit));
      sample();
      // A flipped enable may find something, too.
      EXPECT_EQ(read(reg_flags) & flag_parity, flag_parity) << word.name << " bit " << bit;
      EXPECT_EQ(read(reg_status) & status_valid, 0u) << word.name << " bit " << bit;
      EXPECT_EQ(read(reg_angle), angle) << word.name << " bit " << bit;
      if (HasFailure()) return;
      // Only a reset puts right what the pipeline has made of it.
      write(reg_ctrl, ctrl_srst);
      write(reg_ctrl, ctrl_calib);
      write(reg_safety, safety_parity);
      ++bits;
    }
  }
  EXPECT_GT(bits, 800u);
}

// While no mechanism is on, a flip is seen by none, except one in SAFETY itself.
TEST_P(Parity, IsLookedAtIfItIsOnAndOfSafetyAlways) {
  write(reg_safety, 0);
  unsigned seen = 0;
  for (const Word& word : guarded_words()) {
    const bool is_safety = word.name == "mechanisms" || word.name == "bad_parity" ||
                           word.name == "error_limit" || word.name == "step_limit";
    ASSERT_TRUE(flip(word, 0));
    sample();
    EXPECT_EQ((read(reg_flags) & flag_parity) != 0, is_safety) << word.name;
    if (is_safety) ++seen;
    write(reg_ctrl, ctrl_srst);
  }
  EXPECT_EQ(seen, 4u);
}

INSTANTIATE_TEST_SUITE_P(Both, Parity, testing::Values(Arithmetic::precise, Arithmetic::paper),
                         [](const auto& test) {
                           return test.param == Arithmetic::paper ? "paper" : "precise";
                         });

}  // namespace
}  // namespace capsoc::rtl::test
